use crate::brightness;
use crate::checkpoint::Checkpoint;
use crate::console;
use crate::exr_range;
use crate::failures::Failures;
use crate::file_conflicts::{SCENE_FILE, Uses};
use crate::flags::{RenderFlags, Shown};
use crate::interrupt::Interrupt;
use crate::json::to_json;
use crate::monitor::RenderMonitor;
use crate::output::Outputs;
use crate::preview::Preview;
use crate::subject::{BuiltSubject, Subject};
use crate::summary::{self, PictureSummary, Timing};
use crate::threads;
use crate::view::AnyCamera;
use anyhow::Result;
use globillum::integrator::{FirstHits, Picture, Settings};
use globillum::io::PictureData;
use globillum::material::Rgb;

/// A picture to be rendered: its flags are checked, its files open.
pub(crate) struct Job {
    flags: RenderFlags,
    outputs: Outputs,
    /// What the checkpoint holds, to be continued.
    held: Option<Picture>,
    checkpoint: Option<Checkpoint>,
    pub(crate) interrupt: Interrupt,
}

impl Job {
    /// Checks flags and opens files, of which none may be among the `inputs`: what cannot work is known before any
    /// work. From here on signals are caught, so that no temporary file is left.
    pub(crate) fn prepare(flags: &RenderFlags, default_out: &str, inputs: Uses<'_>) -> Result<Self> {
        let flags = flags.resolved(default_out)?;
        flags.add_to(inputs).check()?;
        let interrupt = Interrupt::catch()?;
        threads::start(flags.speed.threads)?;
        let outputs = Outputs::open(&flags.output, flags.report.stats.as_deref())?;
        let held = flags.checkpoints.save.read()?;
        let checkpoint = flags.checkpoints.save.open()?;
        Ok(Self { flags, outputs, held, checkpoint, interrupt })
    }

    /// Renders, writes what was asked for and can be written, and prints the figures.
    pub(crate) fn run(self, subject: Subject) -> Result<()> {
        let Self { flags, outputs, held, checkpoint, interrupt } = self;
        flags.add_to(Uses::default().read(SCENE_FILE, &subject.files)).check()?;
        exr_range::check(&flags.output.out, subject.model.environment())?;
        let subject = subject.build(&flags, &interrupt)?;
        let BuiltSubject { scene, camera, build_seconds, .. } = &subject;
        let settings = flags.settings();
        let render = flags.render(scene, camera.sensor(), &settings, held);
        let shown = flags.picture.shown();
        let preview = flags
            .picture
            .preview
            .then(|| Preview::new(&flags.output, |picture| picture_data(picture, &settings, camera, shown)));
        let monitor = RenderMonitor::new(checkpoint, &interrupt).with_preview(preview);
        let mut failures = Failures::default();
        let (picture, render_seconds, traced) = monitor
            .run(|monitor| render.monitor(monitor).run(), &mut failures)
            .map_err(|error| flags.checkpoints.save.explain(error))?;
        let ended_by = summary::reason(picture.ending, &flags.stop(), &interrupt);
        let timing = Timing { build_seconds: *build_seconds, render_seconds, traced, ended_by };
        let summary = PictureSummary::new(&subject, &flags, &settings, &picture, timing);
        let data_on_stdout = outputs.use_stdout();
        let mut data = picture_data(&picture, &settings, camera, shown);
        if flags.picture.buffers {
            let hits = failures.keep(FirstHits::of(scene, camera.sensor(), &settings));
            data.first_hits = hits.map(|hits| shown.cut_hits(hits));
        }
        let shines = !scene.lights().is_empty() || !scene.environment().is_black();
        let hint = brightness::hint(mean(&data.estimates.means), flags.output.exposure);
        if let Some(hint) = hint.filter(|_| shines && picture.samples > 0 && outputs.show_exposed()) {
            console::warn(format_args!("{hint}"));
        }
        let written = outputs.write(&data, || to_json(&summary), &mut failures);
        let table = console::print_table(&summary.to_table(&written), data_on_stdout);
        failures.keep(interrupt.ignore_after_hangup(table));
        failures.into_result()?;
        let kept = format!("complete passes are kept, {} samples per pixel", picture.samples);
        interrupt.check_ending(picture.ending, kept)
    }
}

fn mean(pixels: &[Rgb]) -> Rgb {
    pixels.iter().copied().sum::<Rgb>() / pixels.len() as f64
}

/// What is written of a picture.
fn picture_data(picture: &Picture, settings: &Settings, camera: &AnyCamera, shown: Shown) -> PictureData {
    let mut data = PictureData::of_render(picture, settings, camera.pinhole());
    shown.cut(&mut data.estimates);
    data
}
