//! The program `globillum`, whose entry point is [`run`]. The programs of `globillum-lab` use the other public items:
//! accelerators by name, flags for cameras and colours, loading with warnings, errors on one line.
//!
//! The modules from the top: `commands` has the subcommands; `job` renders a picture as its `flags` say, watched by
//! `monitor`; `farm` divides a picture into tasks, and `merging` merges checkpoints; `output` writes pictures and
//! `summary` reports figures; `console` alone writes to the terminal; `exit` has the exit codes.

mod accel;
mod brightness;
mod checkpoint;
mod checkpoint_coverage;
mod commands;
mod console;
mod exit;
mod exr_range;
mod failures;
mod farm;
mod file_conflicts;
mod flags;
mod interrupt;
mod job;
mod json;
mod load;
mod merging;
mod monitor;
mod output;
mod overwrite_check;
mod parse;
mod patches;
mod points;
mod preview;
mod progress;
mod report;
mod subject;
mod summary;
mod threads;
mod usage;
pub mod view;

pub use accel::AccelKind;
pub use commands::run;
pub use console::warn;
pub use load::load_mesh;
pub use report::report_and_exit;
