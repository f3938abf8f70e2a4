//! Reference pictures of an independent renderer: means over blocks of pixels with standard errors.

use globillum_integrator::Film;
use globillum_material::Rgb;
use serde::Deserialize;

/// The reference of one scene.
#[derive(Debug, Deserialize)]
pub struct Reference {
    /// Pixels along each side.
    pub resolution: u32,
    /// Pixels along each side of a block.
    pub block: u32,
    /// Independent samples per pixel.
    #[serde(rename = "spp")]
    pub samples: u32,
    /// Light of any number of bounces.
    pub path: Blocks,
    /// Emitted light and light after one bounce.
    pub direct: Blocks,
}

/// Mean radiance of each block, row 0 at the top.
#[derive(Debug, Deserialize)]
pub struct Blocks {
    /// Mean of the whole picture.
    pub image_mean: [f64; 3],
    /// Mean of each block.
    pub blocks: Vec<Vec<[f64; 3]>>,
    /// Standard error of each block's mean.
    pub standard_error: Vec<Vec<[f64; 3]>>,
}

/// Pixels along each side of the squares whose variances a film knows.
const SQUARE: u32 = 4;

/// Largest accepted relative error of the image mean.
pub const MEAN_LIMIT: f64 = 0.003;

/// The deviation of a film from a reference.
#[derive(Clone, Copy, Debug, Default)]
pub struct Deviation {
    /// Largest distance of a block in standard errors of the difference. That of the film is not below the reference's.
    pub largest_z: f64,
    /// Largest distance of a block, with the film's own estimate of its error only.
    pub largest_z_by_film: f64,
    /// Largest relative difference of the image mean.
    pub image_mean: f64,
}

impl Reference {
    /// Reads the reference's JSON.
    ///
    /// # Panics
    /// If it is malformed.
    pub fn parse(json: &str) -> Self {
        serde_json::from_str(json).expect("a reference is well-formed")
    }

    /// Compares `film`, of the reference's resolution, with `blocks`.
    ///
    /// For [`Deviation::largest_z`], the standard error of a block is that of the film, but not less than the
    /// reference's error scaled to the film's number of samples. A film whose samples all miss a rare light
    /// underestimates its own error.
    pub fn deviation(&self, film: &Film, blocks: &Blocks) -> Deviation {
        let mut deviation = Deviation::default();
        let side = (self.resolution / self.block) as usize;
        assert!(blocks.blocks.len() == side && blocks.blocks.iter().all(|row| row.len() == side));
        assert_eq!((film.width(), film.height()), (self.resolution, self.resolution));
        let squares: Vec<Rgb> = film.block_variances_of_mean().collect();
        for (row, columns) in blocks.blocks.iter().enumerate() {
            for (column, expected) in columns.iter().enumerate() {
                let (mean, variance) = self.block_of(film, &squares, column as u32, row as u32);
                for c in 0..3 {
                    let reference_err = blocks.standard_error[row][column][c];
                    let independent =
                        reference_err * reference_err * f64::from(self.samples) / film.samples() as f64;
                    let error = (mean[c] - expected[c]).abs();
                    let z = |variance: f64| {
                        // Both errors can be 0, for a black block.
                        let z = if error == 0.0 { 0.0 } else { error / reference_err.hypot(variance.sqrt()) };
                        assert!(!z.is_nan(), "block ({column}, {row}) is not a number");
                        z
                    };
                    deviation.largest_z = deviation.largest_z.max(z(variance[c].max(independent)));
                    deviation.largest_z_by_film = deviation.largest_z_by_film.max(z(variance[c]));
                }
            }
        }
        for (mean, expected) in film.image_mean().to_array().iter().zip(blocks.image_mean) {
            deviation.image_mean = deviation.image_mean.max((mean / expected - 1.0).abs());
        }
        deviation
    }

    /// The mean of a block and the variance of that mean, by the film's squares of 4 x 4 pixels, of which `squares` are the
    /// variances.
    fn block_of(&self, film: &Film, squares: &[Rgb], column: u32, row: u32) -> ([f64; 3], [f64; 3]) {
        assert_eq!(self.block % SQUARE, 0, "a block has whole squares");
        let side = 0..self.block;
        let (mut mean, mut variance) = ([0.0; 3], [0.0; 3]);
        let pixels = f64::from(self.block * self.block);
        let of_square = f64::from(SQUARE * SQUARE);
        for (x, y) in side.clone().flat_map(|y| side.clone().map(move |x| (x, y))) {
            let (x, y) = (column * self.block + x, row * self.block + y);
            let square =
                squares[(y / SQUARE * film.width().div_ceil(SQUARE) + x / SQUARE) as usize].to_array();
            let m = film.mean(x, y).to_array();
            for c in 0..3 {
                mean[c] += m[c] / pixels;
                // Each pixel takes its share of the square.
                variance[c] += square[c] * of_square / (pixels * pixels);
            }
        }
        (mean, variance)
    }
}
