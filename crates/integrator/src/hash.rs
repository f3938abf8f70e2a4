//! 64-bit hashes, the same on every machine.

/// The odd number nearest to `2^64` over the golden ratio.
pub(crate) const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// A bijection of 64 bits; every input bit changes about half of the output bits (Stafford's mixer 13).
#[inline]
pub(crate) fn mix(mut x: u64) -> u64 {
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// Appends `part` to what `key` is the hash of.
#[inline]
pub(crate) fn fold(key: u64, part: u64) -> u64 {
    mix(key.wrapping_add(GOLDEN) ^ mix(part.wrapping_add(GOLDEN)))
}

/// Number `counter` of the sequence of SplitMix64 that starts at `key` (Steele, Lea and Flood,
/// "Fast Splittable Pseudorandom Number Generators", 2014).
#[inline]
pub(crate) fn nth(key: u64, counter: u64) -> u64 {
    mix(key.wrapping_add(GOLDEN.wrapping_mul(counter.wrapping_add(1))))
}

/// The upper 53 bits as a number in `[0, 1)`, a multiple of `2^-53`.
#[inline]
pub(crate) fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 * (f64::EPSILON / 2.0)
}

/// What the sources are hashed to whose change may change a sample or a count, in parts.
pub(crate) fn sources() -> impl Iterator<Item = u64> {
    let hashes =
        [globillum_geom::SOURCE_HASH, globillum_material::SOURCE_HASH, env!("GLOBILLUM_SOURCE_HASH")];
    hashes.into_iter().flat_map(str::bytes).map(u64::from)
}
