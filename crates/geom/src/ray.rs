use glam::DVec3;

/// The ray `origin + t * direction` over the open range `t_min < t < t_max`.
///
/// The direction may have any length within [`Ray::DIRECTION_DOMAIN`]: scaling it by `2^k` scales every `t` by exactly
/// `2^-k`, within the limits that [`Accel`](crate::Accel) states.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// The point at `t = 0`.
    pub origin: DVec3,
    /// The offset per unit of `t`, not necessarily normalized.
    pub direction: DVec3,
    /// The lower end of the range, excluded; may be negative.
    pub t_min: f64,
    /// The upper end of the range, excluded; may be infinite.
    pub t_max: f64,
    /// The indices of two triangles that the ray never hits; [`Ray::NO_TRIANGLE`] stands for none.
    ///
    /// Rays that leave a surface exclude the triangle that they start on, and segments between surfaces the one that
    /// they end on, too. They miss these triangles by less than `f32` resolves, so an accelerator that did not know them
    /// would have to decide each exactly.
    pub excluded: [u32; 2],
}

impl Ray {
    /// The largest magnitude of an origin coordinate of a traceable ray: `2^300`.
    pub const MAX_ORIGIN: f64 = power_of_two(300);
    /// The range of the largest magnitude of a direction component of a traceable ray: `2^-600..=2^600`.
    pub const DIRECTION_DOMAIN: std::ops::RangeInclusive<f64> = power_of_two(-600)..=power_of_two(600);

    /// The index of no triangle.
    pub const NO_TRIANGLE: u32 = u32::MAX;

    /// A ray with the range `0 < t < infinity`, which excludes no triangle.
    #[inline(always)]
    pub const fn new(origin: DVec3, direction: DVec3) -> Self {
        Self { origin, direction, t_min: 0.0, t_max: f64::INFINITY, excluded: [Self::NO_TRIANGLE; 2] }
    }

    /// The open segment from `from` (`t = 0`) to `to` (`t = 1`), which excludes no triangle.
    #[inline(always)]
    pub fn segment(from: DVec3, to: DVec3) -> Self {
        Self { t_max: 1.0, ..Self::new(from, to - from) }
    }

    /// The same ray with the range `t_min < t < t_max`.
    #[must_use]
    pub const fn with_range(self, t_min: f64, t_max: f64) -> Self {
        Self { t_min, t_max, ..self }
    }

    /// The same ray, which never hits the triangles `excluded`, in place of those that it excluded before. Indices that
    /// no triangle has are allowed.
    ///
    /// ```
    /// # use {glam::DVec3, globillum_geom::Ray};
    /// let ray = Ray::new(DVec3::Z, -DVec3::Z).excluding([7, Ray::NO_TRIANGLE]);
    /// assert!(ray.excludes(7) && !ray.excludes(8));
    /// ```
    #[must_use]
    #[inline(always)]
    pub const fn excluding(self, excluded: [u32; 2]) -> Self {
        Self { excluded, ..self }
    }

    /// Whether triangle `index` is excluded.
    #[inline(always)]
    pub const fn excludes(&self, index: u32) -> bool {
        (self.excluded[0] == index) | (self.excluded[1] == index)
    }

    /// The point `origin + t * direction`, rounded.
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + t * self.direction
    }

    /// Whether accelerators trace the ray; they report no hit for any other.
    ///
    /// `false` for a NaN or infinite origin or direction, a zero direction, an origin beyond
    /// [`Ray::MAX_ORIGIN`], a direction outside [`Ray::DIRECTION_DOMAIN`], and a range that is empty or has a
    /// NaN end.
    #[inline]
    pub fn is_traceable(&self) -> bool {
        let (origin, direction) = (self.origin.abs(), self.direction.abs());
        let domain = Self::DIRECTION_DOMAIN;
        // Comparisons with NaN are false. `&` evaluates all of them, so that loops over rays vectorize.
        origin.cmple(DVec3::splat(Self::MAX_ORIGIN)).all()
            & direction.cmple(DVec3::splat(*domain.end())).all()
            & direction.cmpge(DVec3::splat(*domain.start())).any()
            & (self.t_min < self.t_max)
    }
}

/// `2^exponent` for the normal range of exponents.
pub(crate) const fn power_of_two(exponent: i64) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}
