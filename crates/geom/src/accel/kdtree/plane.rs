use crate::Aabb;

/// A split plane `axis = position`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plane {
    pub(super) axis: usize,
    pub(super) position: f32,
    /// The side of triangles that lie within the plane.
    pub(super) within: Side,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Lower,
    Upper,
}

/// The halves that a reference belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
    Lower,
    Upper,
    Both,
}

/// A split plane and the number of boxes on each side; a box that straddles the plane counts for both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Split {
    pub(super) plane: Plane,
    pub(super) counts: [usize; 2],
}

impl Plane {
    /// The side of the plane on which `bounds` lie.
    #[inline]
    pub(super) fn place(&self, bounds: &Aabb) -> Place {
        let (min, max) = (bounds.min[self.axis], bounds.max[self.axis]);
        let below = min < self.position;
        let lower = below | ((max == self.position) & (self.within == Side::Lower));
        // By table: a branch would be unpredictable.
        [[Place::Upper, Place::Lower], [Place::Upper, Place::Both]]
            [usize::from(below & (self.position < max))][usize::from(lower)]
    }

    /// The lower and the upper half of `cell`.
    pub(super) fn halves(&self, cell: &Aabb) -> [Aabb; 2] {
        let [mut lower, mut upper] = [*cell; 2];
        lower.max[self.axis] = self.position;
        upper.min[self.axis] = self.position;
        [lower, upper]
    }

    /// Whether the plane lies strictly inside `cell`.
    pub(super) fn halves_properly(&self, cell: &Aabb) -> bool {
        cell.min[self.axis] < self.position && self.position < cell.max[self.axis]
    }
}

impl Split {
    /// The split by `plane` of these boxes.
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
