//! Accelerators of users that break the contract of `Accel`: a render and view factors end with an error that says what is
//! wrong, and make no wrong picture.

use glam::DVec3;
use globillum::geom::{Aabb, Accel, BruteForce, Hit, Ray, Triangles};
use globillum::integrator::view_factors::{FactorError, FactorRun, FactorSettings, Patches};
use globillum::integrator::{Model, PathReuse, RenderError, Scene, Settings, Supersampling, render};
use globillum::material::{Material, Rgb};
use globillum_testkit::scenes::{light_over_floor, stare};
use globillum_testkit::shapes::{cuboid, inside_out};

/// Brute force with one fault.
#[derive(Debug)]
struct Faulty {
    inner: BruteForce,
    fault: Fault,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    /// Hits are appended to those of the last batch.
    AppendedHits,
    /// Any-hit answers are appended to those of the last batch.
    AppendedOccluded,
    /// The last hit of a batch is missing.
    MissingHit,
    /// The last any-hit answer of a batch is missing.
    MissingOccluded,
    /// Every hit names a triangle that the scene has not.
    UnknownTriangle,
}

impl Accel for Faulty {
    fn intersect(&self, ray: &Ray) -> Option<Hit> {
        let hit = self.inner.intersect(ray)?;
        Some(if self.fault == Fault::UnknownTriangle { Hit { triangle: 999, ..hit } } else { hit })
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.inner.occluded(ray)
    }

    fn intersect_batch(&self, rays: &[Ray], hits: &mut Vec<Option<Hit>>) {
        if self.fault != Fault::AppendedHits {
            hits.clear();
        }
        hits.extend(rays.iter().map(|ray| self.intersect(ray)));
        if self.fault == Fault::MissingHit {
            hits.pop();
        }
    }

    fn occluded_batch(&self, rays: &[Ray], occluded: &mut Vec<bool>) {
        if self.fault != Fault::AppendedOccluded {
            occluded.clear();
        }
        occluded.extend(rays.iter().map(|ray| self.occluded(ray)));
        if self.fault == Fault::MissingOccluded {
            occluded.pop();
        }
    }

    fn bounds(&self) -> Aabb {
        self.inner.bounds()
    }

    fn bytes(&self) -> usize {
        self.inner.bytes()
    }
}

/// The error of a render of `model`. With path reuse, probes precede the tiles.
fn error_of(model: Model, fault: Fault, supersampling: Supersampling, path_reuse: PathReuse) -> RenderError {
    let build = |triangles: &Triangles| Ok(Faulty { inner: BruteForce::build(triangles), fault });
    let scene = Scene::build(model, build).expect("the model is good");
    let camera = stare(DVec3::new(0.1, 0.8, 0.2), DVec3::new(0.3, 0.0, -0.1));
    let mut settings = Settings::new(32, 32, 32);
    (settings.supersampling, settings.path_reuse) = (supersampling, path_reuse);
    render(&scene, &camera, &settings).expect_err("the accelerator is faulty")
}

#[test]
fn answers_of_another_number_than_rays_are_an_error() {
    for (fault, method) in [
        (Fault::AppendedHits, "intersect_batch"),
        (Fault::MissingHit, "intersect_batch"),
        (Fault::AppendedOccluded, "occluded_batch"),
        (Fault::MissingOccluded, "occluded_batch"),
    ] {
        let error = error_of(light_over_floor(), fault, Supersampling::default(), PathReuse::Off);
        assert!(matches!(error, RenderError::Worker { .. }), "{error:?}");
        assert!(error.to_string().contains(&format!("Accel::{method} stored ")), "{error}");
    }
}

#[test]
fn view_factors_name_the_patch() {
    let triangles = Triangles::new(inside_out(cuboid(DVec3::ZERO, DVec3::ONE, 0.0))).expect("good triangles");
    let (patches, settings) = (Patches::of_triangles(triangles.len() as u32), FactorSettings::new(1 << 14));
    for (fault, said) in [
        (Fault::AppendedHits, "Accel::intersect_batch stored "),
        (Fault::MissingHit, "Accel::intersect_batch stored "),
        (Fault::UnknownTriangle, "999"),
    ] {
        let accel = Faulty { inner: BruteForce::build(&triangles), fault };
        let error = FactorRun::new(&triangles, &accel, &patches, &settings).run().expect_err("it is faulty");
        assert!(matches!(error, FactorError::Worker { .. }), "{fault:?}: {error:?}");
        assert!(error.to_string().contains(said), "{fault:?}: {error}");
    }
}

/// With a mirror, probes and photons precede the tiles.
#[test]
fn a_panic_before_the_first_tile_says_so() {
    let mut model = light_over_floor();
    let mirror = Material::mirror(Rgb::splat(0.9)).expect("in range");
    model.add(mirror, cuboid(DVec3::new(0.0, 0.1, 0.0), DVec3::splat(0.05), 0.0));
    let error = error_of(model, Fault::UnknownTriangle, Supersampling::Off, PathReuse::Tiles);
    assert!(matches!(error, RenderError::Preparation { .. }), "{error:?}");
    let said = error.to_string();
    assert!(said.starts_with("panic before the first tile: ") && said.contains("999"), "{said}");
}

#[test]
fn an_accelerator_over_other_triangles_is_refused() {
    let other = Triangles::new(cuboid(DVec3::ZERO, DVec3::ONE, 0.0)).expect("good triangles");
    let other = BruteForce::build(&other);
    let built = Scene::build(light_over_floor(), |_| Ok(&other));
    assert_eq!(built.err(), Some(RenderError::OtherTriangles));

    let triangles = Triangles::new(cuboid(DVec3::ZERO, DVec3::splat(2.0), 0.0)).expect("good triangles");
    let (patches, settings) = (Patches::of_triangles(triangles.len() as u32), FactorSettings::new(64));
    let run = |accel: &dyn Accel| FactorRun::new(&triangles, accel, &patches, &settings).run();
    assert_eq!(run(&other).err(), Some(FactorError::OtherTriangles));
    assert!(run(&BruteForce::build(&triangles)).is_ok());
}
