use crate::exit::{CODES, SIGNALS};
use crate::failures::Failures;
use crate::file_conflicts::{SCENE_FILE, Uses};
use crate::flags::{LoadedScene, MeasureFlags, SceneFlags};
use crate::interrupt::Interrupt;
use crate::json::to_json;
use crate::monitor::RenderMonitor;
use crate::output::TextOutput;
use crate::subject::build;
use crate::summary::{PointsSummary, Timing, reason};
use crate::{console, points, threads};
use anyhow::{Result, ensure};
use globillum::io::PictureFormat;
use std::path::{Path, PathBuf};

const LONG_ABOUT: &str = "\
Measures irradiance at points of a scene, and writes it with its standard error, one line a point.

A point is a position and the unit normal of the plane on which irradiance is measured: columns x,y,z,nx,ny,nz. \
Irradiance is radiance times cosine, integrated over the side of the normal, for each of red, green and blue: in W/m^2 \
if the scene's lights are in watts. Points may lie on surfaces; they are not shadowed by the one they lie on. \
docs/measuring.md has the definitions, and worked examples.";

const EXAMPLES: &str = "\
Examples:
  To 1 % error, all points together, to irradiance.csv:
      globillum irradiance SCENE.glb --points desks.csv --error 0.01
  With 4096 samples for each point, in a pipe:
      globillum irradiance SCENE.glb --points - --out - --samples 4096
  Daylight without sun, of a white sky of radiance 1:
      globillum irradiance ROOM.glb --environment 1 --points desks.csv --error 0.005";

/// Measures irradiance at points of a scene
#[derive(clap::Args, Debug)]
#[command(long_about = format!("{LONG_ABOUT}\n\n{SIGNALS}"), after_long_help = format!("{CODES}\n\n{EXAMPLES}"))]
pub(crate) struct Options {
    #[command(flatten)]
    scene: SceneFlags,
    /// Points: comma-separated x,y,z,nx,ny,nz, one line each; `-` is standard input
    ///
    /// Positions are in the scene's units, glTF in metres with y up. Normals are unit vectors, rounded to three
    /// decimals or better. A heading with the names of the columns, empty lines and lines that begin with # are left
    /// out.
    #[arg(long, value_name = "FILE.csv", help_heading = "Points")]
    points: PathBuf,
    /// Write the readings to FILE; `-` is standard output
    ///
    /// The columns of the points are followed by irradiance r,g,b and its standard error r_error,g_error,b_error. The
    /// file appears when it is complete.
    #[arg(long, value_name = "FILE.csv", help_heading = "Output", default_value = "irradiance.csv")]
    out: PathBuf,
    #[command(flatten)]
    flags: MeasureFlags,
}

/// Refuses the name of a picture for a table.
fn check_name(out: &Path) -> Result<()> {
    ensure!(
        PictureFormat::of(out).is_err(),
        "--out {}: is written as CSV, which is no picture; use .csv",
        out.display()
    );
    Ok(())
}

pub(crate) fn run(options: &Options) -> Result<()> {
    check_name(&options.out)?;
    let flags = options.flags.resolved()?;
    let interrupt = Interrupt::catch()?;
    threads::start(flags.speed.threads)?;
    let stats = flags.report.stats.as_deref();
    let check_files = |uses: Uses<'_>| {
        uses.written("--out", [&options.out])
            .written("--stats", stats)
            .written("--checkpoint", flags.checkpoints.save.path())
            .check()
    };
    check_files(
        Uses::default().read("the scene", [&options.scene.scene]).read("--points", [&options.points]),
    )?;
    let points = points::read(&options.points)?;
    let out = TextOutput::open(&options.out)?;
    let stats_output = stats.map(TextOutput::open).transpose()?;
    let held = flags.checkpoints.save.read()?;
    let checkpoint = flags.checkpoints.save.open()?;

    let mut loaded = options.scene.load(flags.report.warnings(), &interrupt)?;
    loaded.light_if_dark()?;
    let LoadedScene { name, model, files, .. } = loaded;
    check_files(Uses::default().read(SCENE_FILE, &files))?;
    let (scene, build_seconds) = build(model, flags.speed.accel)?;
    interrupt.check()?;

    let settings = flags.settings(&points);
    let render = flags.render(&scene, &points, &settings, held);
    let monitor = RenderMonitor::new(checkpoint, &interrupt);
    let mut failures = Failures::default();
    let (picture, render_seconds, traced) = monitor
        .run(|monitor| render.monitor(monitor).run(), &mut failures)
        .map_err(|error| flags.checkpoints.save.explain(error))?;
    let ended_by = reason(picture.ending, &flags.stop(), &interrupt);
    let timing = Timing { build_seconds, render_seconds, traced, ended_by };
    let summary = PointsSummary::new(&name, &flags, &scene, &picture, timing);
    let data_on_stdout = out.is_stdout() || stats_output.as_ref().is_some_and(TextOutput::is_stdout);
    let name = (!out.is_stdout()).then(|| format!("readings      {}\n", options.out.display()));
    let written = failures.keep(out.write(&points::format(points.readings(&picture.film)))).and(name);
    failures.keep(stats_output.map_or(Ok(()), |stats| stats.write(&to_json(&summary)?)));
    let table = format!("{summary}{}", written.unwrap_or_default());
    failures.keep(interrupt.ignore_after_hangup(console::print_table(&table, data_on_stdout)));
    failures.into_result()?;
    interrupt.check_ending(
        picture.ending,
        format!("complete passes are kept, {} samples per point", picture.samples),
    )
}
