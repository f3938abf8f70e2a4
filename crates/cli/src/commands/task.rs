use super::picture_command::PictureCommand;
use crate::checkpoint::{self, Checkpoint, SaveEvery};
use crate::exit::CODES;
use crate::failures::Failures;
use crate::farm::{Part, Plan, Task, part_file, parts_folder};
use crate::file_conflicts::Uses;
use crate::interrupt::Interrupt;
use crate::monitor::RenderMonitor;
use crate::subject::BuiltSubject;
use crate::{checkpoint_coverage, console, parse, threads};
use anyhow::{Context, Result, anyhow, bail, ensure};
use globillum::integrator::{CheckpointError, Picture, Render, Settings};
use std::path::{Path, PathBuf};

const LONG_ABOUT: &str = "\
Renders one task of a job, and saves its part in the folder beside the job file.

A task that was interrupted goes on from what it saved; one that is done ends at once. A damaged part is set aside, \
with the extension `damaged`, and rendered again; so is one that holds what is not the task's, with the extension \
`misplaced`. SIGTERM, SIGINT and SIGHUP end the task after the passes that are complete, \
with exit code 75: schedulers that run tasks with this code again (RequeueExit of Slurm) complete the picture.

The task's index is --index, or SLURM_ARRAY_TASK_ID, AWS_BATCH_JOB_ARRAY_INDEX or JOB_COMPLETION_INDEX.";

const EXAMPLES: &str = "\
Examples:
  On any machine:
      globillum task room.json --index 3
  In an array job of Slurm whose indices begin at 1001:
      globillum task room.json --offset 1001";

/// Renders one task of a job
#[derive(clap::Args, Debug)]
#[command(long_about = LONG_ABOUT, after_long_help = format!("{CODES}\n\n{EXAMPLES}"))]
pub(crate) struct Options {
    /// Job file of `globillum plan`
    #[arg(value_name = "JOB.json")]
    job: PathBuf,
    /// Which task [default: the index that the scheduler gives]
    #[arg(long, value_name = "I", value_parser = parse::integer(0..=u32::MAX), allow_negative_numbers = true)]
    index: Option<u32>,
    /// Added to the index: for arrays that begin at 0 again
    #[arg(long, value_name = "I", default_value_t = 0, value_parser = parse::integer(0..=u32::MAX))]
    #[arg(allow_negative_numbers = true)]
    offset: u32,
    /// Worker threads [default: SLURM_CPUS_PER_TASK, or one for each processor]
    #[arg(long, value_name = "N", value_parser = parse::integer(1..=Settings::MAX_THREADS))]
    #[arg(allow_negative_numbers = true)]
    threads: Option<usize>,
}

/// Where schedulers say the index of a task.
const INDICES: [&str; 3] = ["SLURM_ARRAY_TASK_ID", "AWS_BATCH_JOB_ARRAY_INDEX", "JOB_COMPLETION_INDEX"];

pub(crate) fn run(options: &Options) -> Result<()> {
    let interrupt = Interrupt::catch_to_run_again()?;
    let job = options.job.as_path();
    let plan = Plan::read(job)?;
    let task = options.task(&plan)?;
    let path = part_file(job, task.index);
    Uses::default().read("the job", [job]).written("the part", [&path]).check()?;
    let before = read_or_set_aside(&path, plan.key(), &task)?;
    let passes = task.passes.len() as u64;
    if before.as_ref().is_some_and(|picture| passes_of(picture) == passes) {
        return console::print(format!("{task}: is complete\n").as_bytes());
    }
    let command = PictureCommand::parse(&plan.picture).with_context(|| job.display().to_string())?;
    let mut settings = command.flags().settings();
    (settings.samples, settings.threads) = (plan.samples, options.threads()?.unwrap_or(settings.threads));
    threads::start(settings.threads)?;
    let BuiltSubject { scene, camera, .. } = command.build(&interrupt)?;
    let render =
        Render::new(&scene, camera.sensor(), &settings).rows(task.rows.clone()).passes(task.passes.clone());
    let name = job.display();
    ensure!(render.key() == plan.key(), "{name}: was planned by another build or for another scene");
    let folder = parts_folder(job);
    std::fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    let checkpoint = Checkpoint::new(&path, SaveEvery::Hundredth)?;
    let resumed = before.as_ref().map_or(0, passes_of);
    if resumed > 0 {
        console::note(format_args!("{task}: goes on after {resumed} of {passes} passes"));
    }
    let render = before.into_iter().fold(render, Render::resume);
    let monitor = RenderMonitor::new(Some(checkpoint), &interrupt);
    let mut failures = Failures::default();
    let (picture, ..) = monitor.run(|monitor| render.monitor(monitor).run(), &mut failures)?;
    failures.into_result()?;
    let kept = format!("{task}: {} of {passes} passes are kept", passes_of(&picture));
    interrupt.check_ending(picture.ending, kept)?;
    console::print(format!("{task}: is complete\n").as_bytes())
}

impl Options {
    fn task(&self, plan: &Plan) -> Result<Task> {
        let given = || INDICES.iter().find_map(|name| Some((name, std::env::var_os(name)?)));
        let index = match (self.index, given()) {
            (Some(index), _) => index,
            (None, Some((name, value))) => number(name, &value.to_string_lossy())?,
            (None, None) => bail!("neither --index nor {} is given", INDICES.join(" nor ")),
        };
        let index = index.checked_add(self.offset);
        let tasks = plan.division.tasks();
        let task = index.and_then(|index| plan.task(index));
        task.ok_or_else(|| anyhow!("{}: has only tasks 0 to {}", self.job.display(), tasks - 1))
    }

    fn threads(&self) -> Result<Option<usize>> {
        const NAME: &str = "SLURM_CPUS_PER_TASK";
        if self.threads.is_some() {
            return Ok(self.threads);
        }
        let given = std::env::var(NAME).ok().filter(|value| !value.is_empty());
        let given = given.map(|value| number::<usize>(NAME, &value)).transpose()?;
        Ok(given.map(|threads| threads.clamp(1, Settings::MAX_THREADS)))
    }
}

fn number<T: std::str::FromStr>(name: &str, value: &str) -> Result<T> {
    value.parse().map_err(|_| anyhow!("{name}={value}: must be an integer from 0"))
}

fn passes_of(picture: &Picture) -> u64 {
    picture.film.passes().iter().map(|range| range.len() as u64).sum()
}

/// The part that was saved before; one that is damaged or another's gets another name, so that the task begins again.
fn read_or_set_aside(path: &Path, key: u64, task: &Task) -> Result<Option<Picture>> {
    if !checkpoint::exists(path)? {
        return Ok(None);
    }
    let part = Part::read(path, key)?;
    let damage = match &part {
        Part::Foreign(error) => return Err(*error).with_context(|| path.display().to_string()),
        Part::Damaged(error) => *error,
        Part::Good(header, _) if !part.is_of(task) => {
            let held = format!("holds {}, which is not {task}", checkpoint_coverage::describe(header));
            return set_aside(path, "misplaced", &held).map(|()| None);
        }
        Part::Good(..) => match checkpoint::read(path) {
            Ok(picture) => return Ok(Some(picture)),
            Err(error) => match error.downcast_ref::<CheckpointError>() {
                Some(damage) => *damage,
                None => return Err(error),
            },
        },
    };
    set_aside(path, "damaged", &damage.to_string()).map(|()| None)
}

/// Gives a part another name, which no file has, and says why.
fn set_aside(path: &Path, extension: &str, reason: &str) -> Result<()> {
    let aside = checkpoint::free_path(path, extension)?;
    std::fs::rename(path, &aside).with_context(|| path.display().to_string())?;
    console::warn(format_args!("{}: {reason}; set aside as {}", path.display(), aside.display()));
    Ok(())
}
