//! Eight rays that go the same way, searched for together: a node is looked at once for all.

use super::WideKdTree;
use super::candidates::Candidates;
use super::course::{Course, Courses};
use super::filter::{Filtered, Rays, Vertices, filter};
use super::goal::Goal;
use super::node::{Child, Node};
use super::simd::{LANES, Rows, Simd};
use crate::Ray;
use crate::decide::main_axis;
use crate::prune::PARALLEL;
use crate::search::Closest;
use glam::DVec3;

/// Most entries of the stack: 7 that each of 70 levels leaves behind, and one more.
const STACK: usize = 492;

/// One number a ray.
type Lanes = [f32; LANES];

/// Rays number by number, and the cells that are still to be visited for some of them.
#[derive(Debug)]
pub(super) struct Packet {
    inverse: [Lanes; 3],
    near: [Lanes; 3],
    far: [Lanes; 3],
    slope: [Lanes; 2],
    offset: [Lanes; 2],
    depth_scale: Lanes,
    depth_offset: Lanes,
    edge_err: [Lanes; 2],
    t_err: Lanes,
    certain_end: Lanes,
    start: Lanes,
    t_end: Lanes,
    /// The axes x, y and z of all rays.
    axes: [usize; 3],
    /// The axes along which the rays descend, a bit each.
    octant: u8,
    candidates: [Candidates; LANES],
    children: [u32; STACK],
    starts: [Lanes; STACK],
}

/// The axes along which a ray descends, a bit each, and its main axis: rays of which these are the
/// same cross planes in the same order.
fn way(ray: &Ray) -> (u32, usize) {
    let main = main_axis(ray.direction);
    // As the pruner has it, where a component that is almost zero is positive.
    let smallest = PARALLEL * ray.direction[main].abs();
    (ray.direction.cmple(DVec3::splat(-smallest)).bitmask(), main)
}

/// Whether the rays go the same way.
pub(super) fn is_coherent(rays: &[Ray; LANES]) -> bool {
    rays.windows(2).all(|pair| way(&pair[0]) == way(&pair[1]))
}

impl Packet {
    pub(super) fn idle() -> Self {
        let zero = [0.0; LANES];
        Self {
            inverse: [zero; 3],
            near: [zero; 3],
            far: [zero; 3],
            slope: [zero; 2],
            offset: [zero; 2],
            depth_scale: zero,
            depth_offset: zero,
            edge_err: [zero; 2],
            t_err: zero,
            certain_end: zero,
            start: zero,
            t_end: zero,
            axes: [0; 3],
            octant: 0,
            candidates: [Candidates::default(); LANES],
            children: [Child::ROOT; STACK],
            starts: [zero; STACK],
        }
    }

    /// The closest hits of `rays`, which are coherent.
    #[inline(always)]
    pub(super) fn search<S: Simd>(
        &mut self,
        simd: S,
        tree: &WideKdTree,
        rays: &[Ray; LANES],
    ) -> [Closest; LANES] {
        let mut searches = [Closest::begin(&rays[0]); LANES];
        let mut any = false;
        let courses = Courses::new(rays, &tree.triangles.bounds(), &tree.space);
        for (lane, ray) in rays.iter().enumerate() {
            searches[lane] = Closest::begin(ray);
            match courses.get(lane) {
                Some(course) => {
                    self.set(lane, &course, course.start, course.end);
                    any = true;
                }
                // Meets nothing, since it ends before it starts.
                None => self.set(lane, &Course::default(), f32::INFINITY, f32::NEG_INFINITY),
            }
        }
        if any {
            self.begin(&rays[0]);
            self.traverse(simd, tree, rays, &mut searches);
            for (lane, ray) in rays.iter().enumerate() {
                let t_end = self.t_end[lane];
                self.candidates[lane].decide(t_end, ray, &tree.triangles, &mut searches[lane]);
            }
        }
        searches
    }

    #[inline(always)]
    fn set(&mut self, lane: usize, course: &Course, start: f32, end: f32) {
        for axis in 0..3 {
            self.inverse[axis][lane] = course.inverse[axis];
            self.near[axis][lane] = course.near[axis];
            self.far[axis][lane] = course.far[axis];
        }
        for i in 0..2 {
            self.slope[i][lane] = course.slope[i];
            self.offset[i][lane] = course.offset[i];
            self.edge_err[i][lane] = course.edge_err[i];
        }
        self.depth_scale[lane] = course.depth_scale;
        self.depth_offset[lane] = course.depth_offset;
        self.t_err[lane] = course.t_err;
        self.certain_end[lane] = course.certain_end;
        self.t_end[lane] = end;
        self.start[lane] = start;
        self.starts[0][lane] = start;
        self.candidates[lane].clear();
    }

    #[inline(always)]
    fn begin(&mut self, any: &Ray) {
        let (down, z) = way(any);
        self.axes = [(z + 1) % 3, (z + 2) % 3, z];
        self.octant = down as u8;
        self.children[0] = Child::ROOT;
    }

    /// Visits cells front to back, as long as any ray meets them.
    #[inline(always)]
    fn traverse<S: Simd>(
        &mut self,
        simd: S,
        tree: &WideKdTree,
        rays: &[Ray; LANES],
        searches: &mut [Closest; LANES],
    ) {
        let mut depth = 1;
        while depth > 0 {
            depth -= 1;
            let start = simd.load(&self.starts[depth]);
            if simd.le(start, simd.load(&self.t_end)) == 0 {
                continue;
            }
            let child = self.children[depth];
            if Child::is_block(child) == 1 {
                self.open(simd, tree, child, rays, searches);
                continue;
            }
            let node = &tree.nodes[child as usize];
            let order = node.orders[usize::from(self.octant & 7)];
            for i in (0..LANES).rev() {
                let lane = (order >> (3 * i)) as usize % LANES;
                let (start, met) = self.meet(simd, node, lane);
                if met {
                    simd.store(&mut self.starts[depth], start);
                    self.children[depth] = node.children[lane];
                    depth += 1;
                }
            }
        }
    }

    /// Where the rays enter one of a node's boxes, and whether any does.
    #[inline(always)]
    fn meet<S: Simd>(&self, simd: S, node: &Node, lane: usize) -> (S::F, bool) {
        let mut start = simd.load(&self.start);
        let mut end = simd.load(&self.t_end);
        for axis in 0..3 {
            let [enter, leave] = node.slabs(axis, self.octant);
            let inverse = simd.load(&self.inverse[axis]);
            start =
                simd.max(simd.mul_add(simd.splat(enter[lane]), inverse, simd.load(&self.near[axis])), start);
            end = simd.min(simd.mul_add(simd.splat(leave[lane]), inverse, simd.load(&self.far[axis])), end);
        }
        (start, simd.le(start, end) != 0)
    }

    /// All triangles of a block.
    #[inline(always)]
    fn open<S: Simd>(
        &mut self,
        simd: S,
        tree: &WideKdTree,
        block: u32,
        rays: &[Ray; LANES],
        searches: &mut [Closest; LANES],
    ) {
        let (first, count) = Child::block(block);
        let rows = tree.blocks.rows(first, count);
        for triangle in 0..count {
            let found = self.filter(simd, rows, triangle);
            if found.possible == 0 {
                continue;
            }
            let mut starts = [0.0; LANES];
            simd.store(&mut starts, found.start);
            let t_end = simd.load(&self.t_end);
            simd.store(&mut self.t_end, simd.choose_by(found.certain, simd.min(found.end, t_end), t_end));
            let index = tree.blocks.index(first, triangle);
            for lane in (0..LANES).filter(|lane| found.possible >> lane & 1 == 1) {
                let candidates = &mut self.candidates[lane];
                candidates.add(starts[lane], index);
                if candidates.is_full() {
                    candidates.decide(self.t_end[lane], &rays[lane], &tree.triangles, &mut searches[lane]);
                }
            }
        }
    }

    /// One triangle and all rays.
    #[inline(always)]
    fn filter<S: Simd>(&self, simd: S, rows: Rows<'_>, triangle: usize) -> Filtered<S> {
        let rays = Rays {
            slope: [simd.load(&self.slope[0]), simd.load(&self.slope[1])],
            offset: [simd.load(&self.offset[0]), simd.load(&self.offset[1])],
            depth_scale: simd.load(&self.depth_scale),
            depth_offset: simd.load(&self.depth_offset),
            edge_err: [simd.load(&self.edge_err[0]), simd.load(&self.edge_err[1])],
            t_err: simd.load(&self.t_err),
            certain_end: simd.load(&self.certain_end),
            t_end: simd.load(&self.t_end),
        };
        let [x, y, z] = [rows.along(self.axes[0]), rows.along(self.axes[1]), rows.along(self.axes[2])];
        let lane = triangle % LANES;
        let vertices = Vertices {
            x: [simd.splat(x[0][lane]), simd.splat(x[1][lane]), simd.splat(x[2][lane])],
            y: [simd.splat(y[0][lane]), simd.splat(y[1][lane]), simd.splat(y[2][lane])],
            z: [simd.splat(z[0][lane]), simd.splat(z[1][lane]), simd.splat(z[2][lane])],
        };
        filter::<S, true>(simd, &rays, &vertices)
    }
}
