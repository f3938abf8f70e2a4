use crate::tile::Tile;
use globillum_material::Rgb;

/// Sums of radiance samples, one pixel each, row 0 at the top.
///
/// Sums are `f64` and are added pass by pass in a fixed order, so equal samples give equal bits.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    width: u32,
    height: u32,
    pixels: Vec<PixelSum>,
}

/// Sum and sum of squares of a number of samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct PixelSum {
    count: u64,
    sum: Rgb,
    sum_sq: Rgb,
}

impl PixelSum {
    pub(crate) fn add(&mut self, sample: Rgb) {
        self.count += 1;
        self.sum += sample;
        self.sum_sq += sample * sample;
    }

    fn merge(&mut self, other: &Self) {
        self.count += other.count;
        self.sum += other.sum;
        self.sum_sq += other.sum_sq;
    }

    fn mean(&self) -> Rgb {
        if self.count == 0 { Rgb::BLACK } else { self.sum / self.count as f64 }
    }

    fn variance_of_mean(&self) -> Rgb {
        if self.count < 2 {
            return Rgb::splat(f64::INFINITY);
        }
        let (n, mean) = (self.count as f64, self.mean());
        let spread = self.sum_sq / n + mean * mean * -1.0;
        spread.map(|x| x.max(0.0) / (n - 1.0))
    }
}

impl Film {
    pub(crate) fn new(width: u32, height: u32) -> Self {
        let pixels = vec![PixelSum::default(); width as usize * height as usize];
        Self { width, height, pixels }
    }

    /// Width in pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Mean radiance of a pixel; black before the first sample.
    ///
    /// # Panics
    /// If the pixel lies outside the film.
    pub fn mean(&self, x: u32, y: u32) -> Rgb {
        self.pixel(x, y).mean()
    }

    /// Variance of [`Film::mean`], estimated from the samples' spread, component by component;
    /// infinite for fewer than two samples. Its square root is the standard error.
    ///
    /// # Panics
    /// If the pixel lies outside the film.
    pub fn variance_of_mean(&self, x: u32, y: u32) -> Rgb {
        self.pixel(x, y).variance_of_mean()
    }

    /// How many samples a pixel holds.
    ///
    /// # Panics
    /// If the pixel lies outside the film.
    pub fn sample_count(&self, x: u32, y: u32) -> u64 {
        self.pixel(x, y).count
    }

    /// Mean radiance of every pixel, row by row from the top.
    pub fn means(&self) -> impl Iterator<Item = Rgb> + '_ {
        self.pixels.iter().map(PixelSum::mean)
    }

    /// Mean radiance of the whole picture.
    pub fn image_mean(&self) -> Rgb {
        let mut sum = Rgb::BLACK;
        for mean in self.means() {
            sum += mean;
        }
        sum / self.pixels.len() as f64
    }

    /// Adds a tile's sums of one pass, given row by row.
    pub(crate) fn merge_tile(&mut self, tile: &Tile, sums: &[PixelSum]) {
        for ((x, y), sum) in tile.pixels().zip(sums) {
            let index = self.index(x, y);
            self.pixels[index].merge(sum);
        }
    }

    fn index(&self, x: u32, y: u32) -> usize {
        y as usize * self.width as usize + x as usize
    }

    fn pixel(&self, x: u32, y: u32) -> &PixelSum {
        assert!(x < self.width && y < self.height, "pixel ({x}, {y}) is outside the film");
        &self.pixels[self.index(x, y)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn mean_and_its_variance_follow_the_samples() {
        let mut film = Film::new(1, 1);
        assert_eq!(film.mean(0, 0), Rgb::BLACK);
        assert_eq!(film.variance_of_mean(0, 0).r, f64::INFINITY);
        let mut sums = PixelSum::default();
        for x in [1.0, 2.0, 3.0, 6.0] {
            sums.add(Rgb::splat(x));
        }
        film.merge_tile(&Tile::all(1, 1).next().unwrap(), &[sums]);
        assert_eq!(film.mean(0, 0), Rgb::splat(3.0));
        // Sample variance 14/3, over four samples.
        assert_relative_eq!(film.variance_of_mean(0, 0).g, 14.0 / 12.0, max_relative = 1e-15);
        assert_eq!(film.sample_count(0, 0), 4);
    }
}
