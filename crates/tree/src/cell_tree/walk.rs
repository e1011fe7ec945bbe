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
    /// Infinite where the line is parallel to the slab, or so nearly that it leaves it beyond any
    /// parameter that matters.
    inverse: DVec3,
    /// By how much cells are grown on every side.
    margin: f64,
    /// The same, negative on the axes that the line goes down.
    ahead: DVec3,
    /// A bit for each of those axes.
    flip: usize,
}

/// For each axis the octants of a divided cell that lie in the half which the line enters first;
/// octants are numbered from the first that it enters.
const NEAR: [u32; 3] = [0b0101_0101, 0b0011_0011, 0b0000_1111];
const ALL: u32 = 0b1111_1111;

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
        let inverse = ray.direction.recip();
        let margin = root_size * (0.5 * CellTree::CONTENT_MARGIN);
        Self {
            origin: ray.origin,
            inverse,
            margin,
            ahead: DVec3::splat(margin).copysign(inverse),
            flip: inverse.is_negative_bitmask() as usize,
        }
    }

    /// The parameters at which the line is between `min` and `min + size` on one axis, grown by the
    /// margin.
    #[inline]
    fn slab(&self, axis: usize, min: f64, size: f64) -> Interval {
        let low = min - self.margin - self.origin[axis];
        let high = min + size + self.margin - self.origin[axis];
        if self.inverse[axis].is_infinite() {
            if low > 0.0 || high < 0.0 {
                return Interval::EMPTY;
            }
            return Interval::ALL;
        }
        let (a, b) = (low * self.inverse[axis], high * self.inverse[axis]);
        if self.inverse[axis] < 0.0 {
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

    /// Where the line leaves the halves of a divided cell that it enters first, and where it enters
    /// the others, by axis; NaN for a half whose face the line runs along at the margin's end: the
    /// other half holds it then.
    #[inline]
    fn halves(&self, middle: DVec3) -> (DVec3, DVec3) {
        let middle = middle - self.origin;
        (
            (middle + self.ahead) * self.inverse,
            (middle - self.ahead) * self.inverse,
        )
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
                    let children = &self.blocks[block as usize];
                    let size = cell.size * 0.5;
                    let middle = cell.min + size;
                    // On its outer sides a child is as large as its parent, whose part of the line
                    // is known: only the planes between the halves cut it.
                    let (near_ends, far_starts) = slabs.halves(middle);
                    let mut met = ALL;
                    for axis in 0..3 {
                        let near = u32::from(cell.span.start <= near_ends[axis]) * NEAR[axis];
                        let far = u32::from(far_starts[axis] <= cell.span.end) * !NEAR[axis];
                        met &= near | far;
                    }
                    let corners = [cell.min.to_array(), middle.to_array()];
                    // The nearest comes last and lies on top then.
                    while met != 0 {
                        let near_to_far = met.ilog2() as usize;
                        met ^= 1 << near_to_far;
                        let octant = near_to_far ^ slabs.flip;
                        let node = children[octant];
                        if Node::is_empty(node) {
                            continue;
                        }
                        let Interval { mut start, mut end } = cell.span;
                        for axis in 0..3 {
                            if near_to_far >> axis & 1 == 1 {
                                start = later(start, far_starts[axis]);
                            } else {
                                end = earlier(end, near_ends[axis]);
                            }
                        }
                        if start <= end {
                            let min = |axis: usize| corners[octant >> axis & 1][axis];
                            stack.push(Waiting {
                                node,
                                min: DVec3::new(min(0), min(1), min(2)),
                                size,
                                span: Interval { start, end },
                            });
                        }
                    }
                }
            }
        }
        entered
    }
}
