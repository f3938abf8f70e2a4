//! Prints the accuracy and speed of ray-triangle tests as Markdown tables:
//! `cargo run --release -p globillum-lab --bin accuracy`.
//!
//! Compares the library's exact decision and two well-known tests in `f32` with exact rational arithmetic.
//! docs/numerics.md contains the tables and explains them.

pub(crate) mod intersectors;
pub(crate) mod measure;

use crate::machine::{command, cpu_model};
use anyhow::Result;
use clap::Parser;
use glam::DVec3;
use globillum::geom::conformance::Target;
use globillum::geom::decide::Shear;
use globillum_testkit::aimed::Ball;
use intersectors::{Intersector, MoellerTrumbore, Woop};
use measure::{Misses, errors, leaks, sliver_misses, time};
use std::io::Write;

/// Prints the accuracy and speed of ray-triangle tests.
#[derive(Debug, Parser)]
#[command(version)]
pub struct Options {
    /// Rays for each count of leaks, and for the errors
    #[arg(long, default_value_t = 200_000, value_parser = clap::value_parser!(u32).range(1..))]
    rays: u32,
    /// Seed of the random numbers
    #[arg(long, default_value_t = 0)]
    seed: u64,
}

/// Rays aimed at slivers of each width.
const SLIVER_RAYS: u32 = 20_000;
const SLIVER_WIDTHS: [f64; 3] = [1e-4, 1e-8, 1e-12];

/// Measures, and writes all tables to `out`.
///
/// # Errors
/// An error of `out`.
pub fn run(options: &Options, out: &mut impl Write) -> Result<()> {
    write_table(
        out,
        &[
            "speed and error in ulps",
            "ns per test",
            "fastest run",
            "hits",
            "t, mean",
            "t, max",
            "point, mean",
            "point, max",
        ],
        [
            speed_and_errors::<MoellerTrumbore>(options),
            speed_and_errors::<Woop>(options),
            speed_and_errors::<Shear>(options),
        ],
    )?;
    write_table(
        out,
        &["slivers missed of 20 000", "width 1e-4", "1e-8", "1e-12"],
        [misses::<MoellerTrumbore>(options), misses::<Woop>(options), misses::<Shear>(options)],
    )?;
    write_table(
        out,
        &["leaks per million, edge / vertex", "r = 1", "r = 1e-3", "r = 2, off center"],
        [leaks_of::<MoellerTrumbore>(options), leaks_of::<Woop>(options), leaks_of::<Shear>(options)],
    )?;
    let cpu = cpu_model().unwrap_or_else(|| "unknown".to_owned());
    Ok(writeln!(out, "{cpu}: `{}`", command("accuracy"))?)
}

fn speed_and_errors<I: Intersector>(options: &Options) -> Vec<String> {
    let timing = time::<I>(options.seed);
    let [t, point] = errors::<I>(options.seed, options.rays);
    let ns = [timing.median_ns, timing.fastest_ns].map(|ns| format!("{ns:.1}"));
    let hits = format!("{:.0} %", 100.0 * timing.hit_rate);
    let ulps = [t, point].map(|errors| [format!("{:.2}", errors.mean), format!("{:.0}", errors.max)]);
    [vec![I::NAME.to_owned()], ns.to_vec(), vec![hits], ulps.concat()].concat()
}

fn misses<I: Intersector>(options: &Options) -> Vec<String> {
    let columns = SLIVER_WIDTHS.map(|width| {
        let Misses { all, meeting, wrong } = sliver_misses::<I>(width, options.seed, SLIVER_RAYS);
        format!("{all} ({wrong} of {meeting})")
    });
    [vec![I::NAME.to_owned()], columns.to_vec()].concat()
}

fn leaks_of<I: Intersector>(options: &Options) -> Vec<String> {
    let balls = [
        Ball::new(DVec3::ZERO, 1.0),
        Ball::new(DVec3::ZERO, 1e-3),
        Ball::new(DVec3::new(148_376.0, 1234.0, -223_423.0), 2.0),
    ];
    let columns = balls.map(|ball| {
        let [edge, vertex] = [Target::Edges, Target::Vertices].map(|target| {
            let count = leaks::<I>(&ball, target, options.seed, options.rays);
            (f64::from(count) * 1e6 / f64::from(options.rays)).round()
        });
        format!("{edge} / {vertex}")
    });
    [vec![I::NAME.to_owned()], columns.to_vec()].concat()
}

/// Writes a Markdown table with right-aligned numbers.
fn write_table(out: &mut impl Write, head: &[&str], rows: [Vec<String>; 3]) -> Result<()> {
    writeln!(out, "| {} |", head.join(" | "))?;
    writeln!(out, "|---|{}", "---:|".repeat(head.len() - 1))?;
    for row in rows {
        writeln!(out, "| {} |", row.join(" | "))?;
    }
    Ok(writeln!(out)?)
}
