use crate::accel::AccelKind;
use crate::parse;
use globillum::integrator::Settings;
use serde::Serialize;

#[derive(clap::Args, Clone, Debug, Serialize)]
#[command(next_help_heading = "Speed (the picture's bits stay the same)")]
pub(crate) struct SpeedFlags {
    /// Accelerator that finds the triangles a ray meets
    #[arg(long, value_enum, default_value_t = AccelKind::Wide)]
    pub(crate) accel: AccelKind,
    /// Worker threads; 0 is one for each processor
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = parse::integer(0..=Settings::MAX_THREADS))]
    #[arg(allow_negative_numbers = true)]
    pub(crate) threads: usize,
}

impl SpeedFlags {
    /// The number of threads, never 0.
    pub(crate) fn resolved_threads(&self) -> usize {
        match self.threads {
            0 => std::thread::available_parallelism().map_or(1, Into::into).min(Settings::MAX_THREADS),
            threads => threads,
        }
    }
}
