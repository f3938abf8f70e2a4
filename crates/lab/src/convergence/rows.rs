//! The figures as CSV. Errors are relative to the mean radiance; times are in seconds.

use super::combination::accel_name;
use super::ladder::{Ladder, Level};
use super::race::Race;
use super::study::Study;
use anyhow::Result;
use globillum::io::AtomicFile;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// A row of `samples.csv`: a combination with a number of samples per pixel.
#[derive(Serialize)]
struct SampleRow<'a> {
    scene: &'a str,
    accelerator: &'static str,
    estimator: String,
    sampler: &'static str,
    samples: u32,
    seconds: f64,
    rmse: f64,
    rmse_low_95: f64,
    rmse_high_95: f64,
    block_rmse: f64,
    mse_seconds: f64,
    z: f64,
    largest_share: f64,
    hash: String,
}

/// A row of `time.csv`: a combination rendered for a given time.
#[derive(Serialize)]
struct TimeRow<'a> {
    scene: &'a str,
    accelerator: &'static str,
    estimator: String,
    sampler: &'static str,
    seconds: f64,
    samples: u32,
    rmse: f64,
    rmse_low_95: f64,
    rmse_high_95: f64,
    block_rmse: f64,
    rmse_estimated: Option<f64>,
    z: f64,
}

/// Writes both tables.
pub(crate) fn write(folder: &Path, studies: &[Study]) -> Result<Vec<PathBuf>> {
    let samples = studies.iter().flat_map(|study| {
        study
            .ladders
            .iter()
            .flat_map(|ladder| ladder.levels.iter().map(|level| sample_row(&study.name, ladder, level)))
    });
    let times = studies.iter().flat_map(|study| study.races.iter().map(|race| time_row(&study.name, race)));
    Ok(vec![write_csv(&folder.join("samples.csv"), samples)?, write_csv(&folder.join("time.csv"), times)?])
}

fn sample_row<'a>(scene: &'a str, ladder: &Ladder, level: &Level) -> SampleRow<'a> {
    let errors = &level.errors;
    let [rmse_low_95, rmse_high_95] = errors.interval_95();
    SampleRow {
        scene,
        accelerator: accel_name(ladder.accel),
        estimator: ladder.combination.estimator_name(),
        sampler: ladder.combination.sampler_name(),
        samples: level.samples,
        seconds: level.seconds,
        rmse: errors.rmse(),
        rmse_low_95,
        rmse_high_95,
        block_rmse: errors.block_rmse(),
        mse_seconds: errors.mse * level.seconds,
        z: errors.z,
        largest_share: errors.largest_share,
        hash: format!("{:016x}", level.hash),
    }
}

fn time_row<'a>(scene: &'a str, race: &Race) -> TimeRow<'a> {
    let [rmse_low_95, rmse_high_95] = race.errors.interval_95();
    TimeRow {
        scene,
        accelerator: accel_name(race.accel),
        estimator: race.combination.estimator_name(),
        sampler: race.combination.sampler_name(),
        seconds: race.seconds,
        samples: race.samples,
        rmse: race.errors.rmse(),
        rmse_low_95,
        rmse_high_95,
        block_rmse: race.errors.block_rmse(),
        rmse_estimated: Some(race.estimated_rmse).filter(|rmse| rmse.is_finite()),
        z: race.errors.z,
    }
}

fn write_csv(path: &Path, rows: impl Iterator<Item = impl Serialize>) -> Result<PathBuf> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.serialize(row)?;
    }
    let bytes = writer.into_inner()?;
    AtomicFile::create(path)?.commit(|file| file.write_all(&bytes))?;
    Ok(path.to_owned())
}
