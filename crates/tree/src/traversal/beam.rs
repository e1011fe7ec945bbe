//! Coherence: neighbouring rays go down the tree together.
//!
//! A *run* of rays with one main axis and one order of octants is enclosed in a *beam* (Heckbert and
//! Hanrahan, "Beam tracing polygonal objects", SIGGRAPH 1984). The beam goes down the tree once,
//! front to back, as far as cells are much larger than its cross-section; what it ends with, its *entry
//! cells*, is where each ray begins instead of at the root (Reshetov, Soupikov and Hurley,
//! "Multi-level ray tracing algorithm", SIGGRAPH 2005, for kd-trees and one cell). That a cell is tested once
//! for a set of rays, and only then for each of them, goes back to Arvo and Kirk ("Fast ray tracing by ray classification",
//! SIGGRAPH 1987).
//!
//! The beam is bounded by four planes. Let `w` be the main axis, on which the rays have no component of
//! direction less than half their largest, and `u` one of the others. Between two planes `w = from` and
//! `w = to` that enclose what counts of all the rays, each ray's `u` is a linear function of `w`. The least of linear
//! functions is concave, so it nowhere falls below the chord between its values at both ends; the greatest is
//! convex and nowhere rises above its chord. Hence `low(w) <= u(w) <= high(w)` for every ray, whether the rays
//! start at one point, end at one (a lamp), are parallel or none of these.
//!
//! *Invariant:* every cell (grown by half of [`CellTree::CONTENT_MARGIN`]) that a ray of the run meets in its interval lies in
//! an entry cell, or above it. The beam is tested against cells grown by the whole margin; the other half is a million
//! times what the bounds are rounded by.
//!
//! *Limits:* a run that goes down an axis with some rays and up with others has no order of octants, and a beam as wide as
//! a quarter of the cube has no use: such rays are walked one by one, from the root.

use octray_math::{Aabb, Interval, Ray};

use crate::CellTree;
use crate::cell_tree::{Node, Slabs, Waiting, WalkStack};

/// Cells are divided for the beam while they are larger than this many times its cross-section there.
const CELL_PER_WIDTH: f64 = 2.0;
/// Beams wider than this share of the cube are given up.
const WIDEST: f64 = 0.25;
/// The most entry cells of a beam: from then on the cells that it meets stay as they are.
const MOST_ENTRIES: usize = 64;

/// Where the rays of a run begin: working memory, kept from run to run.
#[derive(Clone, Debug, Default)]
pub struct BeamMemory {
    /// Front to back for every ray of the run.
    entries: Vec<Waiting>,
    waiting: Vec<Waiting>,
    main_axis: usize,
}

/// The linear function of `w` through two values at the ends of the beam.
#[derive(Clone, Copy, Debug)]
struct Edge {
    at_start: f64,
    slope: f64,
}

impl Edge {
    fn new([at_start, at_end]: [f64; 2], length: f64) -> Self {
        let slope = if length > 0.0 {
            (at_end - at_start) / length
        } else {
            0.0
        };
        Self { at_start, slope }
    }

    fn at(self, along: f64) -> f64 {
        self.at_start + along * self.slope
    }
}

/// The region between four planes through which the rays of a run go.
#[derive(Clone, Debug)]
struct Beam {
    main_axis: usize,
    others: [usize; 2],
    /// Along the main axis.
    from: f64,
    to: f64,
    low: [Edge; 2],
    high: [Edge; 2],
    /// Whether the rays go down each axis.
    backward: [bool; 3],
}

impl Beam {
    /// Around what counts of the rays inside a box; `None` if they have no common main axis or order.
    fn around(bounds: &Aabb, rays: &[(Ray, Interval)]) -> Option<Self> {
        let (first, _) = rays.first()?;
        let size = first.direction.abs();
        let main_axis = (0..3).max_by(|a, b| size[*a].total_cmp(&size[*b]))?;
        let others = [(main_axis + 1) % 3, (main_axis + 2) % 3];
        let (mut down, mut up) = ([false; 3], [false; 3]);
        let (mut from, mut to) = (f64::INFINITY, f64::NEG_INFINITY);
        for (ray, within) in rays {
            let d = ray.direction;
            let is_main = d[main_axis].abs() >= 0.5 * d.abs().max_element();
            if !(is_main && d[main_axis] != 0.0 && d.is_finite()) {
                return None;
            }
            for axis in 0..3 {
                down[axis] |= d[axis] < 0.0;
                up[axis] |= d[axis] > 0.0;
            }
            let span = bounds.clip(ray).intersection(within);
            if !span.is_empty() {
                let w = |s: f64| ray.origin[main_axis] + s * d[main_axis];
                from = from.min(w(span.start)).min(w(span.end));
                to = to.max(w(span.start)).max(w(span.end));
            }
        }
        if (0..3).any(|axis| down[axis] && up[axis]) {
            return None;
        }
        let mut low = [[f64::INFINITY; 2]; 2];
        let mut high = [[f64::NEG_INFINITY; 2]; 2];
        if from <= to {
            for (ray, within) in rays {
                if bounds.clip(ray).intersection(within).is_empty() {
                    continue;
                }
                let Ray { origin, direction } = ray;
                for (i, &other) in others.iter().enumerate() {
                    let slope = direction[other] / direction[main_axis];
                    for (end, w) in [from, to].into_iter().enumerate() {
                        let u = origin[other] + (w - origin[main_axis]) * slope;
                        if !u.is_finite() {
                            return None;
                        }
                        low[i][end] = low[i][end].min(u);
                        high[i][end] = high[i][end].max(u);
                    }
                }
            }
        }
        let length = to - from;
        Some(Self {
            main_axis,
            others,
            from,
            to,
            low: low.map(|ends| Edge::new(ends, length)),
            high: high.map(|ends| Edge::new(ends, length)),
            backward: down,
        })
    }

    /// The beam's largest extent across its main axis in a cube grown by `margin`; `None` if it does
    /// not meet it.
    fn width_in(&self, min: octray_math::DVec3, size: f64, margin: f64) -> Option<f64> {
        let axis = self.main_axis;
        let start = self.from.max(min[axis] - margin) - self.from;
        let end = self.to.min(min[axis] + size + margin) - self.from;
        if start > end {
            return None;
        }
        let mut width = 0.0_f64;
        for (i, &other) in self.others.iter().enumerate() {
            let (low, high) = (self.low[i], self.high[i]);
            let (lows, highs) = ([low.at(start), low.at(end)], [high.at(start), high.at(end)]);
            if lows[0].min(lows[1]) > min[other] + size + margin
                || highs[0].max(highs[1]) < min[other] - margin
            {
                return None;
            }
            width = width.max(highs[0] - lows[0]).max(highs[1] - lows[1]);
        }
        Some(width)
    }
}

impl CellTree {
    /// Finds where the rays of a run begin, each with the part of it that counts; returns how many
    /// cells the beam entered, or `None` if the rays have no beam that is of use: then each is walked
    /// by itself.
    pub fn enter(&self, rays: &[(Ray, Interval)], memory: &mut BeamMemory) -> Option<u64> {
        memory.entries.clear();
        memory.waiting.clear();
        let root_size = self.root().size().x;
        let margin = root_size * Self::CONTENT_MARGIN;
        let beam = Beam::around(&self.root().inflated(margin), rays)?;
        memory.main_axis = beam.main_axis;
        let mut root = Waiting {
            node: self.root_node().encode(),
            min: self.root().min,
            size: root_size,
            span: Interval::EMPTY,
        };
        // The widths of cells on the way are kept in the place of their parts of a line.
        let Some(width) = beam.width_in(root.min, root.size, margin) else {
            return Some(0);
        };
        // NaN is not narrow.
        let is_narrow = width <= WIDEST * root_size;
        if !is_narrow {
            return None;
        }
        root.span.end = width;
        memory.waiting.push(root);
        let mut entered = 0;
        let flip = (0..3).fold(0, |flip, axis| {
            flip | u32::from(beam.backward[axis]) << axis
        });
        while let Some(cell) = memory.waiting.pop() {
            entered += 1;
            let is_full = memory.entries.len() + memory.waiting.len() >= MOST_ENTRIES;
            match Node::decode(cell.node) {
                Node::Empty(_) => {}
                Node::Divided(block) if !is_full && cell.size > CELL_PER_WIDTH * cell.span.end => {
                    let size = cell.size * 0.5;
                    // The last one first: the first is on top then.
                    for near in (0..8).rev() {
                        let octant = near ^ flip;
                        let node = self.child(block, octant);
                        if matches!(node, Node::Empty(_)) {
                            continue;
                        }
                        let upper = octray_math::DVec3::new(
                            f64::from(octant & 1),
                            f64::from(octant >> 1 & 1),
                            f64::from(octant >> 2),
                        );
                        let min = cell.min + upper * size;
                        if let Some(width) = beam.width_in(min, size, margin) {
                            let span = Interval::new(0.0, width);
                            let node = node.encode();
                            memory.waiting.push(Waiting {
                                node,
                                min,
                                size,
                                span,
                            });
                        }
                    }
                }
                Node::Divided(_) | Node::Occupied(_) => memory.entries.push(cell),
            }
        }
        Some(entered)
    }

    /// [`CellTree::walk`] for a ray of the run that was last entered, or a part of one, from the entry
    /// cells on.
    pub fn walk_from(
        &self,
        memory: &BeamMemory,
        ray: &Ray,
        within: Interval,
        stack: &mut WalkStack,
        mut visit: impl FnMut(u32, Interval) -> f64,
    ) -> u64 {
        let root_size = self.root().size().x;
        let slabs = Slabs::new(ray, root_size);
        let mut limit = within.end;
        // Grown cells overlap: the next one may begin so much earlier than this one.
        let overlap = 2.0 * Self::CONTENT_MARGIN * root_size;
        let overlap = overlap / ray.direction[memory.main_axis].abs();
        let WalkStack(stack) = stack;
        stack.clear();
        let mut entered = 0;
        for entry in &memory.entries {
            let span = slabs.clip(entry.min, entry.size, within);
            if span.is_empty() {
                continue;
            }
            if span.start > limit + overlap {
                break;
            }
            stack.push(Waiting { span, ..*entry });
            entered += self.walk_down(&slabs, stack, &mut limit, &mut visit);
        }
        entered
    }
}
