use super::directions::BINS;
use super::vertex_tree::{GuideVertex, VertexTree};
use super::{Directions, Guide, GuideRecord};
use rayon::prelude::*;

/// The least mean number of records in a cell. The mean is less than twice this, as the number of cells is a power of two.
const CELL_RECORDS: usize = 512;

/// One record in this many is used to choose where cells are divided.
const DIVIDING: usize = 7;

/// The number of rounds in which cells estimate the radiance beyond the next vertex from each other.
const ROUNDS: u32 = 8;

/// The weight of a parent's probability of a bin in those of its children, as a number of records.
const PRIOR: f64 = 4.0;

/// The fraction of directions that are sampled by the cosine. No weight of a direction exceeds its inverse.
const COSINE_PART: f64 = 0.5;

/// Sums over the records of a node.
#[derive(Clone, Copy)]
struct Sums {
    /// For each bin, the sum of the squares of radiance, and the number of records.
    squares: [f64; BINS],
    counts: [f64; BINS],
}

impl Guide {
    /// Learns a guide from these records. In each cell, half of the directions follow the root of the mean square of
    /// radiance, which gives the least variance (Rath and others 2020).
    pub(crate) fn learn(records: &[GuideRecord]) -> Self {
        let depth = (records.len() / CELL_RECORDS).max(1).ilog2();
        let some = records.iter().step_by(DIVIDING);
        let mut vertices: Vec<GuideVertex> = some.map(|record| record.vertex).collect();
        let tree = VertexTree::build(&mut vertices, depth);
        let cells: Vec<u32> =
            records.par_iter().map(|record| tree.cells(&[record.vertex])[0] as u32).collect();
        let radiance = incident(records, &cells, 1 << depth);
        let mut leaves = vec![Sums::EMPTY; 1 << depth];
        for ((record, &cell), radiance) in records.iter().zip(&cells).zip(radiance) {
            leaves[cell as usize].add(record.bin, radiance);
        }
        Self { tree, cells: smoothed(leaves).iter().map(directions).collect() }
    }
}

/// The radiance along the direction of each record: what its path found up to the next one, and the mean of what the
/// records of that one's cell found. There are `count` cells.
fn incident(records: &[GuideRecord], cells: &[u32], count: usize) -> Vec<f64> {
    let mut radiance: Vec<f64> = records.iter().map(|record| record.radiance).collect();
    for _ in 0..ROUNDS {
        let mut means = vec![(0.0, 0.0); count];
        for (&cell, radiance) in cells.iter().zip(&radiance) {
            let (sum, number) = &mut means[cell as usize];
            (*sum, *number) = (*sum + radiance, *number + 1.0);
        }
        records.par_iter().zip(&mut radiance).for_each(|(record, radiance)| {
            let beyond = record.next.map_or(0.0, |(next, factor)| {
                let (sum, number) = means[cells[next as usize] as usize];
                factor * (sum / number)
            });
            *radiance = record.radiance + beyond;
        });
    }
    radiance
}

/// The relative mean squares of the leaves of a complete binary tree, each bin smoothed by that of the node above.
fn smoothed(leaves: Vec<Sums>) -> Vec<[f64; BINS]> {
    let mut levels = vec![leaves];
    while let Some(level) = levels.last().filter(|level| level.len() > 1) {
        levels.push(level.chunks(2).map(|pair| pair[0].plus(&pair[1])).collect());
    }
    let mut above = vec![[1.0; BINS]];
    for level in levels.iter().rev() {
        let of_node = |(i, sums): (usize, &Sums)| sums.relative_to(&above[(i / 2).min(above.len() - 1)]);
        above = level.iter().enumerate().map(of_node).collect();
    }
    above
}

/// The distribution for these relative mean squares.
fn directions(squares: &[f64; BINS]) -> Directions {
    let guided = normalized(squares.map(f64::sqrt));
    Directions::new(&guided.map(|ratio| COSINE_PART + (1.0 - COSINE_PART) * ratio))
}

/// The values over their mean; ones if that is not above zero.
fn normalized(values: [f64; BINS]) -> [f64; BINS] {
    let mean = values.iter().sum::<f64>() / BINS as f64;
    if mean > 0.0 && mean.is_finite() { values.map(|value| value / mean) } else { [1.0; BINS] }
}

impl Sums {
    const EMPTY: Self = Self { squares: [0.0; BINS], counts: [0.0; BINS] };

    fn add(&mut self, bin: u8, radiance: f64) {
        self.squares[usize::from(bin)] += radiance * radiance;
        self.counts[usize::from(bin)] += 1.0;
    }

    fn plus(&self, other: &Self) -> Self {
        let add = |a: &[f64; BINS], b: &[f64; BINS]| std::array::from_fn(|bin| a[bin] + b[bin]);
        Self { squares: add(&self.squares, &other.squares), counts: add(&self.counts, &other.counts) }
    }

    /// The mean square of each bin over that of all bins. `above` is that of the node above, and stands for [`PRIOR`]
    /// records more.
    fn relative_to(&self, above: &[f64; BINS]) -> [f64; BINS] {
        let mean = self.squares.iter().sum::<f64>() / self.counts.iter().sum::<f64>();
        if !(mean > 0.0 && mean.is_finite()) {
            return *above;
        }
        let of_bin = |bin| (self.squares[bin] / mean + PRIOR * above[bin]) / (self.counts[bin] + PRIOR);
        normalized(std::array::from_fn(of_bin))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::guide::guide_vertex;
    use crate::light::Receiver;
    use glam::{DVec3, Vec3};
    use globillum_material::warp::CosineHemisphere;

    /// The direction of the middle of a bin.
    fn middle(bin: usize) -> DVec3 {
        let sectors = BINS / 4;
        let [ring, sector] = [bin / sectors, bin % sectors].map(|i| i as f64 + 0.5);
        CosineHemisphere::sample([ring / 4.0, sector / sectors as f64])
    }

    /// Vertices on two sides of a line, where light comes from one bin each.
    #[test]
    fn each_cell_follows_its_light() {
        let light = |i: usize| if i.is_multiple_of(2) { 3 } else { 40 };
        let record = |i: usize| GuideRecord {
            vertex: guide_vertex(Receiver {
                position: DVec3::new((i % 2) as f64, (i / 2 % 100) as f64 / 200.0, 0.0),
                normal: Vec3::Z,
            }),
            bin: (i / 2 % BINS) as u8,
            radiance: if i / 2 % BINS == light(i) { 5.0 } else { 0.0 },
            next: None,
        };
        let records: Vec<GuideRecord> = (0..2000 * BINS).map(record).collect();
        let guide = Guide::learn(&records);
        for i in 0..200 {
            let directions = guide.cell(guide.cells(&[records[i].vertex])[0]).directions;
            let ratios: [f64; BINS] = std::array::from_fn(|bin| directions.ratio(middle(bin)));
            assert!(ratios[light(i)] > 0.3 * BINS as f64, "{i}: {ratios:?}");
            assert!(ratios.iter().all(|&ratio| ratio > 0.95 * COSINE_PART), "{i}: {ratios:?}");
        }
    }

    /// Light that reaches the first vertices by way of the second ones only.
    #[test]
    fn light_is_passed_on_from_vertex_to_vertex() {
        let at = |x: f64| guide_vertex(Receiver { position: DVec3::new(x, 0.0, 0.0), normal: Vec3::Z });
        let records: Vec<GuideRecord> = (0..1000)
            .flat_map(|i| {
                let toward_second = i % 2 == 0;
                let next = toward_second.then_some((2 * i + 1, 0.5));
                let bin = if toward_second { 7 } else { 8 };
                let second = GuideRecord { vertex: at(1.0), bin: 0, radiance: 4.0, next: None };
                [GuideRecord { vertex: at(0.0), bin, radiance: 1.0, next }, second]
            })
            .collect();
        let cells: Vec<u32> = records.iter().map(|record| u32::from(record.vertex[0] > 0.5)).collect();
        let radiance = incident(&records, &cells, 2);
        assert_eq!(radiance[..4], [1.0 + 0.5 * 4.0, 4.0, 1.0, 4.0]);
    }

    #[test]
    fn nothing_learned_is_the_cosine() {
        for records in
            [vec![], vec![GuideRecord { vertex: [0.0; 6], bin: 5, radiance: 0.0, next: None }; 600]]
        {
            let guide = Guide::learn(&records);
            let directions = guide.cell(guide.cells(&[[0.0; 6]])[0]).directions;
            assert!((0..BINS).all(|bin| directions.ratio(middle(bin)) == 1.0));
        }
    }
}
