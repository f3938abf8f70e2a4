use super::run::{RunFigures, Timing};
use crate::flags::MeasureFlags;
use globillum::geom::Accel;
use globillum::integrator::{Picture, Scene};
use serde::Serialize;
use std::fmt::{self, Display};

/// Settings and figures of a measurement at points. The keys of its JSON are described in the README of this crate.
#[derive(Debug, Serialize)]
pub(crate) struct PointsSummary<'a> {
    #[serde(flatten)]
    run: RunFigures<'a>,
    #[serde(flatten)]
    flags: &'a MeasureFlags,
    points: u32,
    samples_per_point: u32,
    irradiance_mean: [f64; 3],
}

impl<'a> PointsSummary<'a> {
    /// Gathers the figures.
    pub(crate) fn new<A: Accel>(
        name: &'a str,
        flags: &'a MeasureFlags,
        scene: &Scene<A>,
        picture: &Picture,
        timing: Timing,
    ) -> Self {
        Self {
            run: RunFigures::new(name, scene, picture, timing),
            flags,
            points: picture.film.height(),
            samples_per_point: picture.samples,
            irradiance_mean: picture.film.image_mean().to_array(),
        }
    }
}

impl Display for PointsSummary<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let run = &self.run;
        run.write_scene(f)?;
        writeln!(f, "points        {}, {} samples each", self.points, self.samples_per_point)?;
        let [bounce, shadow] = [run.bounce_rays, run.shadow_rays].map(|count| count as f64 / 1e6);
        writeln!(f, "rays          {bounce:.2} million bounce, {shadow:.2} shadow")?;
        let (seconds, rays) = (run.render_seconds, run.rays_per_second / 1e6);
        writeln!(f, "measured in   {seconds:.2} s: {rays:.2} million rays a second")?;
        run.write_end(f, "mean", self.irradiance_mean, &self.flags.stop())
    }
}
