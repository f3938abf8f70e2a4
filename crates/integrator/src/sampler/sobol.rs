use super::decision::Decision;
use super::digits::{Axis, FAURE, SOBOL};
use super::member::Member;
use super::nested::{backward, permuted};
use crate::hash::{fold, nth, unit};

/// A point of a replicate: a net for each decision of a path, stratified in all dimensions of the decision.
///
/// Each decision uses the first dimensions of [`SOBOL`], or the four of [`FAURE`], with a scrambling (Owen 1995) and an
/// order of its own (padding, Kollig and Keller 2002, Burley 2020). Padding needs no table and serves paths of
/// any length, but does not stratify across decisions.
///
/// The sequence is divided into aligned parts of equal length, one for each member of a net. Which member has which part
/// is different for each decision. The samples of one member are therefore a net by themselves. So are the samples of
/// the members of a group, whose numbers begin with the same digits (Ahmed and Wonka 2020, who number pixels in Morton
/// order). For decisions up to [`Decision::LAST_OF_BLOCKS`], this holds for the members of a block instead.
///
/// Each point is uniform in the unit cube (to `2^-32`), so the mean over a replicate is unbiased. Points of one replicate
/// are dependent, replicates are independent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SobolPoint {
    /// Hashed from seed, net and replicate.
    key: u64,
    /// Hashed from these and the member.
    member_key: u64,
    /// The member's number, followed by that of the sample.
    index: u32,
    shape: Shape,
}

/// How many points a replicate has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Shape {
    /// Binary digits of an index.
    digits: u32,
    /// The last ones of these, which number the samples of a member.
    sample_digits: u32,
}

/// The hash of a key for the second permutation of many digits. Those of [`Axis`] follow.
const SECOND: u64 = 1;

impl SobolPoint {
    /// The largest number of digits: `2^21` points of a member in a replicate.
    const MAX_DIGITS: u32 = 21;

    /// Point `sample` of the `2^sample_digits` of a member in replicate `replicate`, for a seed.
    pub(crate) fn new(seed: u64, member: Member, replicate: u32, sample: u32, sample_digits: u32) -> Self {
        debug_assert!(sample_digits <= Self::MAX_DIGITS && sample >> sample_digits == 0);
        let Member { net, number, digits } = member;
        // The salt makes these keys differ from those of `Stream`.
        let parts = [seed, net, u64::from(replicate), u64::from(sample_digits), SALT];
        let key = parts.into_iter().fold(0, fold);
        let member_key = if digits == 0 { key } else { fold(key, number.into()) };
        let shape = Shape { digits: digits + sample_digits, sample_digits };
        Self { key, member_key, index: number << sample_digits | sample, shape }
    }

    /// Point `part` of the `2^digits` that take the place of this one in a larger net.
    pub(super) fn part(&self, part: u32, digits: u32) -> Self {
        let Shape { digits: all, sample_digits } = self.shape;
        debug_assert!(part >> digits == 0 && sample_digits + digits <= Self::MAX_DIGITS);
        let shape = Shape { digits: all + digits, sample_digits: sample_digits + digits };
        Self { index: self.index << digits | part, shape, ..*self }
    }

    /// The first `D` coordinates, up to three, of the point of `decision`.
    #[inline]
    pub(super) fn uniform<const D: usize>(&self, decision: Decision) -> [f64; D] {
        SobolPoints::from(&[*self]).uniform(decision).map(|[u]| u)
    }

    /// The four coordinates of this point and of those after it, for a replicate of a single decision: all its
    /// points are stratified in four dimensions. Points after the last one of the replicate mean nothing.
    #[inline(always)]
    pub(crate) fn hypercube<const N: usize>(&self) -> [[f64; N]; 4] {
        let points = SobolPoints::successive(self);
        coordinates(SOBOL, points.keys, points.indices)
    }
}

/// Points of replicates of one shape, computed in loops that the compiler vectorises.
#[derive(Clone, Copy, Debug)]
pub(super) struct SobolPoints<const N: usize> {
    keys: [u64; N],
    member_keys: [u64; N],
    indices: [u64; N],
    shape: Shape,
}

impl<const N: usize> SobolPoints<N> {
    /// `None` unless all have the same shape.
    #[inline(always)]
    pub(super) fn new(points: &[SobolPoint; N]) -> Option<Self> {
        let this = Self::from(points);
        points.iter().all(|point| point.shape == this.shape).then_some(this)
    }

    /// Takes the shape from the first point.
    #[inline(always)]
    pub(super) fn from(points: &[SobolPoint; N]) -> Self {
        let (keys, member_keys) = (points.map(|p| p.key), points.map(|p| p.member_key));
        Self { keys, member_keys, indices: points.map(|p| p.index.into()), shape: points[0].shape }
    }

    /// A point and those after it.
    #[inline(always)]
    pub(super) fn successive(first: &SobolPoint) -> Self {
        let indices = std::array::from_fn(
            #[inline(always)]
            |i| u64::from(first.index) + i as u64,
        );
        Self { indices, ..Self::from(&[*first; N]) }
    }

    /// The first `D` coordinates, up to three, of the points of `decision`.
    #[inline(always)]
    pub(super) fn uniform<const D: usize>(&self, decision: Decision) -> [[f64; N]; D] {
        let (keys, places) = self.places(decision);
        coordinates(SOBOL, keys, places)
    }

    /// The numbers for the scattered directions of a bounce. A bounce of even number and the next share four coordinates,
    /// since light of several bounces depends on how their directions combine.
    #[inline(always)]
    pub(super) fn scatter(&self, bounce: u32) -> [[f64; N]; 2] {
        let [first, second, third, fourth] = FAURE;
        let (keys, places) = self.places(Decision::scatter(bounce - bounce % 2));
        if bounce.is_multiple_of(2) {
            coordinates([first, second], keys, places)
        } else {
            coordinates([third, fourth], keys, places)
        }
    }

    /// The keys of a decision, and the indices of the points in the sequence: members in a random order, and in each
    /// its samples in another.
    #[inline(always)]
    fn places(&self, decision: Decision) -> ([u64; N], [u64; N]) {
        let Shape { digits, sample_digits } = self.shape;
        let keys = hashed(self.keys, decision.0.into());
        if digits == sample_digits {
            return (keys, shuffled(keys, self.indices, digits));
        }
        let (mut members, mut samples) = (self.indices, self.indices);
        for (member, sample) in members.iter_mut().zip(&mut samples) {
            *member >>= sample_digits;
            *sample &= (1 << sample_digits) - 1;
        }
        let member_digits = digits - sample_digits;
        if decision.0 <= Decision::LAST_OF_BLOCKS.0 {
            members = by_blocks(members, member_digits);
        }
        members = in_random_order(keys, members, member_digits);
        let mut places = shuffled(hashed(self.member_keys, decision.0.into()), samples, sample_digits);
        for (place, member) in places.iter_mut().zip(members) {
            *place |= member << sample_digits;
        }
        (keys, places)
    }
}

/// The coordinates by the first `D` of `axes` of the points at `places` of the sequence, scrambled.
#[inline(always)]
fn coordinates<const D: usize, const N: usize, const A: usize>(
    axes: [Axis; A],
    keys: [u64; N],
    places: [u64; N],
) -> [[f64; N]; D] {
    const { assert!(D <= A) };
    let mut all = [[0.0; N]; D];
    for (axis, coordinates) in axes.into_iter().zip(&mut all) {
        let digits = permuted(axis.digits_of(places), hashed(keys, axis as u64));
        for (coordinate, digits) in coordinates.iter_mut().zip(digits) {
            *coordinate = unit(digits.reverse_bits());
        }
    }
    all
}

const SALT: u64 = 0x736f_626f_6c27;

/// A random order of `2^digits` samples: two nested permutations, by last and by first digits.
///
/// With a single one, as in Burley (2020), two samples whose indices differ in the last digit fall into opposite
/// halves in every dimension, and the integral of a product of two dimensions has nearly twice the variance. A
/// permutation nested by last digits prevents this.
#[inline(always)]
fn shuffled<const N: usize>(keys: [u64; N], indices: [u64; N], digits: u32) -> [u64; N] {
    let mixed = backward(permuted(indices, keys), digits);
    backward(permuted(mixed, second_bits(keys, digits)), digits)
}

/// A random nested order of the members: two permutations, of which a single one would depend too much on its first digits.
#[inline(always)]
fn in_random_order<const N: usize>(keys: [u64; N], members: [u64; N], digits: u32) -> [u64; N] {
    let mixed = permuted(backward(members, digits), keys);
    backward(permuted(mixed, second_bits(keys, digits)), digits)
}

/// The random bits of a second permutation of `digits` digits, which takes others of a key than the first one.
#[inline(always)]
fn second_bits<const N: usize>(mut keys: [u64; N], digits: u32) -> [u64; N] {
    if digits > 16 {
        return hashed(keys, SECOND);
    }
    for key in &mut keys {
        *key = key.rotate_right(16);
    }
    keys
}

/// Members by blocks instead of groups: the first half of their digits becomes the sum of both.
#[inline(always)]
fn by_blocks<const N: usize>(mut members: [u64; N], digits: u32) -> [u64; N] {
    for member in &mut members {
        *member ^= *member << (digits / 2) & ((1 << digits) - 1);
    }
    members
}

/// Hash `counter` of each key.
#[inline(always)]
fn hashed<const N: usize>(mut keys: [u64; N], counter: u64) -> [u64; N] {
    for key in &mut keys {
        *key = nth(*key, counter);
    }
    keys
}

#[cfg(test)]
mod tests;
