//! A step through nodes: eight cells' intervals at once, a few rays side by side.

use super::node::{Child, Node};
use super::simd::{LANES, Simd};
use super::trace::Trace;

/// For the directions' signs at seven planes, the cells from far to near.
static ORDER: [[u8; LANES]; 128] = order();

const fn order() -> [[u8; LANES]; 128] {
    let mut table = [[0; LANES]; 128];
    let mut signs = 0;
    while signs < 128 {
        let mut lane = 0;
        while lane < LANES {
            let mut plane = 0;
            let mut level = 0;
            while level < 3 {
                let near = lane >> (2 - level) & 1;
                // Going down, the upper side is near.
                let down = signs >> plane & 1;
                plane = 2 * plane + 1 + (near ^ down ^ 1);
                level += 1;
            }
            table[signs][lane] = plane as u8 - 7;
            lane += 1;
        }
        signs += 1;
    }
    table
}

/// Takes the nearest node of each of the traces at `slots`, and pushes those of its cells that
/// the ray meets.
///
/// Stage by stage over all of them: a step is one long chain of dependent instructions, and the
/// processor looks only so far ahead for others to do meanwhile.
#[inline(always)]
pub(super) fn step<S: Simd, const RAYS: usize>(
    simd: S,
    nodes: &[Node],
    traces: &mut [Trace],
    slots: [usize; RAYS],
) {
    let zero = simd.splat(0.0);
    let mut node = [0; RAYS];
    let (mut start, mut end) = ([zero; RAYS], [zero; RAYS]);
    let (mut early, mut late) = ([zero; RAYS], [zero; RAYS]);
    let mut cells = [simd.splat_i(0); RAYS];
    let mut mask = [0; RAYS];
    for i in 0..RAYS {
        let trace = &mut traces[slots[i]];
        let (child, first, last) = trace.pop();
        node[i] = child as usize;
        start[i] = simd.splat(first);
        end[i] = simd.splat(if last < trace.t_end { last } else { trace.t_end });
        let node = &nodes[node[i]];
        let axes = simd.shift_by_lane(simd.splat_i(node.axes()));
        let inverse = simd.permute_four(simd.load_twice(&trace.course.inverse), axes);
        let near = simd.permute_four(simd.load_twice(&trace.course.near), axes);
        let far = simd.permute_four(simd.load_twice(&trace.course.far), axes);
        let planes = simd.load(&node.planes);
        early[i] = simd.mul_add(planes, inverse, near);
        late[i] = simd.mul_add(planes, inverse, far);
        cells[i] = simd.widen(&ORDER[usize::from(simd.signs(inverse) & 0x7f)]);
    }
    for i in 0..RAYS {
        // The near side of a plane ends at it, late; the far side starts there, early.
        let top = simd.permute_mixed::<0xf0>(early[i], late[i], simd.load_i(&[0, 0, 0, 0, 8, 8, 8, 8]));
        start[i] = simd.choose::<0x0f>(simd.max(top, start[i]), start[i]);
        end[i] = simd.choose::<0xf0>(simd.min(top, end[i]), end[i]);
    }
    for i in 0..RAYS {
        let grandparent = simd.add_i(simd.shift::<2>(cells[i]), simd.load_i(&[1, 1, 9, 9, 1, 1, 9, 9]));
        let middle = simd.permute_mixed::<0xcc>(early[i], late[i], grandparent);
        start[i] = simd.choose::<0x33>(simd.max(middle, start[i]), start[i]);
        end[i] = simd.choose::<0xcc>(simd.min(middle, end[i]), end[i]);
    }
    for i in 0..RAYS {
        let parent = simd.add_i(simd.shift::<1>(cells[i]), simd.load_i(&[3, 11, 3, 11, 3, 11, 3, 11]));
        let bottom = simd.permute_mixed::<0xaa>(early[i], late[i], parent);
        start[i] = simd.choose::<0x55>(simd.max(bottom, start[i]), start[i]);
        end[i] = simd.choose::<0xaa>(simd.min(bottom, end[i]), end[i]);
    }
    for i in 0..RAYS {
        cells[i] = simd.permute_i(simd.load_i(&nodes[node[i]].children), cells[i]);
        mask[i] = simd.le(start[i], end[i]) & simd.ne_i(cells[i], simd.splat_i(Child::EMPTY));
    }
    for i in 0..RAYS {
        traces[slots[i]].push(simd, start[i], end[i], cells[i], mask[i]);
    }
}
