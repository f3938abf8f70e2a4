use std::fmt;
use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Sub};

/// Linear colour with Rec. 709 primaries: a reflectance, a weight or a radiance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rgb {
    /// Red.
    pub r: f64,
    /// Green.
    pub g: f64,
    /// Blue.
    pub b: f64,
}

impl Rgb {
    /// All components zero.
    pub const BLACK: Self = Self::splat(0.0);
    /// All components one.
    pub const WHITE: Self = Self::splat(1.0);

    /// The colour with these components.
    pub const fn new(r: f64, g: f64, b: f64) -> Self {
        Self { r, g, b }
    }

    /// All three components equal to `value`.
    pub const fn splat(value: f64) -> Self {
        Self::new(value, value, value)
    }

    /// The components in order.
    pub const fn to_array(self) -> [f64; 3] {
        [self.r, self.g, self.b]
    }

    /// Applies `f` to each component.
    #[must_use]
    #[inline(always)]
    pub fn map(self, f: impl Fn(f64) -> f64) -> Self {
        Self::new(f(self.r), f(self.g), f(self.b))
    }

    /// The component-wise maximum.
    #[inline(always)]
    pub fn max(self, other: Self) -> Self {
        Self::new(self.r.max(other.r), self.g.max(other.g), self.b.max(other.b))
    }

    /// The largest component.
    #[inline(always)]
    pub fn max_component(self) -> f64 {
        self.r.max(self.g).max(self.b)
    }

    /// The arithmetic mean of the components.
    pub fn mean(self) -> f64 {
        (self.r + self.g + self.b) / 3.0
    }

    /// Relative luminance, the Y of CIE XYZ (Rec. 709 weights).
    pub fn luminance(self) -> f64 {
        0.2126 * self.r + 0.7152 * self.g + 0.0722 * self.b
    }

    /// Whether all components are zero.
    #[inline(always)]
    pub fn is_black(self) -> bool {
        self == Self::BLACK
    }

    /// Whether no component is NaN or infinite.
    pub fn is_finite(self) -> bool {
        self.r.is_finite() && self.g.is_finite() && self.b.is_finite()
    }
}

impl From<[f64; 3]> for Rgb {
    fn from([r, g, b]: [f64; 3]) -> Self {
        Self { r, g, b }
    }
}

impl fmt::Display for Rgb {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "({}, {}, {})", self.r, self.g, self.b)
    }
}

impl Add for Rgb {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self::new(self.r + o.r, self.g + o.g, self.b + o.b)
    }
}

impl Sub for Rgb {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self::new(self.r - o.r, self.g - o.g, self.b - o.b)
    }
}

impl Mul for Rgb {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        Self::new(self.r * o.r, self.g * o.g, self.b * o.b)
    }
}

impl Mul<f64> for Rgb {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: f64) -> Self {
        self.map(|x| x * s)
    }
}

impl Mul<Rgb> for f64 {
    type Output = Rgb;
    #[inline(always)]
    fn mul(self, c: Rgb) -> Rgb {
        c * self
    }
}

impl Div<f64> for Rgb {
    type Output = Self;
    #[inline(always)]
    fn div(self, s: f64) -> Self {
        self.map(|x| x / s)
    }
}

impl DivAssign<f64> for Rgb {
    #[inline(always)]
    fn div_assign(&mut self, s: f64) {
        *self = *self / s;
    }
}

impl Sum for Rgb {
    fn sum<I: Iterator<Item = Self>>(colours: I) -> Self {
        colours.fold(Self::BLACK, |sum, colour| sum + colour)
    }
}

impl AddAssign for Rgb {
    #[inline(always)]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl MulAssign for Rgb {
    #[inline(always)]
    fn mul_assign(&mut self, o: Self) {
        *self = *self * o;
    }
}

impl MulAssign<f64> for Rgb {
    #[inline(always)]
    fn mul_assign(&mut self, s: f64) {
        *self = *self * s;
    }
}
