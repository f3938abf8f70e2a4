//! Eight rays that go the same way, searched for together: a node is looked at once for all.

use super::WideKdTree;
use super::candidates::Candidates;
use super::course::Course;
use super::filter::{Filtered, Rays, Vertices, filter};
use super::goal::Goal;
use super::node::{Child, FIRST_CELL};
use super::simd::{LANES, Rows, Simd};
use crate::Ray;
use crate::decide::main_axis;
use crate::prune::PARALLEL;
use crate::search::Closest;
use glam::DVec3;

/// Most entries of the stack: one that each plane above a leaf leaves behind.
const STACK: usize = 104;

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
    t_end: Lanes,
    /// The axes x, y and z of all rays.
    axes: [usize; 3],
    /// For each axis, whether the rays descend along it.
    down: [bool; 3],
    candidates: [Candidates; LANES],
    /// Node, and place in it in heap order.
    places: [(u32, usize); STACK],
    starts: [Lanes; STACK],
    ends: [Lanes; STACK],
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
pub(super) fn is_coherent(rays: &[Ray]) -> bool {
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
            t_end: zero,
            axes: [0; 3],
            down: [false; 3],
            candidates: [Candidates::default(); LANES],
            places: [(0, 0); STACK],
            starts: [zero; STACK],
            ends: [zero; STACK],
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
        for (lane, ray) in rays.iter().enumerate() {
            searches[lane] = Closest::begin(ray);
            match Course::new(ray, &tree.triangles.bounds(), &tree.space) {
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
        (self.starts[0][lane], self.ends[0][lane]) = (start, end);
        self.candidates[lane].clear();
    }

    #[inline(always)]
    fn begin(&mut self, any: &Ray) {
        let (down, z) = way(any);
        self.axes = [(z + 1) % 3, (z + 2) % 3, z];
        self.down = [0, 1, 2].map(|axis| down >> axis & 1 == 1);
        self.places[0] = (Child::ROOT, 0);
    }

    /// Front to back, a binary tree again: a plane either parts the rays' cells or does not.
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
            let (mut node, mut place) = self.places[depth];
            let mut start = simd.load(&self.starts[depth]);
            let mut end = simd.min(simd.load(&self.ends[depth]), simd.load(&self.t_end));
            if simd.le(start, end) == 0 {
                continue;
            }
            loop {
                let at = &tree.nodes[node as usize];
                if place >= FIRST_CELL {
                    let child = at.children[(place - FIRST_CELL) % LANES];
                    if child == Child::EMPTY {
                        break;
                    }
                    if Child::is_block(child) == 1 {
                        self.open(simd, tree, child, rays, searches);
                        break;
                    }
                    (node, place) = (child, 0);
                    continue;
                }
                let axis = at.axis(place);
                let plane = simd.splat(at.planes[place]);
                let inverse = simd.load(&self.inverse[axis]);
                let early = simd.mul_add(plane, inverse, simd.load(&self.near[axis]));
                let late = simd.mul_add(plane, inverse, simd.load(&self.far[axis]));
                let far_start = simd.max(early, start);
                let near_end = simd.min(late, end);
                let (meets_near, meets_far) = (simd.le(start, near_end) != 0, simd.le(far_start, end) != 0);
                let down = usize::from(self.down[axis]);
                let (near, far) = (2 * place + 1 + down, 2 * place + 2 - down);
                if meets_near && meets_far {
                    self.places[depth] = (node, far);
                    simd.store(&mut self.starts[depth], far_start);
                    simd.store(&mut self.ends[depth], end);
                    depth += 1;
                }
                if meets_near {
                    (place, end) = (near, near_end);
                } else if meets_far {
                    (place, start) = (far, far_start);
                } else {
                    break;
                }
            }
        }
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
