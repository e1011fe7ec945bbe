//! The ordered traversal: cells front to back, each with the part of the line inside it.

use octray_math::{DVec3, Interval, Ray};

use super::{CellTree, Node};

/// The cells that wait to be visited: working memory, kept from walk to walk.
#[derive(Clone, Debug, Default)]
pub struct WalkStack(pub(crate) Vec<Waiting>);

/// A cell on the way: at most seven siblings wait on every level.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Waiting {
    pub(crate) node: u32,
    pub(crate) min: DVec3,
    pub(crate) size: f64,
    pub(crate) span: Interval,
}

/// The line as the slab test wants it.
pub(crate) struct Slabs {
    origin: DVec3,
    inverse: DVec3,
    parallel: [bool; 3],
    /// Whether the line goes down the axis.
    backward: [bool; 3],
    margin: f64,
}

/// The larger of two numbers, and the smaller, where neither is NaN: one instruction each.
#[inline]
fn later(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

#[inline]
fn earlier(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

impl Slabs {
    /// For the cells of a cube of this size.
    #[inline]
    pub(crate) fn new(ray: &Ray, root_size: f64) -> Self {
        let d = ray.direction;
        Self {
            origin: ray.origin,
            inverse: d.recip(),
            // A reciprocal that overflows is as good as parallel: the line leaves the slab beyond
            // any parameter that matters.
            parallel: d.to_array().map(|x| !x.recip().is_finite()),
            backward: d.to_array().map(|x| x < 0.0),
            margin: root_size * (0.5 * CellTree::CONTENT_MARGIN),
        }
    }

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
        if self.backward[axis] {
            Interval::new(b, a)
        } else {
            Interval::new(a, b)
        }
    }

    /// The part of `within` inside the cube grown by the margin.
    pub(crate) fn clip(&self, min: DVec3, size: f64, within: Interval) -> Interval {
        (0..3).fold(within, |span, axis| {
            span.intersection(&self.slab(axis, min[axis], size))
        })
    }

    /// The slabs of a divided cell's halves on one axis, each with the number of the half, the one
    /// that the line enters last first.
    #[inline]
    fn halves(&self, axis: usize, min: f64, size: f64) -> [Half; 2] {
        let half = |upper: usize| {
            let min = if upper == 1 { min + size } else { min };
            let Interval { start, end } = self.slab(axis, min, size);
            Half {
                start,
                end,
                min,
                upper,
            }
        };
        let near = usize::from(self.backward[axis]);
        [half(1 - near), half(near)]
    }
}

/// Half of a divided cell on one axis.
#[derive(Clone, Copy)]
struct Half {
    /// Where the line enters and leaves it.
    start: f64,
    end: f64,
    /// Its lower side.
    min: f64,
    upper: usize,
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
        let slabs = Slabs::new(ray, self.root.size().x);
        let mut limit = within.end;
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
        self.walk_down(&slabs, stack, &mut limit, &mut visit)
    }

    /// Visits the occupied cells below those that wait, front to back; returns how many cells were
    /// entered.
    #[inline]
    pub(crate) fn walk_down(
        &self,
        slabs: &Slabs,
        stack: &mut Vec<Waiting>,
        limit: &mut f64,
        visit: &mut impl FnMut(u32, Interval) -> f64,
    ) -> u64 {
        let mut entered = 0;
        while let Some(cell) = stack.pop() {
            if cell.span.start > *limit {
                continue;
            }
            entered += 1;
            match Node::decode(cell.node) {
                Node::Empty(_) => {}
                Node::Occupied(leaf) => *limit = limit.min(visit(leaf, cell.span)),
                Node::Divided(block) => {
                    let size = cell.size * 0.5;
                    let children = &self.blocks[block as usize];
                    let x = slabs.halves(0, cell.min.x, size);
                    let y = slabs.halves(1, cell.min.y, size);
                    let z = slabs.halves(2, cell.min.z, size);
                    // Which octants the line meets nobody can guess, so all are decided without
                    // a branch. Octants are numbered from the last that the line enters.
                    let mut spans = [Interval::EMPTY; 8];
                    let mut met = 0_u32;
                    for octant in 0..8 {
                        let (x, y, z) = (&x[octant & 1], &y[octant >> 1 & 1], &z[octant >> 2]);
                        let start = later(later(cell.span.start, z.start), later(y.start, x.start));
                        let end = earlier(earlier(cell.span.end, z.end), earlier(y.end, x.end));
                        let node = children[x.upper | y.upper << 1 | z.upper << 2];
                        spans[octant] = Interval { start, end };
                        let is_met = (start <= end) & !Node::is_empty(node);
                        met |= u32::from(is_met) << octant;
                    }
                    while met != 0 {
                        let octant = met.trailing_zeros() as usize;
                        met &= met - 1;
                        let (x, y, z) = (&x[octant & 1], &y[octant >> 1 & 1], &z[octant >> 2]);
                        stack.push(Waiting {
                            node: children[x.upper | y.upper << 1 | z.upper << 2],
                            min: DVec3::new(x.min, y.min, z.min),
                            size,
                            span: spans[octant],
                        });
                    }
                }
            }
        }
        entered
    }
}
