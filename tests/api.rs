//! Traits of the public types.

use globillum::{geom, integrator, io, material};
use std::any::type_name;
use std::fmt::Debug;

/// What may not be shared: a loader has a monitor, which a single thread may call.
const NOT_SHARED: &str = "Loader";

/// The path of a type that is `Send`, `Sync` and `Debug`.
fn checked<T: Send + Sync + Debug>() -> &'static str {
    type_name::<T>()
}

#[test]
fn every_type_is_send_sync_and_debug() {
    let checked = [
        checked::<geom::Aabb>(),
        checked::<geom::BruteForce>(),
        checked::<geom::Counts>(),
        checked::<geom::Frame>(),
        checked::<geom::GeomError>(),
        checked::<geom::GridOptions>(),
        checked::<geom::Hit>(),
        checked::<geom::KdOptions>(),
        checked::<geom::KdStats>(),
        checked::<geom::KdTree>(),
        checked::<geom::PdfArea>(),
        checked::<geom::PdfSolidAngle>(),
        checked::<geom::Ray>(),
        checked::<geom::SimdLevel>(),
        checked::<geom::SphericalTriangle>(),
        checked::<geom::SplitRule>(),
        checked::<geom::SurfacePoint>(),
        checked::<geom::Triangle>(),
        checked::<geom::Triangles>(),
        checked::<geom::UniformGrid>(),
        checked::<geom::WideBvh>(),
        checked::<geom::conformance::Regime>(),
        checked::<geom::conformance::Seeded>(),
        checked::<geom::conformance::Suite>(),
        checked::<geom::conformance::Tally>(),
        checked::<geom::conformance::Target>(),
        checked::<geom::conformance::Violation>(),
        checked::<geom::conformance::cases::Case>(),
        checked::<geom::conformance::cases::Known>(),
        checked::<geom::decide::Intersection>(),
        checked::<geom::decide::Shear>(),
        checked::<geom::shapes::Mesh>(),
        checked::<integrator::AreaLightSample>(),
        checked::<integrator::CheckpointError>(),
        checked::<integrator::CheckpointHeader>(),
        checked::<integrator::CheckpointReader<&[u8]>>(),
        checked::<integrator::CheckpointStrip>(),
        checked::<integrator::CheckpointWriter<Vec<u8>>>(),
        checked::<integrator::ChiSquare>(),
        checked::<integrator::Comparison>(),
        checked::<integrator::Verdict>(),
        checked::<integrator::Counters>(),
        checked::<integrator::DeltaLight>(),
        checked::<integrator::DeltaLightError>(),
        checked::<integrator::DeltaLightSample>(),
        checked::<integrator::ElementSample>(),
        checked::<integrator::Ending>(),
        checked::<integrator::Estimates>(),
        checked::<integrator::Estimator>(),
        checked::<integrator::Film>(),
        checked::<integrator::FirstHit>(),
        checked::<integrator::FirstHits>(),
        checked::<integrator::Guiding>(),
        checked::<integrator::ErrorEstimate>(),
        checked::<integrator::Interaction<'_>>(),
        checked::<integrator::IrradiancePoints>(),
        checked::<integrator::LightSample>(),
        checked::<integrator::LightSampler<'_>>(),
        checked::<integrator::LightSampling>(),
        checked::<integrator::Lights>(),
        checked::<integrator::MaterialId>(),
        checked::<integrator::Merge<&[u8]>>(),
        checked::<integrator::MergeError>(),
        checked::<integrator::MirrorSampling>(),
        checked::<integrator::Model>(),
        checked::<integrator::OrthographicCamera>(),
        checked::<integrator::PathReuse>(),
        checked::<integrator::PathStart>(),
        checked::<integrator::Picture>(),
        checked::<integrator::PinholeCamera>(),
        checked::<integrator::PixelFilter>(),
        checked::<integrator::PixelGoal>(),
        checked::<integrator::PixelSums>(),
        checked::<integrator::PointError>(),
        checked::<integrator::Progress>(),
        checked::<integrator::Reading>(),
        checked::<integrator::Render<'_>>(),
        checked::<integrator::RenderError>(),
        checked::<integrator::Replay>(),
        checked::<integrator::Roulette>(),
        checked::<integrator::Sampler>(),
        checked::<integrator::Scene<geom::KdTree>>(),
        checked::<integrator::Settings>(),
        checked::<integrator::SphericalCamera>(),
        checked::<integrator::Stop>(),
        checked::<integrator::Stream>(),
        checked::<integrator::Supersampling>(),
        checked::<integrator::Vertex>(),
        checked::<integrator::view_factors::Factor>(),
        checked::<integrator::view_factors::FactorAccuracy>(),
        checked::<integrator::view_factors::FactorError>(),
        checked::<integrator::view_factors::FactorFormat>(),
        checked::<integrator::view_factors::FactorRun<'_, geom::KdTree>>(),
        checked::<integrator::view_factors::FactorSettings>(),
        checked::<integrator::view_factors::FactorTable<'_, fn(u32) -> String>>(),
        checked::<integrator::view_factors::Patches>(),
        checked::<integrator::view_factors::Reciprocity<'_>>(),
        checked::<integrator::view_factors::Target>(),
        checked::<integrator::view_factors::ViewFactors>(),
        checked::<io::AtomicFile>(),
        checked::<io::IoError>(),
        checked::<io::Limits>(),
        checked::<io::LoadProgress>(),
        checked::<io::LoadReport>(),
        checked::<io::Loaded>(),
        checked::<io::Location>(),
        checked::<io::NamedMaterial>(),
        checked::<io::Object>(),
        checked::<io::PictureData>(),
        checked::<io::PictureFile>(),
        checked::<io::PictureFormat>(),
        checked::<io::Place>(),
        checked::<io::Warning>(),
        checked::<io::WarningKind>(),
        checked::<material::Bsdf>(),
        checked::<material::BsdfSample>(),
        checked::<material::Density>(),
        checked::<material::Emission>(),
        checked::<material::Material>(),
        checked::<material::MaterialError>(),
        checked::<material::Reflectance>(),
        checked::<material::Rgb>(),
        checked::<material::Sides>(),
        checked::<material::warp::CosineHemisphere>(),
    ];
    for (name, listing) in [
        ("geom", include_str!("public_api/geom.rs.txt")),
        ("integrator", include_str!("public_api/integrator.rs.txt")),
        ("io", include_str!("public_api/io.rs.txt")),
        ("material", include_str!("public_api/material.rs.txt")),
    ] {
        let declared = listing.lines().filter_map(|line| {
            let name = line.strip_prefix("pub struct ").or_else(|| line.strip_prefix("pub enum "))?;
            name.split(|c: char| !c.is_alphanumeric()).next()
        });
        for declared in declared.filter(|name| *name != NOT_SHARED) {
            let is_it = |path: &&str| {
                let path = path.split('<').next().unwrap_or(path);
                path.starts_with(&format!("globillum_{name}::")) && path.ends_with(&format!("::{declared}"))
            };
            assert!(checked.iter().any(is_it), "{name}: {declared} is not in the list");
        }
    }
}

#[test]
fn accelerators_can_be_chosen_at_run_time() {
    fn is_accel<A: geom::Accel>() {}
    is_accel::<Box<dyn geom::Accel>>();
}
