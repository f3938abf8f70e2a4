use crate::exit::{CODES, SIGNALS};
use crate::failures::Failures;
use crate::file_conflicts::{SCENE_FILE, Uses};
use crate::flags::{SaveFlags, SpeedFlags};
use crate::interrupt::Interrupt;
use crate::load::{self, Warnings};
use crate::monitor::RenderMonitor;
use crate::patches::{NamedPatches, PatchKind};
use crate::{console, parse, threads};
use anyhow::{Result, anyhow, bail};
use globillum::geom::Triangles;
use globillum::integrator::view_factors::{
    FactorError, FactorFormat, FactorRun, FactorSettings, FactorTable, Reciprocity, Target, ViewFactors,
};
use globillum::integrator::{Ending, Monitor};
use globillum::io::{AtomicFile, Loader};
use globillum::material::Sides;
use std::path::{Path, PathBuf};

const LONG_ABOUT: &str = "\
Computes view factors: the fraction of the diffuse radiation that leaves one patch and arrives directly at \
another, or at the surroundings. Also called form factors or configuration factors.

Each patch sends the same number of rays, from points that are uniform on it, in directions distributed by the \
cosine. A factor is the share of them that hits its target, so a row of factors adds up to 1 exactly. The file says \
the standard error of each.

Triangles radiate from their front, from where their vertices run counter-clockwise, and block rays on both sides. \
Hits of a back are listed as `back`, rays that hit nothing as `surroundings`; an object of such a name is written as \
`object back` or `object surroundings`, with a warning.";

const EXAMPLES: &str = "\
Examples:
  Factors between the objects of a street, from 65,536 rays each, to street.csv:
      globillum view-factors STREET.glb --patches object --out street.csv
  Between all triangles, to 1 % error of the factors of at least 0.001, continued if interrupted:
      globillum view-factors STREET.obj --patches triangle --error 0.01 --checkpoint street.part --resume \\
          --out street.mtx
  With A_i F_ij = A_j F_ji, for solvers that need a symmetric matrix:
      globillum view-factors STREET.obj --patches triangle --reciprocity --out street.mtx";

/// Computes view factors between patches, and to the surroundings
#[derive(clap::Args, Debug)]
#[command(long_about = format!("{LONG_ABOUT}\n\n{SIGNALS}"), after_long_help = format!("{CODES}\n\n{EXAMPLES}"))]
pub(crate) struct Options {
    /// Scene file: Wavefront OBJ, or glTF 2.0
    #[arg(value_name = "SCENE.{obj,gltf,glb}", help_heading = "Scene")]
    scene: PathBuf,
    /// What is a patch
    #[arg(long, value_enum, help_heading = "Scene")]
    patches: PatchKind,
    /// Let triangles radiate from both sides
    #[arg(long, help_heading = "Scene")]
    two_sided: bool,
    /// Rays of each patch, rounded up to whole passes [default: 65536, or 2^32 with --error]
    #[arg(long, value_name = "N", value_parser = parse::integer(1..=1_u64 << 36), help_heading = "When to stop")]
    #[arg(allow_negative_numbers = true)]
    rays: Option<u64>,
    /// Stop when the relative standard error of the factors is at most E, such as 0.01 for 1 %
    ///
    /// The error is the root mean squared standard error of the factors of at least --at-least, over their mean. If
    /// --rays ends the run before, it is done all the same, with exit code 0: what ended it is in the table.
    #[arg(long, value_name = "E", value_parser = parse::positive, help_heading = "When to stop")]
    #[arg(allow_negative_numbers = true)]
    error: Option<f64>,
    /// Judge the error by the factors of at least F, from 0 to 1
    ///
    /// With --error, a run that finds that no factor is as large ends with an error, and writes no file.
    #[arg(long, value_name = "F", value_parser = parse::share, help_heading = "When to stop")]
    #[arg(default_value_t = 0.001, allow_negative_numbers = true)]
    at_least: f64,
    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = parse::integer(0..=u64::MAX))]
    #[arg(help_heading = "When to stop", allow_negative_numbers = true)]
    seed: u64,
    #[command(flatten)]
    save: SaveFlags,
    /// Write the factors to FILE: CSV with standard errors, or a MatrixMarket file
    #[arg(long, value_name = "FILE.{csv,mtx}", help_heading = "Output")]
    out: PathBuf,
    /// Combine both directions of each pair of patches, so that A_i F_ij = A_j F_ji
    ///
    /// The variance of factors between equal areas is halved. Rows then add up to 1 only up to the error of their
    /// factors; the largest distance is printed.
    #[arg(long, help_heading = "Output")]
    reciprocity: bool,
    /// Do not write the factors below F, from 0 to 1; rows then add up to less than 1
    #[arg(long, value_name = "F", default_value_t = 0.0, value_parser = parse::share)]
    #[arg(help_heading = "Output", allow_negative_numbers = true)]
    omit_below: f64,
    /// List every warning about the scene file, not the first of each kind
    #[arg(long, help_heading = "Output")]
    verbose: bool,
    #[command(flatten)]
    speed: SpeedFlags,
}

pub(crate) fn run(options: &Options) -> Result<()> {
    let format = format_of(&options.out)?;
    let interrupt = Interrupt::catch()?;
    threads::start(options.speed.threads)?;
    let check_files = |uses: Uses<'_>| {
        uses.written("--out", [&options.out]).written("--checkpoint", options.save.path()).check()
    };
    check_files(Uses::default().read("the scene", [&options.scene]))?;
    let file = AtomicFile::create(&options.out)?;
    let before = options.save.read()?;
    let checkpoint = options.save.open()?;

    let loader =
        if options.patches == PatchKind::Object { Loader::new().keep_objects() } else { Loader::new() };
    let warnings = if options.verbose { Warnings::All } else { Warnings::FirstOfEachKind };
    let loaded = load::load(&options.scene, loader, warnings, &interrupt)?;
    check_files(Uses::default().read(SCENE_FILE, &loaded.files))?;
    let patches = NamedPatches::of(&loaded, options.patches);
    let triangles = Triangles::new(loaded.model.triangles().to_vec())?;
    let accel = options.speed.accel.build(&triangles)?;
    interrupt.check()?;

    let settings = options.settings();
    let run = FactorRun::new(&triangles, &accel, &patches.patches, &settings);
    let run = before.into_iter().fold(run, FactorRun::resume);
    let monitor = RenderMonitor::new(checkpoint, &interrupt);
    let mut failures = Failures::default();
    let compute = |monitor: &dyn Monitor<_>| {
        run.monitor(monitor).run().map_err(|error| options.explain(error, &patches))
    };
    let (factors, seconds, traced) = monitor.run(compute, &mut failures)?;

    let reciprocity = Reciprocity::of(&factors);
    let table = FactorTable::new(&factors, |patch| patches.name(patch)).at_least(options.omit_below);
    let table = if options.reciprocity { table.combined(&reciprocity) } else { table };
    let written = failures.keep(file.commit(|writer| table.write(format, writer)));
    let rate = traced.rays as f64 / seconds / 1e6;
    let name = written.map(|()| format!("factors       {}\n", options.out.display())).unwrap_or_default();
    let summary = options.summary(&factors, &reciprocity, seconds, rate, &interrupt) + &name;
    failures.keep(interrupt.ignore_after_hangup(console::print(summary.as_bytes())));
    failures.into_result()?;
    let kept = format!("complete passes are kept, {} rays of each patch", factors.rays());
    interrupt.check_ending(factors.ending(), kept)
}

fn format_of(out: &Path) -> Result<FactorFormat> {
    let extension = out.extension().map(|extension| extension.to_ascii_lowercase());
    match extension.as_deref().and_then(|extension| extension.to_str()) {
        Some("csv") => Ok(FactorFormat::Csv),
        Some("mtx") => Ok(FactorFormat::MatrixMarket),
        _ => bail!("--out {}: must end in .csv or .mtx", out.display()),
    }
}

impl Options {
    fn settings(&self) -> FactorSettings {
        // Up to this number, passes are as long as those of the default.
        let rays = self.rays.unwrap_or(if self.error.is_some() { 1 << 32 } else { 1 << 16 });
        let mut settings = FactorSettings::new(rays);
        (settings.error, settings.least_factor) = (self.error, self.at_least);
        settings.sides = if self.two_sided { Sides::Both } else { Sides::Front };
        (settings.seed, settings.threads) = (self.seed, self.speed.threads);
        settings
    }

    /// The error with the name of a patch or of the checkpoint.
    fn explain(&self, error: FactorError, patches: &NamedPatches) -> anyhow::Error {
        match error {
            FactorError::EmptyPatch { patch } => {
                let name = patches.name(patch);
                anyhow!("{}: patch `{name}` has no triangle with an area", self.scene.display())
            }
            FactorError::NoneAsLarge { least, most } => anyhow!(
                "--at-least {least:?}: no factor is as large; they are {most:.4} at most, so --error has nothing to judge"
            ),
            FactorError::OtherRun => anyhow::Error::from(error).context(self.save.name()),
            error => error.into(),
        }
    }

    fn summary(
        &self,
        factors: &ViewFactors,
        reciprocity: &Reciprocity<'_>,
        seconds: f64,
        rate: f64,
        interrupt: &Interrupt,
    ) -> String {
        let patches = factors.patches();
        let accuracy = factors.accuracy(self.at_least);
        let (rays, passes) = (factors.rays(), factors.passes());
        let million = rays as f64 * f64::from(patches) / 1e6;
        let sky = |patch| factors.factor(patch, Target::Surroundings).value;
        let sky = (0..patches).map(sky).sum::<f64>() / f64::from(patches);
        let sums = match self.reciprocity {
            false => "1 exactly".to_owned(),
            true => format!("1 within {:.2e}", reciprocity.largest_row_error()),
        };
        let ended_by = match factors.ending() {
            Ending::Goals => "the error asked for",
            Ending::Cancelled => interrupt.canceller(),
            _ if self.error.is_some() => "rays; the error asked for was not reached",
            _ => "rays",
        };
        format!(
            "patches       {patches}\n\
             rays          {rays} of each patch in {passes} passes, {million:.2} million in all\n\
             trace         {seconds:.2} s: {rate:.2} million rays a second\n\
             surroundings  factor {sky:.6} in the mean\n\
             relative RMSE {:.3} % of the {} factors of at least {:?}\n\
             largest error {:.2e}, a standard error of these\n\
             row sums      {sums}\n\
             reciprocity   at most {:.2} standard errors of independent rays apart\n\
             ended by      {ended_by}\n",
            100.0 * accuracy.relative_rmse,
            accuracy.count,
            self.at_least,
            accuracy.largest_std_err,
            reciprocity.largest_z(),
        )
    }
}
