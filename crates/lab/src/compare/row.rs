//! The figures of one accelerator on one mesh: a row of the table and of the CSV file.

use super::measure::Measurement;
use anyhow::Result;
use globillum::io::AtomicFile;
use globillum_testkit::query::Query;
use globillum_testkit::rays::Rays;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// A row of `compare.csv`. Build times are in milliseconds, query times in nanoseconds per ray. Counts are per
/// ray.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Row {
    pub(crate) mesh: String,
    pub(crate) triangles: usize,
    pub(crate) accelerator: String,
    pub(crate) build_ms: f64,
    pub(crate) bytes: usize,
    pub(crate) bytes_per_triangle: f64,
    pub(crate) camera_rays: usize,
    pub(crate) bounce_rays: usize,
    pub(crate) closest_camera_ns: f64,
    pub(crate) closest_bounce_ns: f64,
    pub(crate) any_shadow_ns: f64,
    pub(crate) any_bounce_ns: f64,
    pub(crate) hits_camera: f64,
    pub(crate) visits_camera: f64,
    pub(crate) opened_camera: f64,
    pub(crate) tests_camera: f64,
    pub(crate) repeats_camera: f64,
    pub(crate) hits_bounce: f64,
    pub(crate) visits_bounce: f64,
    pub(crate) opened_bounce: f64,
    pub(crate) tests_bounce: f64,
    pub(crate) repeats_bounce: f64,
    pub(crate) hits_shadow: f64,
    pub(crate) visits_shadow: f64,
    pub(crate) opened_shadow: f64,
    pub(crate) tests_shadow: f64,
    pub(crate) repeats_shadow: f64,
    /// Number of bounce rays after which the next row, which takes longer to build, is faster in total. Empty
    /// if it never is, or in the last row.
    pub(crate) break_even_rays: Option<f64>,
    pub(crate) hash: String,
}

/// The rows of one mesh, in ascending order of build time.
pub(crate) fn rows(mesh: &str, triangles: usize, rays: &Rays, mut measured: Vec<Measurement>) -> Vec<Row> {
    measured.sort_by(|a, b| a.build_seconds.total_cmp(&b.build_seconds));
    let row = |i: usize| {
        let m = &measured[i];
        let [closest_camera_ns, closest_bounce_ns, any_shadow_ns, any_bounce_ns] = m.nanoseconds;
        let [camera, bounce, shadow] = [Query::ClosestCamera, Query::ClosestBounce, Query::AnyShadow]
            .map(|query| m.counts[query as usize]);
        let a_ray = |count: u64, rays: u64| count as f64 / rays.max(1) as f64;
        Row {
            mesh: mesh.to_owned(),
            triangles,
            accelerator: m.accelerator.clone(),
            build_ms: m.build_seconds * 1e3,
            bytes: m.bytes,
            bytes_per_triangle: m.bytes as f64 / triangles as f64,
            camera_rays: rays.camera.len(),
            bounce_rays: rays.bounce.len(),
            closest_camera_ns,
            closest_bounce_ns,
            any_shadow_ns,
            any_bounce_ns,
            hits_camera: a_ray(camera.hits, camera.rays),
            visits_camera: a_ray(camera.visits, camera.rays),
            opened_camera: a_ray(camera.opened, camera.rays),
            tests_camera: a_ray(camera.tests, camera.rays),
            repeats_camera: a_ray(camera.repeats, camera.rays),
            hits_bounce: a_ray(bounce.hits, bounce.rays),
            visits_bounce: a_ray(bounce.visits, bounce.rays),
            opened_bounce: a_ray(bounce.opened, bounce.rays),
            tests_bounce: a_ray(bounce.tests, bounce.rays),
            repeats_bounce: a_ray(bounce.repeats, bounce.rays),
            hits_shadow: a_ray(shadow.hits, shadow.rays),
            visits_shadow: a_ray(shadow.visits, shadow.rays),
            opened_shadow: a_ray(shadow.opened, shadow.rays),
            tests_shadow: a_ray(shadow.tests, shadow.rays),
            repeats_shadow: a_ray(shadow.repeats, shadow.rays),
            break_even_rays: measured.get(i + 1).and_then(|next| break_even(m, next)),
            hash: format!("{:016x}", m.hash),
        }
    };
    (0..measured.len()).map(row).collect()
}

/// The number of bounce rays after which `next`, which takes longer to build, is faster in total; `None` if it
/// never is.
fn break_even(this: &Measurement, next: &Measurement) -> Option<f64> {
    let bounce = Query::ClosestBounce as usize;
    let gain = (this.nanoseconds[bounce] - next.nanoseconds[bounce]) * 1e-9;
    (gain > 0.0).then(|| (next.build_seconds - this.build_seconds) / gain)
}

/// Writes all rows to `compare.csv` in `folder`.
pub(crate) fn write_csv(folder: &Path, rows: &[Vec<Row>]) -> Result<PathBuf> {
    let path = folder.join("compare.csv");
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows.iter().flatten() {
        writer.serialize(row)?;
    }
    let bytes = writer.into_inner()?;
    AtomicFile::create(&path)?.commit(|file| file.write_all(&bytes))?;
    Ok(path)
}
