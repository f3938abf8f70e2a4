//! The program `globillum`: [`run`] is all of it. What else is public is what programs beside it share:
//! accelerators by name, flags for cameras and colours, loading with warnings, errors on one line.
//!
//! The modules from the top: `commands` holds what each subcommand does; `job` renders a picture by `flags`,
//! watched by `monitor`; `farm` holds what its parts are on a farm, `merging` puts them together; `output` and
//! `summary` say what came of it; `console` alone writes to the terminal, `exit` has the exit codes.

mod accel;
mod checkpoint;
mod checkpoint_coverage;
mod commands;
mod console;
mod exit;
mod failures;
mod farm;
mod file_conflicts;
mod flags;
mod interrupt;
mod job;
mod load;
mod merging;
mod monitor;
mod output;
mod overwrite_check;
mod parse;
mod points;
mod preview;
mod progress;
mod report;
mod summary;
mod usage;
pub mod view;

pub use accel::AccelKind;
pub use commands::run;
pub use console::warn;
pub use load::load_mesh;
pub use report::report_and_exit;
