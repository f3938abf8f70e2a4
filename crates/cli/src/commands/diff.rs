use crate::console;
use crate::exit::{CODES, Differs, Undecided};
use crate::file_conflicts::Uses;
use crate::parse;
use anyhow::{Context, Result, bail, ensure};
use globillum::integrator::{ChiSquare, Comparison, Estimates, Verdict};
use globillum::io::{PictureData, PictureFile, PictureFormat};
use globillum::material::Rgb;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

const LONG_ABOUT: &str = "\
Tells whether two pictures of a scene, for example of two programs, differ by more than chance.

Each side is one OpenEXR file, whose layer `stderr` has the error of each pixel if this program wrote it after \
several passes; or several files, which are seeds of one picture: they are averaged, and their spread is the error. A \
side may be any program's: radiance is read from the channels R, G and B, else those of the layer `Combined`, else of \
the only layer that has them. One file without the layer `stderr` has no errors.

Both sides must be independent, that is have other seeds, and so must the errors of the blocks of 4 x 4 pixels \
within a picture (of its tiles of 16 x 16 pixels if it reuses paths): a filter that spreads samples over several \
pixels (splatting) breaks this; a box filter and filter importance sampling do not.

Up to four tests decide: whether one side is brighter; whether neighbouring blocks differ alike; and, if errors are \
known, whether squared differences of pixels exceed them (chi-square), and whether one block differs by many standard \
errors. Equal pictures are called different with the stated false-alarm rate at most. Few tiles tell nothing if errors \
are not known, or not well, nor do many if errors are not known and few tiles outshine the others: where even the \
picture beside black would not be called different, `diff` says that it cannot tell, with exit code 5.";

const EXAMPLES: &str = "\
Examples:
  Two seeds of this program:
      globillum diff a.exr b.exr
  This program beside another one, whose files have no errors:
      globillum diff a.exr theirs.exr
  Where they differ as a PNG, by the spread of four seeds of the other one:
      globillum diff a.exr --with b1.exr b2.exr b3.exr b4.exr --block-map z.png
  Four seeds of each of two programs:
      globillum diff a1.exr a2.exr a3.exr a4.exr --with b1.exr b2.exr b3.exr b4.exr";

/// Tells whether two pictures differ by more than their errors
#[derive(clap::Args, Debug)]
#[command(long_about = LONG_ABOUT, after_long_help = format!("{CODES}\n\n{EXAMPLES}"))]
pub(crate) struct Options {
    /// The two pictures, or the seeds of the first side
    #[arg(value_name = "PICTURE.exr", required = true)]
    pictures: Vec<PathBuf>,
    /// The seeds of the second side
    #[arg(long, value_name = "PICTURE.exr", num_args = 1..)]
    with: Vec<PathBuf>,
    /// How often equal pictures may be called different
    #[arg(long, value_name = "P", default_value_t = 0.001, value_parser = parse::probability)]
    #[arg(allow_negative_numbers = true)]
    false_alarm: f64,
    /// Show how many standard errors pixels differ by: red where the first side is brighter, blue where darker
    ///
    /// White is no difference, full colour 5 standard errors or more, grey where errors are unknown: everywhere if a
    /// side is one file without errors. Of the three components, the one that differs most is shown.
    #[arg(long, value_name = "FILE.png", help_heading = "Output")]
    map: Option<PathBuf>,
    /// The same for blocks of 4 x 4 pixels, in which small differences of many pixels show
    #[arg(long, value_name = "FILE.png", help_heading = "Output")]
    block_map: Option<PathBuf>,
}

pub(crate) fn run(options: &Options) -> Result<()> {
    Uses::default()
        .read("the picture", options.pictures.iter().chain(&options.with))
        .written("--map", &options.map)
        .written("--block-map", &options.block_map)
        .check()?;
    let maps = [&options.map, &options.block_map].map(Option::as_deref);
    let maps = maps.map(|path| path.map(open_map).transpose());
    let [pixel_map, block_map] = maps;
    let (pixel_map, block_map) = (pixel_map?, block_map?);
    let [a, b] = options.sides()?;
    let [a, b] = [Side::read(a)?, Side::read(b)?];
    a.check_size(&b)?;
    a.warn_if_dependent(&b);
    let comparison = Comparison::between(&a.pictures, &b.pictures).context("pictures have other sizes")?;
    let size = (comparison.width, comparison.height);
    if let Some(map) = pixel_map {
        map.write_data(&colours(&comparison.pixels, size, |x, y| y * size.0 + x))?;
    }
    if let Some(map) = block_map {
        let (side, columns) = (Estimates::BLOCK_SIDE, comparison.blocks_width());
        map.write_data(&colours(&comparison.blocks, size, |x, y| y / side * columns + x / side))?;
    }
    console::print(table(&comparison, [&a, &b], options.false_alarm).as_bytes())?;
    judge(&comparison, options.false_alarm)
}

/// Fails unless no difference is found by tests that can find one.
fn judge(comparison: &Comparison, false_alarm: f64) -> Result<()> {
    let (p, least) = (comparison.p_value(), comparison.least_p_value);
    match comparison.verdict(false_alarm) {
        Verdict::NoDifferenceFound => Ok(()),
        Verdict::Different => {
            bail!(Differs(format!("by more than chance (p = {p:.2e}, false-alarm rate {false_alarm:?})")))
        }
        Verdict::CannotTell => bail!(Undecided(format!(
            "the picture beside black would have p = {least:.2e} (false-alarm rate {false_alarm:?}); \
             larger pictures, more seeds or more passes tell more"
        ))),
    }
}

fn open_map(path: &Path) -> Result<PictureFile> {
    let is_png = PictureFormat::of(path)? == PictureFormat::Png;
    ensure!(is_png, "{}: a map is a PNG", path.display());
    Ok(PictureFile::create(path)?)
}

impl Options {
    /// The files of each side.
    fn sides(&self) -> Result<[&[PathBuf]; 2]> {
        match (self.pictures.as_slice(), self.with.as_slice()) {
            ([a, b], []) => Ok([std::slice::from_ref(a), std::slice::from_ref(b)]),
            (_, []) => bail!("--with is missing: it names the second side, unless there are two pictures"),
            (a, b) => Ok([a, b]),
        }
    }
}

/// The pictures of a side, with their files.
struct Side<'a> {
    paths: &'a [PathBuf],
    pictures: Vec<Estimates>,
    attributes: Vec<BTreeMap<String, String>>,
}

impl<'a> Side<'a> {
    fn read(paths: &'a [PathBuf]) -> Result<Self> {
        let (mut pictures, mut attributes) = (Vec::new(), Vec::new());
        for path in paths {
            let data = PictureData::read(path)?;
            pictures.push(data.estimates);
            attributes.push(data.attributes);
        }
        let side = Self { paths, pictures, attributes };
        side.check_size(&side)?;
        Ok(side)
    }

    /// Whether all pictures of both sides have the size of the first.
    fn check_size(&self, other: &Self) -> Result<()> {
        let (first, width, height) = (&self.paths[0], self.pictures[0].width, self.pictures[0].height);
        for (path, picture) in other.paths.iter().zip(&other.pictures) {
            let (w, h) = (picture.width, picture.height);
            ensure!(
                (w, h) == (width, height),
                "{}: has {w} x {h} pixels, {} {width} x {height}",
                path.display(),
                first.display()
            );
        }
        self.check_place(other)
    }

    /// Whether all crops whose places are known show the same part of the picture.
    fn check_place(&self, other: &Self) -> Result<()> {
        let pictures = [self, other].map(|side| side.paths.iter().zip(&side.pictures)).into_iter().flatten();
        let crops = pictures.filter(|(_, picture)| picture.is_crop());
        let mut places = crops.map(|(path, crop)| (path, (crop.origin, crop.full_size)));
        let Some((first, one)) = places.next() else { return Ok(()) };
        match places.find(|(_, place)| *place != one) {
            Some((path, ([x, y], [width, height]))) => {
                let ([first_x, first_y], [first_width, first_height]) = one;
                bail!(
                    "{}: shows the pixels from ({x}, {y}) on of {width} x {height}, {} from ({first_x}, {first_y}) on of {first_width} x {first_height}",
                    path.display(),
                    first.display()
                )
            }
            None => Ok(()),
        }
    }

    /// Warns of pictures of this program with the same seed.
    fn warn_if_dependent(&self, other: &Self) {
        let files =
            || self.paths.iter().chain(other.paths).zip(self.attributes.iter().chain(&other.attributes));
        for (at, (path, attributes)) in files().enumerate() {
            let Some(seed) = attributes.get("seed") else { continue };
            if let Some((twin, _)) = files().take(at).find(|(_, before)| before.get("seed") == Some(seed)) {
                let (path, twin) = (path.display(), twin.display());
                console::warn(format_args!(
                    "{twin} and {path}: have the same seed, so their errors are not independent"
                ));
            }
        }
    }
}

fn table(comparison: &Comparison, sides: [&Side; 2], false_alarm: f64) -> String {
    let Comparison { width, height, ratio, ratio_95: [low, high], mean, neighbours, .. } = comparison;
    let [a, b] = sides.map(|side| side.paths.len());
    let [red, green, blue] = comparison.component_ratios.to_array();
    let mut table = format!("pictures      {a} and {b} of {width} x {height} pixels\n");
    table += &format!("ratio         {ratio:.6} (95 % confidence interval {low:.6} to {high:.6})\n");
    table += &format!("components    {red:.6}, {green:.6}, {blue:.6}\n");
    table += &deviates("pixels", &comparison.pixels, *width);
    table += &deviates("blocks", &comparison.blocks, comparison.blocks_width());
    table += &format!("means         z {mean:.2}\n");
    table += &format!("neighbours    z {neighbours:.2}\n");
    table += &match comparison.chi_square {
        Some(ChiSquare { reduced, z, .. }) => format!("chi-square    {reduced:.4} of 1, z {z:.2}\n"),
        None => "chi-square    not known: a picture has no errors\n".to_owned(),
    };
    if comparison.chi_square.is_some_and(|chi_square| chi_square.z < -4.0) {
        table +=
            "              differences are too small: errors are too large, or pictures not independent\n";
    }
    if let Some(z) = comparison.largest_block {
        table += &format!("largest       z {z:.2} of a block\n");
    }
    let (verdict, p) = (comparison.verdict(false_alarm), comparison.p_value());
    table + &format!("verdict       {verdict}: p = {p:.2e}, false-alarm rate {false_alarm:?}\n")
}

/// How many deviates are large, apart from those of components that are exact, and where the largest is.
fn deviates(name: &str, deviates: &[Rgb], width: u32) -> String {
    let all = || deviates.iter().map(|z| largest(*z)).enumerate().filter(|(_, z)| !z.is_nan());
    let Some((at, z)) = all().max_by(|(_, a), (_, b)| a.abs().total_cmp(&b.abs())) else {
        return format!("{name:<13} errors are not known\n");
    };
    let components = deviates.iter().flat_map(|z| z.to_array()).filter(|&z| !z.is_nan() && z != 0.0);
    let (large, count) =
        components.fold((0, 0), |(large, count), z| (large + usize::from(z.abs() > 1.96), count + 1));
    let (x, y) = (at % width as usize, at / width as usize);
    let share = 100.0 * f64::from(large as u32) / f64::from(u32::max(count as u32, 1));
    format!("{name:<13} {share:.2} % with |z| above 1.96, largest z {z:.2} at ({x}, {y})\n")
}

/// The component that differs most.
fn largest(deviate: Rgb) -> f64 {
    deviate
        .to_array()
        .into_iter()
        .fold(0.0, |largest: f64, z| if z.abs() > largest.abs() || z.is_nan() { z } else { largest })
}

/// A map of deviates, of which `place` says where that of a pixel is.
fn colours(deviates: &[Rgb], (width, height): (u32, u32), place: impl Fn(u32, u32) -> u32) -> PictureData {
    let mut map = Estimates::unknown(width, height);
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    for (colour, (x, y)) in map.means.iter_mut().zip(pixels) {
        *colour = colour_of(largest(deviates[place(x, y) as usize]));
    }
    PictureData::new(map)
}

/// White for 0, red above, blue below, full at 5; grey for NaN.
fn colour_of(z: f64) -> Rgb {
    if z.is_nan() {
        return Rgb::splat(0.2);
    }
    let rest = 1.0 - (z.abs() / 5.0).min(1.0);
    if z > 0.0 { Rgb::new(1.0, rest, rest) } else { Rgb::new(rest, rest, 1.0) }
}
