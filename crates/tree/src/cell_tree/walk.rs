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
        // Finite times finite: no NaN, so a plain comparison does, here and below.
        let (a, b) = (low * self.inverse[axis], high * self.inverse[axis]);
        if a < b {
            Interval::new(a, b)
        } else {
            Interval::new(b, a)
        }
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
        let both = |axis: usize| {
            [
                self.slab(axis, min[axis], size),
                self.slab(axis, min[axis] + size, size),
            ]
        };
        [both(0), both(1), both(2)]
    }
}

/// The common part of two intervals without NaN, `None` if they have none.
#[inline]
fn common(a: &Interval, b: &Interval) -> Option<Interval> {
    let start = if a.start > b.start { a.start } else { b.start };
    let end = if a.end < b.end { a.end } else { b.end };
    (start <= end).then_some(Interval { start, end })
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
        let mirror = d.to_array().map(|x| usize::from(x < 0.0));
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
                    // The farthest octant is pushed first; a half that the line misses takes its
                    // octants along.
                    for k in [1, 0].map(|far| far ^ mirror[2]) {
                        let Some(in_z) = common(&cell.span, &z[k]) else {
                            continue;
                        };
                        for j in [1, 0].map(|far| far ^ mirror[1]) {
                            let Some(in_zy) = common(&in_z, &y[j]) else {
                                continue;
                            };
                            for i in [1, 0].map(|far| far ^ mirror[0]) {
                                let node = children[i | j << 1 | k << 2];
                                if matches!(Node::decode(node), Node::Empty(_)) {
                                    continue;
                                }
                                let Some(span) = common(&in_zy, &x[i]) else {
                                    continue;
                                };
                                let upper = DVec3::new(i as f64, j as f64, k as f64);
                                let min = cell.min + upper * size;
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
        }
        entered
    }
}
