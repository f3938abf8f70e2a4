use super::picture_command::PictureCommand;
use crate::exit::{CODES, Incomplete};
use crate::failures::Failures;
use crate::farm::{Part, Parts, Plan, Task, part_file};
use crate::file_conflicts::Uses;
use crate::flags::PictureOutput;
use crate::interrupt::{Interrupt, NOTHING};
use crate::merging::{self, Merged};
use crate::output::{Outputs, STDOUT};
use crate::{checkpoint, console, overwrite_check, parse, summary, threads};
use anyhow::{Context, Result, bail, ensure};
use globillum::integrator::{CheckpointError, CheckpointHeader};
use globillum::io::PictureData;
use std::cmp::Reverse;
use std::ops::Range;
use std::path::{Path, PathBuf};

const LONG_ABOUT: &str = "\
Joins checkpoints of one picture that was rendered in parts, on one machine or on several. The picture has the bits \
of one that was rendered at once, whatever the order of the parts, also if what was merged is merged again.

The parts must be of the same scene, camera, settings and build. Equal parts count once; two that hold the same pass \
and differ are refused. Pixels that no part holds are black.

--expect joins the parts of a job, or checks that the given ones hold all of it. If a part is missing or damaged, \
nothing is written, and the exit code is 3.";

const EXAMPLES: &str = "\
Examples:
  Render a picture in two parts and join them:
      globillum render SCENE.glb --spp 256 --passes 0..8 --checkpoint a.part
      globillum render SCENE.glb --spp 256 --passes 8..16 --checkpoint b.part
      globillum merge a.part b.part --out picture.png
  Collect parts in a checkpoint, from which `render --resume` can continue:
      globillum merge a.part b.part --checkpoint all.part
  All tasks of a job:
      globillum merge --expect room.json --out room.exr
  Tasks 0 to 63, and all from several such merges:
      globillum merge --expect room.json --tasks 0..64 --checkpoint 0.film
      globillum merge --expect room.json 0.film 64.film --out room.exr
  What is there, for a look while a job runs:
      globillum merge room.parts/*.part --out preview.png";

/// Joins checkpoints of one picture that was rendered in parts
#[derive(clap::Args, Debug)]
#[command(long_about = LONG_ABOUT, after_long_help = format!("{CODES}\n\n{EXAMPLES}"))]
pub(crate) struct Options {
    /// The parts, in any order [default: those of --expect]
    #[arg(required_unless_present = "expect", value_name = "CHECKPOINT")]
    parts: Vec<PathBuf>,
    /// Job file of `globillum plan`, of which nothing may be missing
    #[arg(long, value_name = "JOB.json")]
    expect: Option<PathBuf>,
    /// Only tasks A to B - 1 of the job; B may be larger than their number
    #[arg(long, value_name = "A..B", value_parser = parse::passes, requires = "expect")]
    #[arg(allow_hyphen_values = true)]
    tasks: Option<Range<u32>>,
    #[command(flatten)]
    output: PictureOutput,
    /// Save the joined checkpoint in FILE
    ///
    /// An existing file is replaced if it is one of the parts, or a checkpoint of the same picture of which the parts hold
    /// all passes. Any other file is refused.
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    checkpoint: Option<PathBuf>,
}

pub(crate) fn run(options: &Options) -> Result<()> {
    let nothing = options.output.out.is_empty() && options.checkpoint.is_none();
    ensure!(!nothing, "neither --out nor --checkpoint is given");
    let is_stdout = options.checkpoint.as_deref() == Some(Path::new(STDOUT));
    ensure!(!is_stdout, "--checkpoint -: a checkpoint needs a file");
    options.check_files()?;
    let interrupt = Interrupt::catch()?;
    threads::start(0)?;
    let outputs = Outputs::open(&options.output, None)?;
    let expected = options.expected()?;
    let parts = match &expected {
        Some(expected) if options.parts.is_empty() => expected.part_files()?,
        _ => options.parts.clone(),
    };
    if let Some(Expected { job, plan, .. }) = expected.as_ref().filter(|_| options.checkpoint.is_some()) {
        let of_tasks: Vec<PathBuf> = plan.tasks().map(|task| part_file(job, task.index)).collect();
        Uses::default()
            .read("a task's part", &of_tasks)
            .written("--checkpoint", &options.checkpoint)
            .check()?;
    }
    let check = |header: &CheckpointHeader| {
        expected.as_ref().map_or(Ok(()), |expected| expected.check(header))?;
        options.checkpoint.as_deref().map_or(Ok(()), |path| overwrite_check::check(path, &parts, header))
    };
    let cancelled = || interrupt.is_asked();
    let merged =
        merging::merge(&parts, options.checkpoint.as_deref(), outputs.want_picture(), check, cancelled);
    let merged = merged.map_err(|error| match error.downcast_ref::<CheckpointError>() {
        _ if interrupt.is_asked() => interrupt.error(NOTHING).into(),
        // What is damaged is rendered again.
        Some(damage) if expected.is_some() && is_damage(damage) => Incomplete(format!("{error:#}")).into(),
        _ => error,
    })?;
    let Merged { header, error, estimates } = merged;
    let data_on_stdout = outputs.use_stdout();
    let mut failures = Failures::default();
    if let Some(estimates) = estimates {
        let mut data = PictureData::of_merged(&header, estimates);
        if let Some(expected) = &expected {
            expected.describe(&mut data)?;
        }
        outputs.write(&data, || Ok(String::new()), &mut failures);
    }
    failures.keep(
        interrupt
            .ignore_after_hangup(console::print_table(&summary::of_merged(&header, error), data_on_stdout)),
    );
    failures.into_result()
}

fn is_damage(error: &CheckpointError) -> bool {
    use CheckpointError::{Checksum, Length, Malformed, NoCheckpoint};
    matches!(error, Checksum | Length | Malformed(_) | NoCheckpoint)
}

/// What a merge must hold.
struct Expected {
    job: PathBuf,
    plan: Plan,
    tasks: Vec<Task>,
}

impl Options {
    /// Refuses files with several uses. A part may be that of --checkpoint, which then holds all of it.
    fn check_files(&self) -> Result<()> {
        let pictures = || Uses::default().read("--expect", &self.expect).written("--out", &self.output.out);
        pictures().written("--checkpoint", &self.checkpoint).check()?;
        pictures().read("the part", &self.parts).check()
    }

    fn expected(&self) -> Result<Option<Expected>> {
        let Some(job) = &self.expect else { return Ok(None) };
        let plan = Plan::read(job)?;
        let count = plan.division.tasks();
        let Range { start, end } = self.tasks.clone().unwrap_or(0..count);
        ensure!(start < count, "--tasks {start}..{end}: {} has only tasks 0..{count}", job.display());
        let tasks = plan.tasks().take(end as usize).skip(start as usize).collect();
        Ok(Some(Expected { job: job.clone(), plan, tasks }))
    }
}

impl Expected {
    /// Files that hold the tasks, each of which must be complete, whatever their names: as few as there are, so that a merge
    /// of several parts replaces these.
    fn part_files(&self) -> Result<Vec<PathBuf>> {
        let parts = Parts::of(&self.job, &self.plan)?;
        let count = |part: &Part| self.tasks.iter().filter(|task| part.share_of(task) == 1.0).count();
        let mut candidates: Vec<&(PathBuf, Part)> = parts.0.iter().collect();
        candidates.sort_by_cached_key(|(_, part)| Reverse(count(part)));
        let mut files: Vec<&(PathBuf, Part)> = Vec::new();
        for task in &self.tasks {
            let holds = |(_, part): &&&(PathBuf, Part)| part.share_of(task) == 1.0;
            if files.iter().any(|file| holds(&file)) {
                continue;
            }
            match candidates.iter().find(holds) {
                Some(file) => files.push(file),
                None => return Err(self.lacks(task)),
            }
        }
        Ok(files.into_iter().map(|(path, _)| path.clone()).collect())
    }

    /// Why no file holds a task.
    fn lacks(&self, task: &Task) -> anyhow::Error {
        let path = part_file(&self.job, task.index);
        let name = path.display();
        let exists = match checkpoint::exists(&path) {
            Ok(exists) => exists,
            Err(error) => return error,
        };
        if !exists {
            return Incomplete(format!("{name}: {task} is missing")).into();
        }
        match Part::read(&path, self.plan.key()) {
            Ok(Part::Foreign(error)) => anyhow::Error::from(error).context(name.to_string()),
            Ok(Part::Damaged(error)) => Incomplete(format!("{name}: {error} ({task})")).into(),
            Ok(Part::Good(..)) => Incomplete(format!("{name}: {task} is not finished")).into(),
            Err(error) => error,
        }
    }

    /// Says of the picture what its checkpoints do not hold, as the render in one run does.
    fn describe(&self, data: &mut PictureData) -> Result<()> {
        let command =
            PictureCommand::parse(&self.plan.picture).with_context(|| self.job.display().to_string())?;
        data.set_settings(&command.flags().settings());
        data.camera = self.plan.camera;
        Ok(())
    }

    /// Whether a merge holds all tasks.
    fn check(&self, header: &CheckpointHeader) -> Result<()> {
        ensure!(header.key == self.plan.key(), "{}: is the plan of another picture", self.job.display());
        let part = Part::Good(header.clone(), Default::default());
        match self.tasks.iter().find(|task| part.share_of(task) < 1.0) {
            Some(task) => bail!(Incomplete(format!("{task} is missing"))),
            None => Ok(()),
        }
    }
}
