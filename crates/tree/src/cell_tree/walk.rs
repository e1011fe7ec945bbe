//! The ordered traversal: cells front to back, each with the part of the line inside it.

use octray_math::{DVec3, Interval, Ray};

use super::{CellTree, Node};

/// The cells that wait to be visited: working memory, kept from walk to walk.
#[derive(Clone, Debug, Default)]
pub struct WalkStack(Vec<Waiting>);

/// A cell on the way: at most seven siblings wait on every level.
#[derive(Clone, Copy, Debug)]
struct Waiting {
    node: u32,
    min: DVec3,
    size: f64,
    span: Interval,
}

/// The line as the slab test wants it.
struct Slabs {
    origin: DVec3,
    inverse: DVec3,
    parallel: [bool; 3],
    margin: f64,
}

impl Slabs {
    /// The parameters at which the line is between `min` and `min + size` on one axis, grown by the
    /// margin.
    #[inline]
    fn slab(&self, axis: usize, min: f64, size: f64) -> Interval {
        let low = min - self.margin - self.origin[axis];
        let high = min + size + self.margin - self.origin[axis];
        if self.parallel[axis] {
            if low > 0.0 || high < 0.0 {
                return Interval::EMPTY;
            }
            return Interval::ALL;
        }
        let (a, b) = (low * self.inverse[axis], high * self.inverse[axis]);
        Interval::new(a.min(b), a.max(b))
    }

    /// The part of `within` inside the cube grown by the margin.
    fn clip(&self, min: DVec3, size: f64, within: Interval) -> Interval {
        (0..3).fold(within, |span, axis| {
            span.intersection(&self.slab(axis, min[axis], size))
        })
    }

    /// The slabs of a divided cell's lower and upper children on each axis: eight cubes of `size`
    /// share six of them.
    #[inline]
    fn halves(&self, min: DVec3, size: f64) -> [[Interval; 2]; 3] {
        std::array::from_fn(|axis| {
            [min[axis], min[axis] + size].map(|low| self.slab(axis, low, size))
        })
    }
}

impl CellTree {
    /// Visits the occupied cells that the line meets in `within`, front to back.
    ///
    /// `visit` gets the index of the contents and the part of the line inside the cell (grown by
    /// half of [`CellTree::CONTENT_MARGIN`]); it returns the parameter beyond which nothing
    /// matters any more: cells that begin later are not visited. Returns how many cells were
    /// entered.
    pub fn walk(
        &self,
        ray: &Ray,
        within: Interval,
        stack: &mut WalkStack,
        mut visit: impl FnMut(u32, Interval) -> f64,
    ) -> u64 {
        let d = ray.direction;
        let slabs = Slabs {
            origin: ray.origin,
            inverse: d.recip(),
            // A reciprocal that overflows is as good as parallel: the line leaves the slab beyond
            // any parameter that matters.
            parallel: d.to_array().map(|x| !x.recip().is_finite()),
            margin: self.root.size().x * (0.5 * Self::CONTENT_MARGIN),
        };
        let mirror = u32::from(d.x < 0.0) | u32::from(d.y < 0.0) << 1 | u32::from(d.z < 0.0) << 2;
        let mut limit = within.end;
        let mut entered = 0;
        let span = slabs.clip(self.root.min, self.root.size().x, within);
        if span.is_empty() {
            return 0;
        }
        let WalkStack(stack) = stack;
        stack.clear();
        stack.push(Waiting {
            node: self.root_node,
            min: self.root.min,
            size: self.root.size().x,
            span,
        });
        while let Some(cell) = stack.pop() {
            if cell.span.start > limit {
                continue;
            }
            entered += 1;
            match Node::decode(cell.node) {
                Node::Empty(_) => {}
                Node::Occupied(leaf) => limit = limit.min(visit(leaf, cell.span)),
                Node::Divided(block) => {
                    let size = cell.size * 0.5;
                    let children = &self.blocks[block as usize];
                    let [x, y, z] = slabs.halves(cell.min, size);
                    // The farthest octant is pushed first.
                    for i in (0..8).rev() {
                        let octant = i ^ mirror;
                        let node = children[octant as usize];
                        if matches!(Node::decode(node), Node::Empty(_)) {
                            continue;
                        }
                        let upper = [octant & 1, octant >> 1 & 1, octant >> 2 & 1];
                        let span = cell
                            .span
                            .intersection(&x[upper[0] as usize])
                            .intersection(&y[upper[1] as usize])
                            .intersection(&z[upper[2] as usize]);
                        if !span.is_empty() {
                            let min = cell.min + DVec3::from_array(upper.map(f64::from)) * size;
                            stack.push(Waiting {
                                node,
                                min,
                                size,
                                span,
                            });
                        }
                    }
                }
            }
        }
        entered
    }
}
