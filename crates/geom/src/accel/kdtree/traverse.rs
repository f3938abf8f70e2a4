use super::tree::{KdTree, Node};
use crate::accel::by_query::traverse_by_query;
use crate::accel::prune::{Pruner, Span};
use crate::accel::query::{Query, offer_all};
use crate::decide::Shear;
use crate::{QueryCounter, Ray, Traverse};
use arrayvec::ArrayVec;

/// A stack entry: a node to visit, and the ray's span within its widened cell.
struct Pending {
    node: u32,
    span: Span,
}

impl Traverse for KdTree {
    traverse_by_query!();
}

impl KdTree {
    /// Runs `query` along `ray`.
    ///
    /// Visits cells front to back (Havran 2000). Planes are widened by the pruning slack, so a ray near a
    /// plane visits both sides.
    fn query<Q: Query, C: QueryCounter>(&self, ray: &Ray, mut query: Q, counter: &mut C) -> Q {
        if let Some(shear) = Shear::new(ray) {
            let bounds = self.triangles.bounds();
            if !bounds.is_empty() {
                let pruner = Pruner::new(ray, &bounds);
                let span = pruner.clip(ray, &bounds);
                self.traverse(ray, &shear, &pruner, span, &mut query, counter);
            }
        }
        query
    }

    fn traverse<Q: Query, C: QueryCounter>(
        &self,
        ray: &Ray,
        shear: &Shear,
        pruner: &Pruner,
        span: Span,
        query: &mut Q,
        counter: &mut C,
    ) {
        // Each level pushes at most one node, so the stack cannot overflow.
        let mut pending = ArrayVec::<Pending, { KdTree::MAX_DEPTH as usize + 1 }>::new();
        pending.push(Pending { node: 0, span });
        while let Some(Pending { mut node, mut span }) = pending.pop() {
            while span.start <= span.end.min(query.t_end()) {
                match self.nodes[node as usize] {
                    Node::Leaf { first, count } => {
                        if count > 0 {
                            counter.open();
                        }
                        let listed = &self.references[first as usize..][..count as usize];
                        offer_all(ray, shear, &self.triangles, listed.iter().copied(), query, counter);
                        break;
                    }
                    Node::Split { axis, position, upper } => {
                        counter.visit();
                        let axis = usize::from(axis);
                        let distance = f64::from(position) - pruner.origin[axis];
                        let forward = pruner.direction[axis] > 0.0;
                        let (near, far) = if forward { (node + 1, upper) } else { (upper, node + 1) };
                        let far_start = span.start.max(pruner.crossing(axis, distance, false));
                        if far_start <= span.end {
                            pending.push(Pending { node: far, span: Span { start: far_start, ..span } });
                        }
                        node = near;
                        span.end = span.end.min(pruner.crossing(axis, distance, true));
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Triangles;
    use crate::accel::query::ClosestHit;
    use crate::conformance::shapes::statue;
    use crate::conformance::{Seeded, Source};
    use glam::DVec3;

    /// Counts the inner nodes and non-empty leaves visited.
    #[derive(Default)]
    struct Visits(u64);

    impl QueryCounter for Visits {
        fn visit(&mut self) {
            self.0 += 1;
        }
        fn open(&mut self) {
            self.0 += 1;
        }
    }

    /// The visits along `ray`, with the pruning slack multiplied by `factor`.
    fn visits(tree: &KdTree, ray: &Ray, factor: f64) -> u64 {
        let bounds = tree.triangles.bounds();
        let shear = Shear::new(ray).expect("the ray is traceable");
        let mut pruner = Pruner::new(ray, &bounds);
        pruner.slack *= factor;
        let (mut query, mut visits) = (ClosestHit::new(ray), Visits::default());
        tree.traverse(ray, &shear, &pruner, pruner.clip(ray, &bounds), &mut query, &mut visits);
        visits.0
    }

    #[test]
    fn slack_makes_ordinary_rays_visit_no_more_nodes() {
        let triangles = Triangles::new(statue(20_000).triangles()).expect("a valid mesh");
        let tree = KdTree::build(&triangles).expect("valid options");
        let mut source = Seeded::new(0);
        let mut point = || DVec3::new(source.signed(), source.signed(), source.signed());
        let (mut with, mut without) = (0, 0);
        for i in 0..40_000 {
            // Half the rays start at one point, like camera rays; half at random points, like bounce rays.
            let origin = if i % 2 == 0 { DVec3::new(0.3, 0.5, 3.0) } else { point() };
            let ray = Ray::new(origin, point() - origin);
            with += visits(&tree, &ray, 1.0);
            without += visits(&tree, &ray, 0.0);
        }
        assert_eq!(with, without);
    }
}
