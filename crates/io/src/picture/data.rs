use super::setting_names;
use globillum_integrator::{
    CheckpointHeader, Estimates, Film, FirstHits, PathReuse, Picture, PinholeCamera, Settings,
};
use std::collections::BTreeMap;
use std::ops::Range;

/// A picture with its error and where it comes from: what an OpenEXR file holds.
///
/// The channels of the file, and what they are:
///
/// | channels | type | content |
/// |---|---|---|
/// | `R`, `G`, `B` | float | mean radiance, linear, Rec. 709 primaries |
/// | `stderr.R`, `stderr.G`, `stderr.B` | float | its standard error; infinite if unknown |
/// | `blockerr.R`, `blockerr.G`, `blockerr.B` | float | the standard error of the mean of each pixel's block of 4 x 4; infinite if unknown |
/// | `samples.X` | integer | samples |
/// | `observations.X` | integer | independent observations on which the standard error rests |
/// | `Depth.Z` | float | distance along the view direction ([`FirstHits`]) |
/// | `Normal.X`, `Normal.Y`, `Normal.Z` | float | normal in the world frame |
/// | `Albedo.R`, `Albedo.G`, `Albedo.B` | float | albedo |
/// | `IndexTriangle.X`, `IndexMA.X` | integer | triangle and material, 2^32 - 1 for none |
///
/// A crop is the data window of a file whose display window is the whole picture.
///
/// A picture with neither known errors nor numbers of samples does not have `stderr`, `blockerr`, `samples` and
/// `observations`, one without first hits not what follows them. [Attributes](PictureData::attributes) are text, each
/// named `globillum.` and its name; the attribute `software` names this library and its version.
///
/// ```no_run
/// use globillum_io::{IoError, PictureData};
///
/// /// The widest 95 % confidence interval of a pixel.
/// fn widest(path: &std::path::Path) -> Result<f64, IoError> {
///     let margins = PictureData::read(path)?.estimates.margins_95();
///     Ok(margins.iter().map(|margin| margin.max_component()).fold(0.0, f64::max))
/// }
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PictureData {
    /// Means, standard errors and samples of the pixels.
    pub estimates: Estimates,
    /// What else is known, by name: `passes`, `samples`, `path_reuse`, `key`, `seed`, `settings`.
    pub attributes: BTreeMap<String, String>,
    /// The matrix that row vectors of world positions are multiplied by to get the camera's frame, x to the right,
    /// y upward, z forward (`worldToCamera`), and the vertical field of view in degrees, of the whole picture.
    pub camera: Option<([f32; 16], f32)>,
    /// The first hits, of the same size.
    pub first_hits: Option<FirstHits>,
}

impl PictureData {
    /// A picture of these estimates, of which nothing else is known.
    pub fn new(estimates: Estimates) -> Self {
        Self { estimates, attributes: BTreeMap::new(), camera: None, first_hits: None }
    }

    /// The estimates of `film`, with the attributes `passes`, `samples` and `path_reuse`.
    pub fn of(film: &Film) -> Self {
        let mut data = Self::new(Estimates::of(film));
        data.set_path_reuse(film.path_reuse());
        data.set_passes(&film.passes(), film.samples());
        data
    }

    /// [`PictureData::of`] the picture's film, with the attributes `key`, `seed` and `settings`, and the camera if a
    /// pinhole took the picture.
    ///
    /// Settings that do not change a sample, such as the number of threads, are left out.
    pub fn of_render(picture: &Picture, settings: &Settings, camera: Option<&PinholeCamera>) -> Self {
        let mut data = Self::of(&picture.film);
        data.set_key(picture.key);
        data.set_settings(settings);
        data.camera = camera.map(Self::frame);
        data
    }

    /// Sets the attributes `seed` and `settings`. Settings that do not change a sample, such as the number of threads,
    /// are left out.
    pub fn set_settings(&mut self, settings: &Settings) {
        self.set("seed", settings.seed);
        self.set("settings", settings_text(settings));
    }

    /// The estimates of a merged checkpoint with this header, with the attributes `key` and `path_reuse`, and, if all
    /// pixels hold the same passes, `passes` and `samples`. A checkpoint does not hold seed, settings and camera.
    pub fn of_merged(header: &CheckpointHeader, estimates: Estimates) -> Self {
        let mut data = Self::new(estimates);
        data.set_path_reuse(header.path_reuse);
        data.set_key(header.key);
        if let [strip] = header.strips.as_slice()
            && strip.rows() == (0..header.height)
        {
            data.set_passes(&strip.passes(), strip.samples());
        }
        data
    }

    fn set_path_reuse(&mut self, path_reuse: PathReuse) {
        self.set("path_reuse", setting_names::path_reuse(path_reuse));
    }

    /// The key in hexadecimal.
    fn set_key(&mut self, key: u64) {
        self.set("key", format_args!("{key:016x}"));
    }

    /// Passes such as `0..8, 12..16`.
    fn set_passes(&mut self, passes: &[Range<u32>], samples: u64) {
        let ranges: Vec<String> =
            passes.iter().map(|range| format!("{}..{}", range.start, range.end)).collect();
        self.set("passes", ranges.join(", "));
        self.set("samples", samples);
    }

    /// [`PictureData::camera`] of a pinhole.
    pub fn frame(camera: &PinholeCamera) -> ([f32; 16], f32) {
        let [middle, right, up] = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|(x, y)| camera.ray(x, y, 1.0));
        let (eye, forward) = (middle.origin, middle.direction);
        let [right, up] = [right, up].map(|ray| ray.direction - forward);
        let fov = 2.0 * (up.length() / forward.length()).atan();
        let axes = [right, up, forward].map(|axis| axis.normalize());
        let mut matrix = [0.0; 16];
        for (column, axis) in axes.into_iter().enumerate() {
            for (row, x) in axis.to_array().into_iter().chain([-eye.dot(axis)]).enumerate() {
                matrix[4 * row + column] = x as f32;
            }
        }
        matrix[15] = 1.0;
        (matrix, fov.to_degrees() as f32)
    }

    /// Sets the attribute `name`.
    pub fn set(&mut self, name: &str, value: impl ToString) {
        self.attributes.insert(name.into(), value.to_string());
    }
}

/// The settings that change a sample, apart from size and seed.
fn settings_text(settings: &Settings) -> String {
    let Settings { pass_samples, max_bounces, roulette, .. } = settings;
    let kinds = [
        ("sampler", setting_names::sampler(settings.sampler).to_owned()),
        ("filter", setting_names::filter(settings.filter).to_owned()),
        ("estimator", setting_names::estimator(settings.estimator).to_owned()),
        ("light_sampling", setting_names::light_sampling(settings.light_sampling).to_owned()),
        ("light_samples", settings.light_samples.to_string()),
        ("mirror_sampling", setting_names::mirror_sampling(settings.mirror_sampling).to_owned()),
        ("supersampling", setting_names::supersampling(settings.supersampling).to_owned()),
        ("path_reuse", setting_names::path_reuse(settings.path_reuse).to_owned()),
        ("guiding", setting_names::guiding(settings.guiding).to_owned()),
        ("max_bounces", max_bounces.map_or_else(|| "none".to_owned(), |max| max.to_string())),
        ("pass_samples", pass_samples.to_string()),
        ("roulette_start", roulette.start.to_string()),
        ("roulette_threshold", roulette.threshold.to_string()),
    ];
    kinds.map(|(name, value)| format!("{name}={value}")).join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn the_camera_is_a_matrix_for_row_vectors() {
        let eye = DVec3::new(1.0, 2.0, 5.0);
        let camera =
            PinholeCamera::look_at(eye, DVec3::new(1.0, 2.0, 0.0), DVec3::Y, 1.0).expect("it is one");
        let (matrix, fov) = PictureData::frame(&camera);
        // One to the right, two up, and three in front of the camera.
        let point = [2.0, 4.0, 2.0, 1.0];
        let seen = |column: usize| (0..4).map(|row| point[row] * matrix[4 * row + column]).sum::<f32>();
        assert_eq!([0, 1, 2, 3].map(seen), [1.0, 2.0, 3.0, 1.0]);
        assert!((fov - 1.0_f32.to_degrees()).abs() < 1e-5);
    }
}
