//! What lies in a part of space.

use octray_math::Aabb;

use super::{MAX_DEPTH, WideTree, link};

impl WideTree {
    /// Whether `visit` is true of any item whose box overlaps `region` (which may be unbounded);
    /// stops at the first. Some items whose boxes only come close are shown as well, and items in
    /// several leaves perhaps more than once.
    pub fn any_overlapping(&self, region: &Aabb, mut visit: impl FnMut(u32) -> bool) -> bool {
        if self.nodes.is_empty() || region.is_empty() {
            return false;
        }
        // Rounding keeps order, so boxes that overlap do so in these coordinates, too.
        let region = self.frame.outward(region);
        let mut pending = Vec::with_capacity(7 * MAX_DEPTH as usize + 8);
        pending.push(link::node(0));
        while let Some(part) = pending.pop() {
            if let Some(items) = link::items(part) {
                if self.items[items].iter().any(|&item| visit(item)) {
                    return true;
                }
                continue;
            }
            let node = &self.nodes[part as usize];
            let planes = &node.boxes.planes;
            for (lane, &child) in node.links.iter().enumerate() {
                let overlaps = (0..3).all(|axis| {
                    planes[axis][lane] <= region.max[axis]
                        && planes[axis + 3][lane] >= region.min[axis]
                });
                // An empty slot overlaps all of space only with infinities, and holds nothing.
                if overlaps && planes[0][lane] <= planes[3][lane] {
                    pending.push(child);
                }
            }
        }
        false
    }
}
