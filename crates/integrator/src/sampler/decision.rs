/// One decision of a path, as the address of the random numbers that it takes.
///
/// Each decision has [`Decision::WIDTH`] dimensions to itself. They are fixed, so that a path's
/// numbers depend on nothing but its own bounces, and no other decision can take one of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Decision(pub(super) u32);

impl Decision {
    /// The most numbers that a decision takes.
    pub(super) const WIDTH: u32 = 3;

    /// Decisions at each bounce.
    const OF_BOUNCE: u32 = 3;

    /// The place in the pixel.
    pub(super) const FILM: Self = Self(0);

    /// A light, and a point on it.
    pub(super) fn light(bounce: u32) -> Self {
        Self(1 + Self::OF_BOUNCE * bounce)
    }

    /// Where a path goes on.
    pub(super) fn scatter(bounce: u32) -> Self {
        Self(2 + Self::OF_BOUNCE * bounce)
    }

    /// Whether a path goes on.
    pub(super) fn roulette(bounce: u32) -> Self {
        Self(3 + Self::OF_BOUNCE * bounce)
    }

    /// The first of the decisions about lights in mirrors, beyond all bounces that paths take. They came
    /// later, and leave the others where they were.
    const FIRST_OF_MIRRORS: u32 = 5 << 28;

    /// A mirror in which to look for a light.
    pub(super) fn mirror(bounce: u32) -> Self {
        Self(Self::FIRST_OF_MIRRORS + 2 * bounce)
    }

    /// A light in that mirror, and a point on it.
    pub(super) fn light_in_mirror(bounce: u32) -> Self {
        Self(Self::FIRST_OF_MIRRORS + 1 + 2 * bounce)
    }

    /// The dimension of its first number; the others follow.
    pub(super) fn dimension(self) -> u32 {
        Self::WIDTH * self.0
    }
}
