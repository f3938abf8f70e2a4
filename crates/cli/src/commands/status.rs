use crate::exit::CODES;
use crate::farm::{Part, Parts, Plan, Task, arrays};
use crate::{console, exit, parse};
use anyhow::Result;
use globillum::integrator::PixelSums;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

const LONG_ABOUT: &str = "\
Says how far a job is: which tasks are missing, which files are damaged, of another picture, or hold the same task, \
and which tasks to submit again.

Only the first and the last bytes of each part are read. Damage between them is found by `merge`, and by the task \
itself when it is submitted again. The error is that of the parts' own passes, which is less certain than that of \
the merged picture; it is not known if each part holds one pass.";

const EXAMPLES: &str = "\
Examples:
  How far is it?
      globillum status room.json
  Submit again what is missing, on Slurm, an array for each line of `OFFSET INDICES`:
      globillum status room.json --arrays";

/// Says how far a job is, and which tasks to submit again
#[derive(clap::Args, Debug)]
#[command(long_about = LONG_ABOUT, after_long_help = format!("{CODES}\n\n{EXAMPLES}"))]
pub(crate) struct Options {
    /// Job file of `globillum plan`
    #[arg(value_name = "JOB.json")]
    job: PathBuf,
    /// Print only the tasks to submit again: for each array its offset and its indices; exit code 0
    #[arg(long)]
    arrays: bool,
    /// Largest size of an array of tasks that the scheduler takes (MaxArraySize of Slurm)
    #[arg(long, value_name = "N", default_value_t = 1001, value_parser = parse::integer(1..=u32::MAX))]
    #[arg(allow_negative_numbers = true)]
    max_array_size: u32,
}

pub(crate) fn run(options: &Options) -> Result<()> {
    let job = options.job.as_path();
    let plan = Plan::read(job)?;
    let parts = Parts::of(job, &plan)?;
    let tasks: Vec<Task> = plan.tasks().collect();
    let missing: Vec<&Task> = tasks.iter().filter(|task| parts.complete(task).next().is_none()).collect();
    let indices: Vec<u32> = missing.iter().map(|task| task.index).collect();
    let arrays = arrays(&indices, options.max_array_size);
    if options.arrays {
        let lines = arrays.iter().map(|(offset, indices)| format!("{offset} {indices}\n"));
        return console::print(lines.collect::<String>().as_bytes());
    }
    let mut table = progress(&plan, &parts, &tasks, missing.len());
    missing.iter().for_each(|task| table += &format!("missing       {task}\n"));
    table += &files(job, &plan, &parts);
    table += &duplicates(&parts, &tasks);
    for (offset, indices) in arrays {
        table += &format!("submit        {indices}, offset {offset}\n");
    }
    console::print(table.as_bytes())?;
    if missing.is_empty() {
        return Ok(());
    }
    Err(exit::Incomplete(format!("{} of {} tasks are to be submitted again", missing.len(), tasks.len()))
        .into())
}

fn progress(plan: &Plan, parts: &Parts, tasks: &[Task], missing: usize) -> String {
    let work = |task: &Task| task.passes.len() as f64 * task.rows.len() as f64;
    let all: f64 = tasks.iter().map(work).sum();
    let done: f64 = tasks.iter().map(|task| work(task) * parts.share_of(task)).sum();
    let complete = tasks.len() - missing;
    let mut text = format!(
        "tasks         {complete} of {} complete, {:.1} % of the work\n",
        tasks.len(),
        100.0 * done / all
    );
    let error = error(plan, parts);
    if error.is_finite() {
        text += &format!("error         {:.3} % of the mean, as far as it is rendered\n", 100.0 * error);
    }
    text
}

/// The relative error of all parts together, each of which knows its own: the variance of a mean of independent
/// parts, weighted by their samples. Infinite if one does not know.
fn error(plan: &Plan, parts: &Parts) -> f64 {
    let mut strips: BTreeMap<u32, Vec<(f64, PixelSums)>> = BTreeMap::new();
    for task in plan.tasks() {
        let own = |(_, part): &(PathBuf, Part)| match part {
            Part::Good(header, sums) => match header.strips.as_slice() {
                // A merge of several tasks would count for each of them.
                [strip] if part.is_of(&task) => Some((strip.samples() as f64, *sums)),
                _ => None,
            },
            _ => None,
        };
        strips.entry(task.rows.start).or_default().extend(parts.0.iter().find_map(own));
    }
    let mut all = PixelSums::default();
    for parts in strips.values() {
        let samples: f64 = parts.iter().map(|(samples, _)| samples).sum();
        for (own, sums) in parts {
            let weight = own / samples;
            all.mean += sums.mean * weight;
            all.variance += sums.variance * (weight * weight);
        }
        all.pixels += parts.first().map_or(0, |(_, sums)| sums.pixels);
    }
    all.relative_rmse()
}

/// Files that cannot be used.
fn files(job: &Path, plan: &Plan, parts: &Parts) -> String {
    let line = |(path, part): &(PathBuf, Part)| {
        let (what, error) = match part {
            Part::Good(..) => return String::new(),
            Part::Damaged(error) => ("damaged", error),
            Part::Foreign(error) => ("foreign", error),
        };
        let task = Parts::task_of(job, plan, path).map_or(String::new(), |task| format!(" ({task})"));
        format!("{what:<13} {}: {error}{task}\n", path.display())
    };
    parts.0.iter().map(line).collect()
}

/// Tasks that several files hold.
fn duplicates(parts: &Parts, tasks: &[Task]) -> String {
    let line = |task: &Task| {
        let paths: Vec<String> = parts.complete(task).map(|path| path.display().to_string()).collect();
        if paths.len() > 1 { format!("duplicate     {task}: {}\n", paths.join(", ")) } else { String::new() }
    };
    tasks.iter().map(line).collect()
}
