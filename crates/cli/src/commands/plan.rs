use super::picture_command::PictureCommand;
use crate::exit::CODES;
use crate::farm::{Division, Plan, Task, arrays, parts_folder};
use crate::file_conflicts::Uses;
use crate::flags::RenderFlags;
use crate::interrupt::Interrupt;
use crate::json::to_json;
use crate::subject::BuiltSubject;
use crate::{checkpoint, console, parse, threads};
use anyhow::{Context, Result, anyhow, ensure};
use globillum::integrator::{Picture, Render, Settings, Stop};
use globillum::io::AtomicFile;
use std::ffi::OsString;
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};

const LONG_ABOUT: &str = "\
Divides a picture into tasks for a farm, and writes a job file for `globillum task`, `status` and `merge`.

A task is a range of passes of the whole picture, or of a strip of it if the picture is large or has few passes. \
Tasks depend on no other. The job file holds the command line of the picture and the picture's key, a hash of scene, camera, \
settings and the program's sources: what another program or another scene would render is never mixed with it. \
Files of the scene are named as the tasks find them, from the folder where they run.

--error plans for an error of the whole farm, in two stages: first a pilot of a few passes is planned, rendered and \
merged; then its error says how many passes this job needs, none of which is the pilot's (Stein 1945).";

const EXAMPLES: &str = "\
Examples:
  At least 256 tasks, and what they do:
      globillum plan room.json --tasks 256 -- render room.glb --width 1920 --height 1080 --spp 4096
  A picture of 1 % error: a pilot of 8 passes, and the picture:
      globillum plan pilot.json --tasks 8 -- render room.glb --spp 128
      globillum merge --expect pilot.json --checkpoint pilot.film
      globillum plan room.json --error 0.01 --pilot pilot.film -- render room.glb";

/// Divides a picture into tasks for a farm
#[derive(clap::Args, Debug)]
#[command(long_about = LONG_ABOUT, after_long_help = format!("{CODES}\n\n{EXAMPLES}"))]
pub(crate) struct Options {
    /// Job file to write; the tasks' parts go to a folder beside it, with the extension `parts`
    #[arg(value_name = "JOB.json")]
    job: PathBuf,
    /// About how many tasks: at least N, unless a task would be less than a pass of 16 rows
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = parse::integer(1..=u32::MAX))]
    #[arg(allow_negative_numbers = true)]
    tasks: u32,
    /// Render as many passes as a relative RMSE of E needs, judged by --pilot
    #[arg(long, value_name = "E", value_parser = parse::positive, allow_negative_numbers = true)]
    #[arg(requires = "pilot")]
    error: Option<f64>,
    /// Merged checkpoint of the pilot, a job of a few passes of the same picture
    #[arg(long, value_name = "CHECKPOINT", requires = "error")]
    pilot: Option<PathBuf>,
    /// Largest size of an array of tasks that the scheduler takes (MaxArraySize of Slurm)
    #[arg(long, value_name = "N", default_value_t = 1001, value_parser = parse::integer(1..=u32::MAX))]
    #[arg(allow_negative_numbers = true)]
    max_array_size: u32,
    /// The picture: `render` or `cornell` with its flags, as on the command line
    #[arg(last = true, required = true, value_name = "COMMAND")]
    picture: Vec<OsString>,
}

pub(crate) fn run(options: &Options) -> Result<()> {
    let job = &options.job;
    ensure!(!checkpoint::exists(job)?, "{}: exists already", job.display());
    let interrupt = Interrupt::catch()?;
    let picture: Vec<String> = options.picture.iter().map(as_text).collect::<Result<_>>()?;
    let command = PictureCommand::parse(&picture)?;
    let flags = command.flags();
    flags.check_for_farm()?;
    threads::start(flags.speed.threads)?;
    let parts = parts_folder(job);
    Uses::default().written("the job", [job]).written("the folder of its parts", [&parts]).check()?;
    let has_parts = fs::read_dir(&parts).is_ok_and(|mut files| files.next().is_some());
    ensure!(!has_parts, "{}: is not empty: move it away, or give the job another name", parts.display());
    let file = AtomicFile::create(job)?;
    let BuiltSubject { scene, camera, .. } = command.build(&interrupt)?;
    let settings = flags.settings();
    let key = Render::new(&scene, camera.sensor(), &settings).key();
    let (passes, samples) = match options.error.zip(options.pilot.as_ref()) {
        Some((error, pilot)) => {
            let passes = passes_after(pilot, error, key, flags)?;
            let samples = passes.end.saturating_mul(settings.pass_samples);
            (passes, flags.samples_asked_for().map_or(samples, |asked| asked.min(samples)))
        }
        None => (0..settings.passes(), settings.samples),
    };
    let division = Division::new(settings.width, settings.height, passes, options.tasks);
    let plan = Plan::new(key, picture, camera.pinhole(), samples, division);
    let json = to_json(&plan)?;
    file.commit(|writer| writer.write_all(json.as_bytes()))?;
    console::print(table(job, &plan, &settings, options.max_array_size).as_bytes())
}

/// A word of the picture's command line as a job file can hold it.
fn as_text(word: &OsString) -> Result<String> {
    let text = word.clone().into_string();
    text.map_err(|word| anyhow!("{}: is not UTF-8, which a job file must be", word.display()))
}

/// The passes after those of the pilot that its error asks for.
fn passes_after(pilot: &Path, error: f64, key: u64, flags: &RenderFlags) -> Result<Range<u32>> {
    let picture = checkpoint::read::<Picture>(pilot)?;
    let name = pilot.display();
    ensure!(picture.key == key, "{name}: is of another picture or build");
    ensure!(picture.film.height() == picture.height, "{name}: holds a strip of the picture");
    let mut stop = Stop::default();
    stop.relative_rmse = Some(error);
    let needed = stop.passes_after(&picture.film).filter(|needed| needed.is_finite());
    let needed = needed.with_context(|| format!("{name}: holds too few passes to judge its error"))?;
    let start = picture.film.passes().last().map_or(0, |range| range.end);
    let most = u32::MAX / picture.pass_samples;
    let limit = flags.samples_asked_for().map_or(most, |spp| spp.div_ceil(picture.pass_samples));
    ensure!(start < limit, "--spp: leaves no pass after those of the pilot");
    let end = (f64::from(start) + needed).min(f64::from(limit)) as u32;
    if f64::from(end - start) < needed {
        console::warn(format_args!(
            "the error asks for {needed} passes, of which {} are planned",
            end - start
        ));
    }
    Ok(start..end)
}

fn table(job: &Path, plan: &Plan, settings: &Settings, max_array_size: u32) -> String {
    let tasks: Vec<u32> = plan.tasks().map(|task| task.index).collect();
    let most = |of: fn(&Task) -> usize| plan.tasks().map(|task| of(&task)).max().unwrap_or_default();
    let (passes, rows) = (most(|task| task.passes.len()), most(|task| task.rows.len()));
    let samples = (passes * settings.pass_samples as usize).min(plan.samples as usize);
    let pixels = rows as u64 * u64::from(settings.width);
    let megabytes = checkpoint::most_bytes(pixels, passes.next_power_of_two() as u32) as f64 / 1e6;
    let mut table = format!("tasks         {}\n", tasks.len());
    table += &format!("of a task     {passes} passes, {samples} samples a pixel, of {rows} rows, at most\n");
    table += &format!("its part      {megabytes:.1} MB at most, in {}\n", parts_folder(job).display());
    for (offset, indices) in arrays(&tasks, max_array_size) {
        table += &format!("array         {indices}, offset {offset}\n");
    }
    table
}
