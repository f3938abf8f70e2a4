use super::facets::{connected, neighbours};
use super::light_bounds::LightBounds;
use super::triangle_map::TriangleMap;
use crate::light::alias_table::{AliasTable, raised};
use crate::light::lights::Lights;
use glam::DVec3;
use globillum_geom::Triangles;

/// Area lights in a few groups, each of which is chosen by its power, [raised] for a dim one.
#[derive(Clone, Debug)]
pub(super) struct LightClusters {
    clusters: Vec<Cluster>,
    by_power: AliasTable,
    /// The cluster of each light triangle.
    cluster_of: TriangleMap,
}

/// A group of lights, with the probability of choosing it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cluster {
    pub(super) bounds: LightBounds,
    pub(super) prob: f64,
}

impl LightClusters {
    /// The most clusters.
    const MAX_CLUSTERS: usize = 64;

    /// Of one or more area lights. Triangles that share an edge are in one cluster.
    pub(super) fn of(triangles: &Triangles, lights: &Lights) -> Self {
        let emitting: Vec<_> = lights.triangles().collect();
        let powers: Vec<_> = lights.area_powers().collect();
        let mut groups = connected(&neighbours(triangles, &emitting), |_, _| true, 0..emitting.len() as u32);
        let bounds =
            |group: &[u32]| LightBounds::around(triangles, group.iter().map(|&i| emitting[i as usize]));
        if groups.len() > Self::MAX_CLUSTERS {
            let mut centered: Vec<_> =
                groups.into_iter().map(|group| (bounds(&group).center, group)).collect();
            groups = Vec::new();
            halve(&mut centered, Self::MAX_CLUSTERS, &mut groups);
        }
        let power = |group: &Vec<u32>| group.iter().map(|&i| powers[i as usize]).sum::<f64>();
        let weights = raised(groups.iter().map(power).collect());
        let total: f64 = weights.iter().sum();
        let cluster =
            |(group, weight): (&Vec<u32>, &f64)| Cluster { bounds: bounds(group), prob: weight / total };
        let clusters = groups.iter().zip(&weights).map(cluster).collect();
        let members =
            (0..).zip(&groups).flat_map(|(cluster, group)| group.iter().map(move |&i| (i, cluster)));
        let cluster_of = TriangleMap::new(members.map(|(i, cluster)| (emitting[i as usize], cluster)));
        Self { clusters, by_power: AliasTable::new(&weights), cluster_of }
    }

    /// The cluster of the light triangle `index`.
    pub(super) fn of_light(&self, index: u32) -> Option<u32> {
        self.cluster_of.get(index)
    }

    pub(super) fn len(&self) -> usize {
        self.clusters.len()
    }

    /// Chooses a cluster by `u` in `[0, 1)`: its index, and what is left of `u`, which is uniform too.
    pub(super) fn choose(&self, u: f64) -> (u32, f64) {
        let chosen = if self.clusters.len() > 1 { self.by_power.sample_remapped(u) } else { None };
        chosen.map_or((0, u), |(index, rest)| (index as u32, rest))
    }

    pub(super) fn get(&self, index: u32) -> Cluster {
        self.clusters[index as usize]
    }
}

/// Joins groups, each with its center, into at most `count`.
fn halve(groups: &mut [(DVec3, Vec<u32>)], count: usize, joined: &mut Vec<Vec<u32>>) {
    if count == 1 || groups.len() == 1 {
        joined.push(groups.iter().flat_map(|(_, group)| group.iter().copied()).collect());
        return;
    }
    let min = groups.iter().fold(DVec3::INFINITY, |min, (center, _)| min.min(*center));
    let max = groups.iter().fold(DVec3::NEG_INFINITY, |max, (center, _)| max.max(*center));
    let axis = (max - min).max_position();
    groups.sort_by(|(a, _), (b, _)| a[axis].total_cmp(&b[axis]));
    let (before, after) = groups.split_at_mut(groups.len() / 2);
    halve(before, count / 2, joined);
    halve(after, count / 2, joined);
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use globillum_geom::Triangle;
    use globillum_material::{Emission, Rgb, Sides};

    /// Of a lamp and a sun of 1e30 times its power, which are clusters of their own.
    #[test]
    fn a_dim_cluster_is_chosen_with_the_probability_that_it_states() {
        let triangle = Triangle::new(Vec3::ZERO, Vec3::X, Vec3::Z);
        let far = Triangle { vertices: triangle.vertices.map(|v| v + 100.0) };
        let triangles = Triangles::new(vec![triangle, far]).unwrap();
        let emission = |index| {
            let radiance = if index == 0 { 1e-15 } else { 1e15 };
            Emission::new(Rgb::splat(radiance), Sides::Front).unwrap()
        };
        let clusters = LightClusters::of(&triangles, &Lights::of(&triangles, emission, &[]));
        let lamp = clusters.of_light(0).unwrap();
        let numbers = (0..10_000).map(|i| (f64::from(i) + 0.5) / 10_000.0);
        let share = numbers.filter(|&u| clusters.choose(u).0 == lamp).count() as f64 / 10_000.0;
        let prob = clusters.get(lamp).prob;
        assert_eq!(clusters.len(), 2);
        assert!(prob > 0.007 && (share - prob).abs() < 2e-4, "{share}, {prob}");
    }
}
