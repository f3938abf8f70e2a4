//! Pictures that a PNG shows as black or as white.

use globillum::material::Rgb;

/// The mean luminance of pictures that need no word. sRGB shows 0.003 as 9 of 255.
const SHOWN: std::ops::RangeInclusive<f64> = 0.003..=10.0;

/// The mean luminance that a proposed exposure makes.
const PROPOSED: f64 = 0.2;

/// What to do about a picture that is nearly black or white at `exposure`; `None` if it is neither.
pub(crate) fn hint(mean: Rgb, exposure: f64) -> Option<String> {
    let luminance = mean.luminance();
    if luminance <= 0.0 {
        return Some("the picture is black: no light was found that reaches the camera".into());
    }
    let shown = luminance * exposure.exp2();
    let proposed = (PROPOSED / luminance).log2().round();
    let nearly = if shown < *SHOWN.start() { "black" } else { "white" };
    let is_hidden = shown.is_finite() && !SHOWN.contains(&shown);
    is_hidden.then(|| format!("the picture is nearly {nearly}: --exposure {proposed} shows it"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_proposed_exposure_needs_no_word() {
        for luminance in [1e-40, 1e-3, 30.0, 1e40] {
            let mean = Rgb::splat(luminance);
            let said = hint(mean, 0.0).expect("it is dark or bright");
            let exposure = said.split_whitespace().nth(6).and_then(|number| number.parse().ok());
            assert_eq!(hint(mean, exposure.expect("a number")), None, "{said}");
        }
        for (mean, exposure) in [(Rgb::splat(0.0031), 0.0), (Rgb::splat(9.9), 0.0), (Rgb::splat(1e-3), 2.0)] {
            assert_eq!(hint(mean, exposure), None);
        }
        assert!(hint(Rgb::BLACK, 0.0).is_some_and(|said| said.contains("no light")));
    }
}
