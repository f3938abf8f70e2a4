//! Lists of points as comma-separated values.

use anyhow::{Context, Result, anyhow, bail, ensure};
use globillum::glam::DVec3;
use globillum::integrator::{IrradiancePoints, PointError, Reading};
use std::fmt::Write;
use std::io::read_to_string;
use std::path::Path;

/// The columns of a list of points.
const COLUMNS: &str = "x,y,z,nx,ny,nz";

/// The columns that follow in a list of readings.
const MEASURED: &str = "r,g,b,r_error,g_error,b_error";

/// Reads points from the file at `path`; `-` is standard input. A message names file and line.
pub(crate) fn read(path: &Path) -> Result<IrradiancePoints> {
    if path == Path::new("-") {
        return parse(&read_to_string(std::io::stdin()).context("standard input")?, "standard input");
    }
    let name = path.display().to_string();
    let bytes = std::fs::read(path).with_context(|| format!("{name}: cannot be read"))?;
    parse(&String::from_utf8(bytes).map_err(|_| anyhow!("{name}: is not UTF-8 text"))?, &name)
}

/// Parses a list of points: a line each, but for a heading, comments (`#`) and empty lines.
fn parse(text: &str, name: &str) -> Result<IrradiancePoints> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let rows = (1..).zip(text.lines().map(str::trim));
    let mut rows = rows.filter(|(_, line)| !line.is_empty() && !line.starts_with('#')).peekable();
    let is_heading = |line: &str| line.split(',').map(str::trim).eq(COLUMNS.split(','));
    rows.next_if(|(_, line)| is_heading(line));
    let (mut lines, mut points): (Vec<u64>, Vec<_>) = (Vec::new(), Vec::new());
    for (line, row) in rows {
        points.push(point(row).with_context(|| format!("{name}:{line}"))?);
        lines.push(line);
    }
    IrradiancePoints::new(points).map_err(|error| match error {
        PointError::Position { index, position } => {
            let position = position.to_array();
            anyhow!("{name}:{}: position {position:?} is not finite or beyond +-2^60", lines[index])
        }
        PointError::Normal { index, normal } => {
            let (normal, length) = (normal.to_array(), normal.length());
            anyhow!("{name}:{}: normal {normal:?} has length {length:?}, must be 1", lines[index])
        }
        other => anyhow!("{name}: {other}"),
    })
}

/// Position and normal of a row.
fn point(row: &str) -> Result<(DVec3, DVec3)> {
    let words: Vec<&str> = row.split(',').map(str::trim).collect();
    ensure!(words.len() == 6, "has {} columns, not the 6 of {COLUMNS}", words.len());
    let mut numbers = [0.0; 6];
    for (number, word) in numbers.iter_mut().zip(words) {
        let Ok(parsed) = word.parse() else { bail!("`{word}` is not a number") };
        *number = parsed;
    }
    let [x, y, z, nx, ny, nz] = numbers;
    Ok((DVec3::new(x, y, z), DVec3::new(nx, ny, nz)))
}

/// The readings, a line each below a heading.
pub(crate) fn format(readings: impl Iterator<Item = Reading>) -> String {
    let mut text = format!("{COLUMNS},{MEASURED}\n");
    for Reading { position, normal, irradiance, std_err, .. } in readings {
        let vectors = [position, normal].into_iter().flat_map(|v| v.to_array());
        let colours = [irradiance, std_err].into_iter().flat_map(|rgb| rgb.to_array());
        for (i, number) in vectors.chain(colours).enumerate() {
            let comma = if i == 0 { "" } else { "," };
            // Writing to a string does not fail.
            let _ = write!(text, "{comma}{number}");
        }
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_have_a_line_each() {
        let list = "\u{feff}x, y,z,nx,ny,nz\r\n# a comment\r\n\r\n0,1,-2.5e1, 0,0,1\r\n1,2,3,0,-1,0";
        let points = parse(list, "a.csv").expect("it is well-formed");
        let expected = [(DVec3::new(0.0, 1.0, -25.0), DVec3::Z), (DVec3::new(1.0, 2.0, 3.0), DVec3::NEG_Y)];
        assert_eq!(points.points().collect::<Vec<_>>(), expected);
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line() {
        for (list, words) in [
            ("", "a.csv: there are no points"),
            ("x,y,z,nx,ny,nz\n\n# no points\n", "a.csv: there are no points"),
            ("0,0,0,0,0,1\n\n0,0,0,0,0\n", "a.csv:3: has 5 columns, not the 6 of x,y,z,nx,ny,nz"),
            ("0,0,0,0,0,1,2", "a.csv:1: has 7 columns"),
            ("0,0,zero,0,0,1", "a.csv:1: `zero` is not a number"),
            ("x,y,z,u,v,w", "a.csv:1: `x` is not a number"),
            ("0,0,0,0,0,1\n0,0,0,0,0,0", "a.csv:2: normal [0.0, 0.0, 0.0] has length 0.0, must be 1"),
            ("#\n0,0,0,0,3,0", "a.csv:2: normal [0.0, 3.0, 0.0] has length 3.0, must be 1"),
            ("0,nan,0,0,0,1", "a.csv:1: position [0.0, NaN, 0.0] is not finite"),
            ("0,0,1e19,0,0,1", "a.csv:1: position [0.0, 0.0, 1e19] is not finite or beyond"),
            ("0,0,0,0,0,inf", "a.csv:1: normal [0.0, 0.0, inf] has length inf"),
        ] {
            let said = format!("{:#}", parse(list, "a.csv").expect_err("it is bad"));
            assert!(said.contains(words), "{said}");
        }
    }
}
