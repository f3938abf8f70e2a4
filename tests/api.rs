//! Traits of the public types.

use globillum::{geom, integrator, io, material};

fn shared_between_threads<T: Send + Sync + std::fmt::Debug>() {}

#[test]
fn every_type_is_send_sync_and_debug() {
    shared_between_threads::<geom::Aabb>();
    shared_between_threads::<geom::BruteForce>();
    shared_between_threads::<geom::Frame>();
    shared_between_threads::<geom::GeomError>();
    shared_between_threads::<geom::Hit>();
    shared_between_threads::<geom::KdTree>();
    shared_between_threads::<geom::Ray>();
    shared_between_threads::<geom::SurfacePoint>();
    shared_between_threads::<geom::Triangles>();
    shared_between_threads::<geom::UniformGrid>();
    shared_between_threads::<geom::decide::Shear>();
    shared_between_threads::<integrator::Camera>();
    shared_between_threads::<integrator::CheckpointError>();
    shared_between_threads::<integrator::Film>();
    shared_between_threads::<integrator::Model>();
    shared_between_threads::<integrator::Picture>();
    shared_between_threads::<integrator::Render<'_>>();
    shared_between_threads::<integrator::RenderError>();
    shared_between_threads::<integrator::Replay>();
    shared_between_threads::<integrator::Scene<geom::KdTree>>();
    shared_between_threads::<integrator::Settings>();
    shared_between_threads::<integrator::Stop>();
    shared_between_threads::<integrator::Stream>();
    shared_between_threads::<io::IoError>();
    shared_between_threads::<io::Limits>();
    shared_between_threads::<io::Location>();
    shared_between_threads::<io::LoadProgress>();
    shared_between_threads::<io::LoadReport>();
    shared_between_threads::<io::Loaded>();
    shared_between_threads::<io::PictureFile>();
    shared_between_threads::<material::Bsdf>();
    shared_between_threads::<material::Material>();
    shared_between_threads::<material::MaterialError>();
}

#[test]
fn accelerators_can_be_chosen_at_run_time() {
    fn is_accel<A: geom::Accel>() {}
    is_accel::<Box<dyn geom::Accel>>();
}
