use crate::Aabb;

/// A plane `axis = position`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plane {
    pub(super) axis: usize,
    pub(super) position: f32,
    /// To which side triangles that lie within the plane go.
    pub(super) within: Side,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Lower,
    Upper,
}

/// Where a member is to be listed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
    Lower,
    Upper,
    Both,
}

/// A plane and how many boxes lie on its two sides; one that straddles it counts for both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Split {
    pub(super) plane: Plane,
    pub(super) counts: [usize; 2],
}

impl Plane {
    /// On which side of the plane a box lies.
    #[inline]
    pub(super) fn place(&self, bounds: &Aabb) -> Place {
        let (min, max) = (bounds.min[self.axis], bounds.max[self.axis]);
        let below = min < self.position;
        let lower = below | ((max == self.position) & (self.within == Side::Lower));
        // In numbers, since a branch would be foreseen half the time.
        [[Place::Upper, Place::Lower], [Place::Upper, Place::Both]]
            [usize::from(below & (self.position < max))][usize::from(lower)]
    }

    /// The two parts of `cell`, lower and upper.
    pub(super) fn halves(&self, cell: &Aabb) -> [Aabb; 2] {
        let [mut lower, mut upper] = [*cell; 2];
        lower.max[self.axis] = self.position;
        upper.min[self.axis] = self.position;
        [lower, upper]
    }

    /// Whether both halves of `cell` are smaller than it.
    pub(super) fn halves_properly(&self, cell: &Aabb) -> bool {
        cell.min[self.axis] < self.position && self.position < cell.max[self.axis]
    }
}

impl Split {
    /// The plane, with the boxes on its sides counted.
    pub(super) fn count<'a>(plane: Plane, boxes: impl Iterator<Item = &'a Aabb>) -> Self {
        let mut counts = [0; 2];
        for bounds in boxes {
            match plane.place(bounds) {
                Place::Lower => counts[0] += 1,
                Place::Upper => counts[1] += 1,
                Place::Both => counts = counts.map(|count| count + 1),
            }
        }
        Self { plane, counts }
    }
}
