//! The program's commands.

mod cornell;
mod diff;
mod irradiance;
mod merge;
mod picture_command;
mod plan;
mod render;
mod status;
mod task;
mod view_factors;

use crate::exit::CODES;
use crate::report::report_and_exit;
use clap::{Parser, Subcommand};
use std::process::ExitCode;

const LONG_ABOUT: &str = "\
Renders pictures with global illumination by path tracing: light that reaches the camera directly, by way of \
mirrors, and after any number of diffuse bounces.

A picture comes with its own error: the standard error of each pixel, and a confidence interval for the \
picture's. Its bits depend on scene, camera and settings alone, not on the number of threads, the accelerator \
or the processor.";

const EXAMPLES: &str = "\
Examples:
  globillum cornell                              the Cornell box, to cornell.png
  globillum render SCENE.glb --error 0.01        a scene file, to 1 % error, to render.png
  globillum irradiance SCENE.glb --points P.csv  irradiance at points, to irradiance.csv
  globillum merge a.part b.part --out all.png    one picture of two parts
  globillum plan room.json -- render ROOM.glb    tasks for a farm
  globillum diff a.exr b.exr                     whether two pictures differ by more than chance
  globillum help render                          all about one command";

/// Renders pictures with global illumination by path tracing, and says how large their error is
#[derive(Debug, Parser)]
#[command(name = "globillum", version, long_about = LONG_ABOUT, after_long_help = format!("{CODES}\n\n{EXAMPLES}"))]
#[command(max_term_width = 110, arg_required_else_help = false)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Render(render::Options),
    Cornell(cornell::Options),
    Irradiance(irradiance::Options),
    Merge(merge::Options),
    Plan(plan::Options),
    Task(task::Options),
    Status(status::Options),
    ViewFactors(view_factors::Options),
    Diff(diff::Options),
}

/// Runs the program with the arguments of this process, and returns its exit code.
///
/// Errors are reported as [`report_and_exit`] does. After SIGINT, SIGTERM or SIGHUP the complete passes of a picture are
/// written; the second SIGINT or SIGTERM ends the process at once.
pub fn run() -> ExitCode {
    report_and_exit(Cli::try_parse(), |cli| match &cli.command {
        Command::Render(options) => render::run(options),
        Command::Cornell(options) => cornell::run(options),
        Command::Irradiance(options) => irradiance::run(options),
        Command::Merge(options) => merge::run(options),
        Command::Plan(options) => plan::run(options),
        Command::Task(options) => task::run(options),
        Command::Status(options) => status::run(options),
        Command::ViewFactors(options) => view_factors::run(options),
        Command::Diff(options) => diff::run(options),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    /// Otherwise `-1` is told to be an unexpected argument, not a value that is out of range.
    #[test]
    fn every_number_may_begin_with_a_minus() {
        let mut lists = 0;
        for command in Cli::command().get_subcommands() {
            let options = command.get_arguments().filter(|option| {
                !option.is_positional()
                    && option.get_action().takes_values()
                    && option.get_possible_values().is_empty()
            });
            for option in options {
                let name = option.get_value_names().unwrap_or_default().concat();
                let is_path =
                    ["FILE", "JOB", "CHECKPOINT", "PICTURE"].iter().any(|word| name.starts_with(word));
                let is_list = name.contains(',') || name.contains("..");
                let allows = match (is_path, is_list) {
                    (true, _) => true,
                    (false, true) => option.is_allow_hyphen_values_set(),
                    (false, false) => option.is_allow_negative_numbers_set(),
                };
                lists += u32::from(is_list && !is_path);
                assert!(allows, "{} --{:?} <{name}>", command.get_name(), option.get_long());
            }
        }
        assert!(
            lists >= 8,
            "--crop, --passes, --camera and --environment, each of several commands: {lists}"
        );
    }
}
