//! The report: Markdown with plots, tables and explanations.

use super::combination::accel_name;
use super::geometry::{Furnace, Geometry};
use super::ladder::Ladder;
use super::plan::Plan;
use super::study::Study;
use crate::machine::{command, cpu_model, date};
use crate::table::table;
use anyhow::Result;
use comfy_table::Table;
use globillum::io::AtomicFile;
use globillum_testkit::stats::Z_LIMIT;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Writes `report.md`.
pub(crate) fn write(folder: &Path, plan: &Plan, studies: &[Study], geometry: &Geometry) -> Result<PathBuf> {
    let mut text = String::new();
    head(&mut text, plan)?;
    for study in studies {
        scene(&mut text, plan, study)?;
    }
    tests(&mut text, plan, geometry)?;
    let path = folder.join("report.md");
    AtomicFile::create(&path)?.commit(|file| file.write_all(text.as_bytes()))?;
    Ok(path)
}

fn head(text: &mut String, plan: &Plan) -> Result<()> {
    let cpu = cpu_model().unwrap_or_else(|| "unknown processor".to_owned());
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = if plan.threads == 0 { threads } else { plan.threads };
    writeln!(
        text,
        "# Speed against error\n\n`{}`, {}\n\n{cpu}, {threads} threads; pictures of {side} x {side} pixels. The figures \
         are also in `samples.csv` and `time.csv`.\n\n\
         - **RMSE**: root of the mean squared error over pixels and components, in percent of their mean \
         radiance. The 95 % confidence interval follows in parentheses, by the sample variance over the pixels. \
         With path reuse, whose errors depend on each other within tiles of 16 x 16 pixels, it is by the spread over these.\n\
         - **slope** of the logarithm of the RMSE over that of the number of samples. Each number of samples has \
         its own random numbers. The slope is -0.5 for independent samples without bias, and less for Sobol' points \
         (here stratified over all samples of a picture).\n\
         - **z**: mean error over its standard error, of the picture with most samples. The verdict is *biased* \
         if |z| exceeds {Z_LIMIT}, which an unbiased picture does with probability 5e-9, or if the slope exceeds \
         -0.5 by more than {Z_LIMIT} standard errors.\n\
         - The last row of the first table is limited to two bounces on purpose. Where illumination by more bounces \
         matters, its verdict must be *biased*.\n\
         - **hash** of that picture's bits. All accelerators have the same hash; otherwise no report is written.\n\
         - **MSE x s**: mean squared error over the squared mean radiance, times seconds, of the picture with most \
         samples: the inverse of the efficiency. For independent samples it is the time in seconds to a relative \
         RMSE of 100 %.\n",
        command("convergence"),
        date(),
        side = plan.side,
    )?;
    Ok(())
}

fn scene(text: &mut String, plan: &Plan, study: &Study) -> Result<()> {
    let Study { name, triangles, reference, .. } = study;
    writeln!(text, "## {name}\n\n{triangles} triangles. {reference}\n")?;
    writeln!(text, "![RMSE over seconds](convergence-{name}.svg)\n")?;
    if study.reference_error > 0.0 {
        writeln!(
            text,
            "A dotted line marks the larger of the references' own errors, if it lies within the plot.\n"
        )?;
    }
    writeln!(text, "{}\n", by_samples(plan, study))?;
    writeln!(text, "{}\n", by_time(plan, study))?;
    writeln!(
        text,
        "The last column is the RMSE that the picture itself estimates, without the reference, from passes of 16 \
         samples; Sobol' points need two passes. The equal-time pictures by the {}, with one exposure, and their \
         errors:\n",
        accel_name(study.ladders[0].accel)
    )?;
    writeln!(text, "![pictures of equal time](equal-time-{name}.png)\n")?;
    Ok(())
}

/// Errors and verdicts. They do not depend on the accelerator.
fn by_samples(plan: &Plan, study: &Study) -> Table {
    let shown = [0, plan.samples.len() / 2, plan.samples.len() - 1];
    let [first, middle, last] = shown.map(|i| format!("RMSE %, {} spp", plan.samples[i]));
    let last = format!("{last} (95 %)");
    let mut table = table(&[
        "estimator",
        "sampler",
        &first,
        &middle,
        &last,
        "4 x 4 means",
        "slope",
        "z",
        "verdict",
        "hash",
    ]);
    for ladder in study.ladders_of_first() {
        let [first, middle, _] = shown.map(|i| percent(ladder.levels[i].errors.rmse()));
        let top = &ladder.top().errors;
        let slope = ladder.slope();
        table.add_row([
            ladder.combination.estimator_name(),
            ladder.combination.sampler_name().to_owned(),
            first,
            middle,
            with_interval(top.rmse(), top.interval_95()),
            percent(top.block_rmse()),
            slope.map_or("".to_owned(), |s| format!("{:.3} +- {:.3}", s.value, s.std_err)),
            format!("{:.1}", top.z),
            ladder.verdict().to_string(),
            format!("{:016x}", ladder.top().hash),
        ]);
    }
    table
}

/// Times, and errors after equal times. They depend on the accelerator.
fn by_time(plan: &Plan, study: &Study) -> Table {
    let equal = format!("samples in {} s", plan.seconds);
    let mut table = table(&[
        "accelerator",
        "estimator",
        "sampler",
        "s, most samples",
        "MSE x s",
        &equal,
        "RMSE % (95 %)",
        "4 x 4 means",
        "estimated %",
    ]);
    for race in &study.races {
        let same = |ladder: &&Ladder| (ladder.accel, ladder.combination) == (race.accel, race.combination);
        let ladder = study.ladders.iter().find(same);
        table.add_row([
            accel_name(race.accel).to_owned(),
            race.combination.estimator_name(),
            race.combination.sampler_name().to_owned(),
            ladder.map_or(String::new(), |ladder| format!("{:.3}", ladder.top().seconds)),
            ladder.map_or(String::new(), |ladder| format!("{:.1e}", ladder.mse_seconds())),
            race.samples.to_string(),
            with_interval(race.errors.rmse(), race.errors.interval_95()),
            percent(race.errors.block_rmse()),
            if race.estimated_rmse.is_finite() { percent(race.estimated_rmse) } else { "unknown".to_owned() },
        ]);
    }
    table
}

fn tests(text: &mut String, plan: &Plan, geometry: &Geometry) -> Result<()> {
    writeln!(text, "## Ray-triangle tests\n\n![tests and furnaces](geometry.svg)\n")?;
    let mut decisions = table(&[
        "test",
        "ns, median",
        "fastest",
        "t, mean ulps",
        "t, largest ulps",
        "leaks of 1e6: edges",
        "vertices",
        "slivers missed",
    ]);
    for decision in &geometry.decisions {
        decisions.add_row([
            decision.name.to_owned(),
            format!("{:.1}", decision.nanoseconds[0]),
            format!("{:.1}", decision.nanoseconds[1]),
            format!("{:.2}", decision.ulps.mean),
            format!("{:.0}", decision.ulps.max),
            format!("{:.0}", decision.leaks[0]),
            format!("{:.0}", decision.leaks[1]),
            format!("{:.1} %", decision.slivers),
        ]);
    }
    writeln!(
        text,
        "{decisions}\n\n{} rays for each figure. Ulps are those of the test's own precision; one of `f32` is 5.4e8 \
         of `f64`. Slivers are 1e-8 wide. The program `accuracy` prints more figures.\n",
        plan.rays
    )?;
    writeln!(text, "## Size and position\n\n{}\n", furnaces(geometry))?;
    writeln!(
        text,
        "Closed cubes of albedo 0.8 that emit 1 have the radiance 5 everywhere. The paths have 64 bounces by BSDF \
         sampling; a path is lost if its radiance differs from the exact sum by a bit. Mitsuba's figures were \
         measured once, with version 3.9.1 and its variant `scalar_rgb`; their statistical error is about 0.005."
    )?;
    Ok(())
}

fn furnaces(geometry: &Geometry) -> Table {
    let mut table = table(&[
        "half side",
        "offset",
        "paths",
        "lost",
        "radiance",
        "relative error",
        "Mitsuba",
        "its error",
    ]);
    for Furnace { half, offset, loss, mitsuba } in geometry.sizes.iter().chain(&geometry.offsets) {
        let error = |radiance: f64| radiance / 5.0 - 1.0;
        table.add_row([
            format!("{half:e}"),
            format!("{offset:e}"),
            loss.paths.to_string(),
            loss.lost.to_string(),
            format!("{:.6}", loss.mean),
            format!("{:.1e}", error(loss.mean)),
            mitsuba.map_or(String::new(), |radiance| format!("{radiance:.3}")),
            mitsuba.map_or(String::new(), |radiance| format!("{:.1} %", 100.0 * error(radiance))),
        ]);
    }
    table
}

/// A share in percent with three significant digits.
fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    let decimals = (2 - percent.abs().max(1e-9).log10().floor() as i32).clamp(0, 6) as usize;
    format!("{percent:.decimals$}")
}

fn with_interval(rmse: f64, [low, high]: [f64; 2]) -> String {
    format!("{} ({} to {})", percent(rmse), percent(low), percent(high))
}
