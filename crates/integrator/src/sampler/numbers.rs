use super::decision::{Decision, MirrorSize};
use super::sobol::{SobolPoint, SobolPoints};
use super::stream::Stream;

/// The random numbers of one sample of one pixel.
///
/// A number depends on its address only, so any sample can be computed alone. Each decision of a path has
/// an address of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Numbers {
    Independent(Stream),
    Sobol(SobolPoint),
}

/// The choice of a light, and that of a point on it: together uniform in the unit cube.
type LightNumbers = (f64, [f64; 2]);

impl Numbers {
    /// The numbers of part `part` of `count`, a power of two up to [`Sampler::MAX_PARTS`](super::Sampler::MAX_PARTS), for a
    /// decision that a sample takes as many times. By Sobol' points, those of all parts of the samples of a pass are one net.
    #[inline]
    pub(crate) fn part(&self, part: u32, count: u32) -> Self {
        match self {
            _ if count == 1 => *self,
            Self::Independent(stream) => Self::Independent(stream.part(part)),
            Self::Sobol(point) => Self::Sobol(point.part(part, count.trailing_zeros())),
        }
    }

    /// Parts `first` and on of `count`, and then the first ones again.
    #[inline(always)]
    pub(crate) fn parts<const N: usize>(&self, first: u32, count: u32) -> [Self; N] {
        std::array::from_fn(
            #[inline(always)]
            |i| self.part((first + i as u32) % count, count),
        )
    }

    /// The positions in their pixels of `N` samples: each uniform in the unit square.
    #[inline(always)]
    pub(crate) fn pixel_positions<const N: usize>(samples: &[Self; N]) -> [[f64; 2]; N] {
        let [x, y] = Samples::of(samples).uniform(Decision::PIXEL_POSITION);
        std::array::from_fn(
            #[inline(always)]
            |i| [x[i], y[i]],
        )
    }

    /// For the choices of `N` lights by parts `first` and on, and of points on them.
    #[inline(always)]
    pub(crate) fn lights<const N: usize>(&self, bounce: u32, first: u32, count: u32) -> [LightNumbers; N] {
        Samples::of(&self.parts(first, count)).lights(Decision::light(bounce))
    }

    /// For the choices of mirrors by `N` samples: each uniform in `[0, 1)`.
    #[inline(always)]
    pub(crate) fn mirrors<const N: usize>(samples: &[Self; N], size: MirrorSize, bounce: u32) -> [f64; N] {
        let [choices] = Samples::of(samples).uniform(Decision::mirror(size, bounce));
        choices
    }

    /// [`Numbers::mirrors`] for one sample.
    #[inline]
    pub(crate) fn mirror(&self, size: MirrorSize, bounce: u32) -> f64 {
        let [choice] = Self::mirrors(&[*self], size, bounce);
        choice
    }

    /// For the choices of lights in these mirrors, and of points on them.
    #[inline(always)]
    pub(crate) fn lights_in_mirrors<const N: usize>(
        samples: &[Self; N],
        size: MirrorSize,
        bounce: u32,
    ) -> [LightNumbers; N] {
        Samples::of(samples).lights(Decision::light_in_mirror(size, bounce))
    }

    /// [`Numbers::lights_in_mirrors`] for one sample.
    #[inline]
    pub(crate) fn light_in_mirror(&self, size: MirrorSize, bounce: u32) -> LightNumbers {
        let [light] = Self::lights_in_mirrors(&[*self], size, bounce);
        light
    }

    /// The first `D` numbers of a decision.
    pub(super) fn uniform<const D: usize>(&self, decision: Decision) -> [f64; D] {
        match self {
            Self::Independent(stream) => {
                std::array::from_fn(|i| stream.uniform(decision.dimension() + i as u32))
            }
            Self::Sobol(point) => point.uniform(decision),
        }
    }

    /// For a scattered direction.
    pub(super) fn scatter(&self, bounce: u32) -> [f64; 2] {
        match self {
            Self::Independent(_) => self.uniform(Decision::scatter(bounce)),
            Self::Sobol(point) => SobolPoints::from(&[*point]).scatter(bounce).map(|[u]| u),
        }
    }
}

/// Samples whose numbers are computed side by side.
#[derive(Clone, Copy, Debug)]
pub(super) enum Samples<'a, const N: usize> {
    /// Vectorised: Sobol' points of passes of one length.
    Points(SobolPoints<N>),
    Others(&'a [Numbers; N]),
}

impl<'a, const N: usize> Samples<'a, N> {
    #[inline(always)]
    pub(super) fn of(samples: &'a [Numbers; N]) -> Self {
        let Numbers::Sobol(first) = samples[0] else { return Self::Others(samples) };
        let mut points = [first; N];
        for (point, numbers) in points.iter_mut().zip(samples) {
            let Numbers::Sobol(this) = numbers else { return Self::Others(samples) };
            *point = *this;
        }
        SobolPoints::new(&points).map_or(Self::Others(samples), Self::Points)
    }

    /// The first `D` numbers of a decision.
    #[inline(always)]
    pub(super) fn uniform<const D: usize>(&self, decision: Decision) -> [[f64; N]; D] {
        match self {
            Self::Points(points) => points.uniform(decision),
            Self::Others(samples) => one_by_one(samples, |numbers| numbers.uniform(decision)),
        }
    }

    /// For scattered directions.
    #[inline(always)]
    pub(super) fn scatter(&self, bounce: u32) -> [[f64; N]; 2] {
        match self {
            Self::Points(points) => points.scatter(bounce),
            Self::Others(samples) => one_by_one(samples, |numbers| numbers.scatter(bounce)),
        }
    }

    /// For the choices of lights, and of points on them, which have the first two coordinates: these are the best
    /// stratified.
    #[inline(always)]
    fn lights(&self, decision: Decision) -> [LightNumbers; N] {
        let [x, y, light] = self.uniform(decision);
        std::array::from_fn(
            #[inline(always)]
            |i| (light[i], [x[i], y[i]]),
        )
    }
}

/// What `numbers` returns for each sample. Rarely used, and so not inlined into each instruction set's code.
#[inline(never)]
fn one_by_one<const N: usize, const D: usize>(
    samples: &[Numbers; N],
    numbers: impl Fn(&Numbers) -> [f64; D],
) -> [[f64; N]; D] {
    let all = samples.each_ref().map(numbers);
    std::array::from_fn(|dimension| std::array::from_fn(|sample| all[sample][dimension]))
}
