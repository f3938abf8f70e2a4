use globillum::integrator::{Estimates, FirstHits, PathReuse};
use serde::{Serialize, Serializer};
use std::fmt;
use std::ops::Range;

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Crop {
    x: u32,
    y: u32,
    width: u32,
    height: u32,
}

/// The pixels that are shown, within those that are rendered.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shown(pub(super) Crop);

impl Crop {
    /// A whole picture.
    pub(super) fn whole(width: u32, height: u32) -> Self {
        Self { x: 0, y: 0, width, height }
    }

    /// Parses `x,y,width,height`.
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        let numbers: Vec<u32> = text.split(',').map_while(|word| word.trim().parse().ok()).collect();
        match numbers[..] {
            [x, y, width, height] if width > 0 && height > 0 && text.split(',').count() == 4 => {
                Ok(Self { x, y, width, height })
            }
            _ => Err("must be X,Y,WIDTH,HEIGHT in pixels, with a width and a height of at least 1".into()),
        }
    }

    /// Whether a picture of this size has all its pixels.
    pub(super) fn is_within(&self, width: u32, height: u32) -> bool {
        let end = |start: u32, length: u32| u64::from(start) + u64::from(length);
        end(self.x, self.width) <= width.into() && end(self.y, self.height) <= height.into()
    }

    /// The columns and rows to render for them in a picture of this size: rounded outward to whole groups of pixels
    /// that reuse each other's paths.
    pub(super) fn rendered(&self, width: u32, height: u32, path_reuse: PathReuse) -> [Range<u32>; 2] {
        let side = path_reuse.tile_side();
        let around = |start: u32, length: u32, size: u32| {
            start - start % side..(start + length).next_multiple_of(side).min(size)
        };
        [around(self.x, self.width, width), around(self.y, self.height, height)]
    }
}

impl Shown {
    /// Cuts the pixels out of those that are rendered.
    pub(crate) fn cut(&self, estimates: &mut Estimates) {
        let (Self(Crop { x, y, width, height }), [left, top]) = (*self, estimates.origin);
        if (width, height) != (estimates.width, estimates.height) {
            *estimates = estimates.crop(x - left..x - left + width, y - top..y - top + height);
        }
    }

    /// Cuts the pixels out of those of the whole picture.
    pub(crate) fn cut_hits(&self, hits: FirstHits) -> FirstHits {
        let Self(Crop { x, y, width, height }) = *self;
        let is_whole = (width, height) == (hits.width, hits.height);
        if is_whole { hits } else { hits.crop(x..x + width, y..y + height) }
    }
}

impl fmt::Display for Crop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{},{},{},{}", self.x, self.y, self.width, self.height)
    }
}

impl Serialize for Crop {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crop_has_four_numbers() {
        let crop = Crop { x: 3, y: 0, width: 5, height: 1 };
        assert_eq!(Crop::parse("3, 0,5,1"), Ok(crop));
        assert_eq!(crop.to_string(), "3,0,5,1");
        for text in
            ["", "3,0,5", "3,0,5,1,2", "3,0,5,0", "3,0,0,1", "-1,0,5,1", "a,0,5,1", "3,0,5,1.5", "3,0,5,1,x"]
        {
            assert!(Crop::parse(text).is_err(), "{text}");
        }
    }

    #[test]
    fn whole_groups_are_rendered() {
        let crop = Crop { x: 3, y: 8, width: 5, height: 3 };
        assert_eq!(crop.rendered(50, 50, PathReuse::Off), [3..8, 8..11]);
        assert_eq!(crop.rendered(50, 11, PathReuse::Tiles), [0..16, 0..11]);
        assert_eq!(crop.rendered(50, 50, PathReuse::Tiles), [0..16, 0..16]);
        assert!(crop.is_within(8, 11) && !crop.is_within(7, 11) && !crop.is_within(8, 10));
        assert!(!Crop { x: u32::MAX, ..crop }.is_within(8, 11));
    }
}
