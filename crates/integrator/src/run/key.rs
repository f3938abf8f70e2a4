use crate::hash::{fold, sources};
use crate::{DeltaLight, Roulette, Scene, Sensor, Settings};
use globillum_geom::Accel;
use globillum_material::{Bsdf, Material, Rgb};
use std::hash::Hasher;
use std::ops::Range;

/// [`Render::key`](crate::Render::key).
pub(crate) fn picture_key(
    scene: &Scene<dyn Accel + '_>,
    sensor: &dyn Sensor,
    settings: &Settings,
    crop: Option<&[Range<u32>; 2]>,
) -> u64 {
    let mut key = Key(0);
    sources().for_each(|part| key.add(part));
    key.add_scene(scene);
    sensor.hash(&mut key);
    key.add_settings(settings);
    // Nothing is added for a whole picture.
    crop.into_iter().flatten().flat_map(|range| [range.start, range.end]).for_each(|end| key.add(end.into()));
    key.0
}

struct Key(u64);

impl Key {
    fn add(&mut self, part: u64) {
        self.0 = fold(self.0, part);
    }

    fn add_rgb(&mut self, rgb: Rgb) {
        rgb.to_array().into_iter().for_each(|x| self.add(x.to_bits()));
    }

    fn add_scene(&mut self, scene: &Scene<dyn Accel + '_>) {
        let triangles = scene.triangles();
        self.add(triangles.len() as u64);
        for index in 0..triangles.len() as u32 {
            let vertices = triangles.get(index).vertices;
            vertices.iter().flat_map(|v| v.to_array()).for_each(|x| self.add(x.to_bits().into()));
            self.add_material(scene.material(index));
        }
        self.add_rgb(scene.environment());
        // Nothing is added for a scene without delta lights.
        scene.lights().delta_lights().flat_map(DeltaLight::numbers).for_each(|x| self.add(x.to_bits()));
    }

    fn add_material(&mut self, material: &Material) {
        match material.bsdf {
            Bsdf::Lambert(albedo) => (self.add(0), self.add_rgb(albedo.rgb())),
            Bsdf::Mirror(reflectance) => (self.add(1), self.add_rgb(reflectance.rgb())),
            // A later kind of surface needs a hash that differs from these.
            ref other => (self.add(2), format!("{other:?}").bytes().for_each(|byte| self.add(byte.into()))),
        };
        self.add_rgb(material.emission.toward(1.0));
        self.add_rgb(material.emission.toward(-1.0));
    }

    fn add_settings(&mut self, settings: &Settings) {
        // All fields are listed, so that a new one cannot be forgotten.
        let &Settings {
            width,
            height,
            samples: _,
            pass_samples,
            sampler,
            filter,
            seed,
            threads: _,
            max_bounces,
            estimator,
            light_sampling,
            light_samples,
            mirror_sampling,
            supersampling,
            path_reuse,
            guiding,
            roulette: Roulette { start, threshold },
        } = settings;
        let kinds = [
            sampler as u32,
            filter as u32,
            estimator as u32,
            light_sampling as u32,
            mirror_sampling as u32,
            path_reuse.code(),
            supersampling as u32,
            guiding as u32,
        ];
        for part in [width, height, pass_samples, light_samples].into_iter().chain(kinds) {
            self.add(part.into());
        }
        self.add(start.into());
        self.add(threshold.to_bits());
        self.add(seed);
        self.add(max_bounces.map_or(u64::MAX, u64::from));
    }
}

impl Hasher for Key {
    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|&byte| self.add(byte.into()));
    }

    fn write_u64(&mut self, part: u64) {
        self.add(part);
    }

    fn finish(&self) -> u64 {
        self.0
    }
}
