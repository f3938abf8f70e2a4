/// A decision of a path, as the address of its random numbers.
///
/// A decision has [`Decision::WIDTH`] dimensions of its own, which depend on its bounce only;
/// [`Decision::supersampling`] has more. With Sobol' points, the directions of a bounce of even number and of the next one
/// are four coordinates of one decision.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Decision(pub(super) u32);

/// The mirrors that a decision is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MirrorSize {
    Large = 0,
    Small = 1,
}

impl Decision {
    /// The largest number of dimensions of a decision but [`Decision::supersampling`].
    pub(super) const WIDTH: u32 = 3;

    /// Up to this one, decisions are stratified by blocks: they are of pixels by themselves. All others are stratified by
    /// groups: of paths that a group may reuse, and of lights in mirrors, also at the first bounce.
    pub(super) const LAST_OF_BLOCKS: Self = Self(1);

    /// Decisions at each bounce.
    const OF_BOUNCE: u32 = 3;

    /// The position in the pixel.
    pub(super) const PIXEL_POSITION: Self = Self(0);

    /// A light, and a point on it.
    pub(super) fn light(bounce: u32) -> Self {
        Self(1 + Self::OF_BOUNCE * bounce)
    }

    /// The scattered direction.
    pub(super) fn scatter(bounce: u32) -> Self {
        Self(2 + Self::OF_BOUNCE * bounce)
    }

    /// Russian roulette.
    pub(super) fn roulette(bounce: u32) -> Self {
        Self(3 + Self::OF_BOUNCE * bounce)
    }

    /// The positions in the pixel of `rays` rays that supersample lights, a power of two from sixteen on: two dimensions for
    /// each ray if numbers are independent. With Sobol' points the rays are as many points in two dimensions.
    ///
    /// Sixteen rays have the last eleven decisions before those about mirrors, 32 the 22 before these, and so on.
    pub(super) const fn supersampling(rays: u32) -> Self {
        assert!(rays >= 16 && rays.is_power_of_two());
        Self(Self::FIRST_OF_MIRRORS - 11 * (rays / 8 - 1))
    }

    /// The first decision about lights in mirrors, beyond those of all bounces.
    const FIRST_OF_MIRRORS: u32 = 5 << 28;

    /// A mirror in which a light is sampled.
    pub(super) fn mirror(size: MirrorSize, bounce: u32) -> Self {
        Self(Self::FIRST_OF_MIRRORS + 4 * bounce + 2 * size as u32)
    }

    /// A light in that mirror, and a point on it.
    pub(super) fn light_in_mirror(size: MirrorSize, bounce: u32) -> Self {
        Self(Self::FIRST_OF_MIRRORS + 1 + 4 * bounce + 2 * size as u32)
    }

    /// Its first dimension; the others follow.
    pub(super) fn dimension(self) -> u32 {
        Self::WIDTH * self.0
    }
}
