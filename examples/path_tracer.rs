//! A path tracer of its own on the parts of the library: `cargo run --example path_tracer`.
//!
//! It renders the Cornell box to `path_tracer.png` with the accelerator of `geom`, the materials of `material` and the
//! light sampling of `integrator`, and compares the picture with that of [`render`].
#![allow(clippy::print_stdout, reason = "a program talks to people")]

use globillum::geom::{Accel, Frame, PdfSolidAngle, Ray, WideBvh};
use globillum::integrator::{
    Comparison, ElementSample, Estimates, Interaction, LightSampler, LightSampling, PinholeCamera, Scene,
    Settings, Stream, render,
};
use globillum::material::{Density, Rgb};
use globillum::scenes::cornell;
use rayon::prelude::*;
use std::error::Error;

const SIDE: u32 = 128;
const SAMPLES: u32 = 64;

/// One sample of the radiance that arrives along `ray`: a path with next event estimation, multiple importance
/// sampling and Russian roulette.
pub(crate) fn radiance<A: Accel>(scene: &Scene<A>, mut ray: Ray, numbers: Stream) -> Rgb {
    let (mut radiance, mut throughput) = (Rgb::BLACK, Rgb::WHITE);
    // The density of the ray's direction and the lights of its origin, if lights are sampled there, too.
    let mut scattered: Option<(PdfSolidAngle, LightSampler<'_>)> = None;
    for bounce in 0.. {
        let dimension = 2 + 6 * bounce; // The first two numbers are for the place in the pixel.
        let Some(hit) = scene.accel().intersect(&ray) else {
            return radiance + throughput * scene.environment();
        };
        let at = scene.interaction(&ray, &hit);
        let weight = scattered.map_or(1.0, |(pdf, lights)| pdf.power_heuristic(lights.pdf(&at)));
        radiance += throughput * at.emitted() * weight;

        let lights = scene.light_sampler(LightSampling::SolidAngle, at.point.position, at.facing_normal());
        if at.material.bsdf.is_diffuse() {
            radiance += throughput * from_lights(scene, &at, &lights, numbers, dimension);
        }
        let frame = Frame::around(at.point.normal);
        let u = numbers.uniform_pair(dimension + 3);
        let Some(sample) = at.material.bsdf.sample(frame.to_local(at.wo), u) else { return radiance };
        throughput *= sample.weight;
        if bounce >= 3 {
            let survive_prob = throughput.max_component().min(0.95);
            if numbers.uniform(dimension + 5) >= survive_prob {
                return radiance;
            }
            throughput /= survive_prob;
        }
        scattered = match sample.density {
            Density::SolidAngle(pdf) => Some((pdf, lights)),
            Density::Delta => None,
        };
        ray = at.point.spawn_ray(frame.to_world(sample.wi));
    }
    radiance
}

/// The radiance that a point of a light sends to `at` and `at` reflects, weighted by the power heuristic.
fn from_lights<A: Accel>(
    scene: &Scene<A>,
    at: &Interaction<'_>,
    lights: &LightSampler<'_>,
    numbers: Stream,
    dimension: u32,
) -> Rgb {
    let sample = lights.sample(numbers.uniform(dimension), numbers.uniform_pair(dimension + 1));
    let Some((light, shadow_ray)) = sample.and_then(|light| Some((light, light.shadow_ray(&at.point)?)))
    else {
        return Rgb::BLACK;
    };
    if scene.accel().occluded(&shadow_ray) {
        return Rgb::BLACK;
    }
    let frame = Frame::around(at.point.normal);
    let (wo, wi) = (frame.to_local(at.wo), frame.to_local(light.direction()));
    let weight = light.power_heuristic(at.material.bsdf.pdf(wo, wi));
    at.material.bsdf.eval(wo, wi) * light.irradiance() * (wi.z.abs() * weight)
}

/// Mean and standard error of the samples of pixel `index`, counted row by row.
fn pixel<A: Accel>(scene: &Scene<A>, camera: &PinholeCamera, index: u32) -> (Rgb, Rgb) {
    let (mut sum, mut squares) = (Rgb::BLACK, Rgb::BLACK);
    for sample in 0..SAMPLES {
        let numbers = Stream::new(0, index.into(), sample);
        let at = ElementSample::new((index % SIDE, index / SIDE), numbers.uniform_pair(0), [SIDE, SIDE]);
        let value = radiance(scene, camera.ray(at.x, at.y, at.aspect), numbers);
        sum += value;
        squares += value * value;
    }
    let n = f64::from(SAMPLES);
    let mean = sum / n;
    let variance = (squares / n - mean * mean).map(|x| x.max(0.0));
    (mean, (variance / (n - 1.0)).map(f64::sqrt))
}

fn main() -> Result<(), Box<dyn Error>> {
    let scene = Scene::build(cornell::with_blocks(false)?, WideBvh::build)?;
    let camera = cornell::camera()?;
    let pixels = (0..SIDE * SIDE).into_par_iter().map(|index| pixel(&scene, &camera, index));
    let mut own = Estimates::unknown(SIDE, SIDE);
    (own.means, own.standard_errors) = pixels.unzip();
    own.observations.fill(SAMPLES);

    let picture = render(&scene, &camera, &Settings::new(SIDE, SIDE, SAMPLES))?;
    let comparison =
        Comparison::between(&[own.clone()], &[Estimates::of(&picture.film)]).ok_or("no pixels")?;
    let ([low, high], verdict) = (comparison.ratio_95, comparison.verdict(0.001));
    println!(
        "path_tracer.png: the mean is {low:.4} to {high:.4} of the library's (95 % interval); {verdict}"
    );
    let bytes: Vec<u8> = own.means.iter().flat_map(|rgb| rgb.to_srgb8()).collect();
    image::save_buffer("path_tracer.png", &bytes, SIDE, SIDE, image::ColorType::Rgb8)?;
    Ok(())
}
