use super::*;

/// The defining property of a (0, m, 2)-net: each elementary interval, whatever its shape,
/// holds one point. Both pairs of four coordinates have it.
#[test]
fn every_elementary_interval_holds_one_point() {
    for (digits, replicate, bounce) in [(0, 0, 1), (1, 3, 0), (4, 0, 7), (6, 1, 2), (8, 2, 600), (11, 0, 3)] {
        let points: Vec<_> = (0..1_u32 << digits)
            .map(|i| SobolPoint::new(5, Member::alone(77), replicate, i, digits))
            .map(|point| SobolPoints::from(&[point]).scatter(bounce).map(|[u]| u))
            .collect();
        assert!(is_net(&points, digits), "{digits} digits, bounce {bounce}");
    }
}

/// Whether each elementary interval, whatever its shape, holds one of `2^digits` points.
fn is_net(points: &[[f64; 2]], digits: u32) -> bool {
    (0..=digits).all(|across| {
        let (columns, rows) = (1_usize << across, 1_usize << (digits - across));
        let mut seen = vec![false; columns * rows];
        points.iter().all(|[x, y]| {
            let cell = (x * columns as f64) as usize * rows + (y * rows as f64) as usize;
            !std::mem::replace(&mut seen[cell], true)
        })
    })
}

/// The samples of all members are a net, and those of one. So are those of the sixteen members whose numbers have the
/// first half in common, or for the first decisions the sum of both halves.
#[test]
fn members_share_a_net_and_have_nets_of_their_own() {
    for (sample_digits, decision) in [(0, 3), (2, 0), (4, 7), (4, 1), (6, 2)] {
        let point = |number, sample| {
            let member = Member { net: 77, number, digits: 8 };
            SobolPoint::new(5, member, 2, sample, sample_digits).uniform::<2>(Decision(decision))
        };
        let of_members = |members: Vec<u32>| -> Vec<[f64; 2]> {
            let samples = 0..1 << sample_digits;
            members.iter().flat_map(|&m| samples.clone().map(move |sample| point(m, sample))).collect()
        };
        let part = |number: u32| if decision < 2 { (number / 16) ^ (number % 16) } else { number / 16 };
        assert!(is_net(&of_members((0..256).collect()), sample_digits + 8), "{sample_digits} digits");
        for all in 0..16 {
            let members = (0..256).filter(|&number| part(number) == all).collect();
            assert!(is_net(&of_members(members), sample_digits + 4), "{sample_digits} digits");
        }
        assert!((0..256).all(|m| is_net(&of_members(vec![m]), sample_digits)), "{sample_digits} digits");
    }
}

/// A (1, m, 3)-net: an elementary box of two points' volume holds two.
#[test]
fn every_elementary_box_holds_two_points() {
    for digits in [1, 2, 4, 6, 9] {
        let points: Vec<_> = (0..1_u32 << digits)
            .map(|i| SobolPoint::new(5, Member::alone(77), 3, i, digits).uniform::<3>(Decision(8)))
            .collect();
        for (along, across) in (0..digits).flat_map(|i| (0..digits - i).map(move |j| (i, j))) {
            let sides = [along, across, digits - 1 - along - across].map(|d| 1_usize << d);
            let mut counts = vec![0; sides.iter().product()];
            for &[x, y, z] in &points {
                let cell = |u: f64, n: usize| (u * n as f64) as usize;
                counts[(cell(x, sides[0]) * sides[1] + cell(y, sides[1])) * sides[2] + cell(z, sides[2])] +=
                    1;
            }
            assert!(counts.iter().all(|&n| n == 2), "{digits} digits, {sides:?}");
        }
    }
}

/// A (3, m, 4)-net: an elementary box of eight points' volume holds eight.
#[test]
fn every_elementary_box_of_four_dimensions_holds_eight_points() {
    for digits in [4, 6, 9] {
        let points: Vec<[f64; 4]> = (0..1_u32 << digits)
            .map(|i| SobolPoint::new(5, Member::alone(77), 3, i, digits).hypercube::<1>().map(|[u]| u))
            .collect();
        let most = digits - 3;
        let splits = (0..=most).flat_map(|a| (0..=most - a).map(move |b| (a, b)));
        let splits = splits.flat_map(|(a, b)| (0..=most - a - b).map(move |c| [a, b, c, most - a - b - c]));
        for sides in splits.map(|split| split.map(|digits| 1_usize << digits)) {
            let mut counts = vec![0; sides.iter().product()];
            for point in &points {
                let cell = |place: usize, (u, &n): (&f64, &usize)| place * n + (u * n as f64) as usize;
                counts[point.iter().zip(&sides).fold(0, cell)] += 1;
            }
            assert!(counts.iter().all(|&n| n == 8), "{digits} digits, {sides:?}");
        }
    }
}

/// The defining property of a (0, m, 4)-net in base 4: each box whose sides are powers of 1/4 and whose volume is that
/// of a point holds one.
#[test]
fn every_elementary_box_of_base_four_holds_one_point() {
    for fours in 0..=5 {
        let points: Vec<[f64; 4]> = (0..1_u32 << (2 * fours))
            .map(|i| SobolPoints::from(&[SobolPoint::new(5, Member::alone(77), 3, i, 2 * fours)]))
            .map(|point| [2, 3].map(|bounce| point.scatter(bounce)))
            .map(|[[[x], [y]], [[z], [w]]]| [x, y, z, w])
            .collect();
        let splits = (0..=fours).flat_map(|a| (0..=fours - a).map(move |b| (a, b)));
        let splits = splits.flat_map(|(a, b)| (0..=fours - a - b).map(move |c| [a, b, c, fours - a - b - c]));
        for sides in splits.map(|split| split.map(|fours| 1_usize << (2 * fours))) {
            let mut seen = vec![false; points.len()];
            for point in &points {
                let cell = |place: usize, (u, &n): (&f64, &usize)| place * n + (u * n as f64) as usize;
                let place = point.iter().zip(&sides).fold(0, cell);
                assert!(!std::mem::replace(&mut seen[place], true), "{fours} digits, {sides:?}");
            }
        }
    }
}

/// Means over nets are nearly normal: of a coordinate and of a product over 64 samples, and of a product of two decisions
/// over 256 members with one sample each. A kurtosis of 3 has a standard deviation of 0.08 in 4000 nets.
#[test]
fn means_over_nets_have_no_heavy_tails() {
    let sample = |net, i| SobolPoint::new(5, Member::alone(net), 3, i, 6);
    let member = |net, number| SobolPoint::new(5, Member { net, number, digits: 8 }, 3, 0, 0);
    let first = |net, i| sample(net, i).uniform::<2>(Decision(8));
    let coordinate = kurtosis(|net| (0..64).map(|i| first(net, i)[0]).sum());
    let product = kurtosis(|net| (0..64).map(|i| first(net, i).iter().product::<f64>()).sum());
    let decisions = kurtosis(|net| {
        let is_low = |i, decision| member(net, i).uniform::<1>(Decision(decision))[0] < 0.5;
        (0..256).filter(|&i| is_low(i, 8) && is_low(i, 11)).count() as f64
    });
    let all = [coordinate, product, decisions];
    assert!(all.iter().all(|kurtosis| (2.0..3.5).contains(kurtosis)), "{all:?}");
}

/// The kurtosis of sums over 4000 nets.
fn kurtosis(sum_of_net: impl Fn(u64) -> f64) -> f64 {
    let sums: Vec<f64> = (0..4000).map(sum_of_net).collect();
    let mean = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / sums.len() as f64;
    let center = mean(&mut sums.iter().copied());
    let moment = |power| mean(&mut sums.iter().map(|sum| (sum - center).powi(power)));
    moment(4) / moment(2).powi(2)
}

#[test]
fn points_side_by_side_are_the_points_one_by_one() {
    let together = SobolPoint::new(1, Member::alone(2), 3, 40, 7).hypercube::<8>();
    for i in 0..8 {
        let alone = SobolPoint::new(1, Member::alone(2), 3, 40 + i, 7).hypercube::<1>().map(|[u]| u);
        assert_eq!(together.map(|axis| axis[i as usize]), alone);
    }
}
