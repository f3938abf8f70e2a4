//! Random numbers: independent at any two addresses.

use globillum::integrator::Stream;
use globillum_testkit::chi_square::ChiSquare;

#[test]
fn neighbouring_addresses_give_other_numbers() {
    let base = Stream::new(1, 2, 3);
    for other in [Stream::new(2, 2, 3), Stream::new(1, 3, 3), Stream::new(1, 2, 4), Stream::new(2, 1, 3)] {
        assert!((0..64).all(|dimension| base.uniform(dimension) != other.uniform(dimension)));
    }
    assert_eq!(base, Stream::new(1, 2, 3));
}

/// 256 x 256 equal cells.
fn assert_even(what: &str, pair: impl Fn(u32) -> [f64; 2]) {
    let mut counts = vec![0; 1 << 16];
    for i in 0..1 << 21 {
        let [a, b] = pair(i).map(|u| (u * 256.0) as usize);
        counts[256 * a + b] += 1;
    }
    ChiSquare::of_equal_cells(&counts).assert_fits(what);
}

#[test]
fn pairs_of_numbers_fill_the_square_evenly() {
    let of_pixel = |pixel: u32| Stream::new(0, pixel.into(), 0).uniform(0);
    assert_even("consecutive pixels", |i| [of_pixel(i), of_pixel(i + 1)]);
    let of_sample = |sample: u32| Stream::new(0, 0, sample).uniform(0);
    assert_even("consecutive samples", |i| [of_sample(i), of_sample(i + 1)]);
    let of_seed = |seed: u32| Stream::new(seed.into(), 0, 0).uniform(0);
    assert_even("consecutive seeds", |i| [of_seed(i), of_seed(i + 1)]);
    assert_even("dimensions of consecutive samples", |i| Stream::new(0, 0, i).uniform_pair(0));
    assert_even("consecutive dimensions", |i| Stream::new(0, 0, 0).uniform_pair(2 * i));
}
