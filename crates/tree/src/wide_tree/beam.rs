//! Lines through one point walk the tree together.
//!
//! Primary rays meet in the eye, shadow rays in a lamp. A node is entered once for all lines of a
//! beam, its eight boxes tested against four planes around the beam; for a leaf every line tells for
//! itself whether it may meet the box ([`octray_kernels::beam`] proves that none is missed). Boxes that
//! begin behind what every line has found already are left out. After Reshetov, Soupikov and Hurley,
//! "Multi-level ray tracing algorithm" (SIGGRAPH 2005), and Wald, Boulos and Shirley, "Ray tracing
//! deformable scenes using dynamic bounding volume hierarchies" (2007).

use std::ops::Range;

use octray_kernels::beam::{GROUP, STEEPEST_SLOPE};
use octray_kernels::slab::round_up;
use octray_kernels::{BeamFrame, Bounds, Group, Kernels};
use octray_math::Ray;

use super::{WalkCost, WideTree, link};

/// Groups in a beam.
pub const GROUPS: usize = 4;
/// Lines in a beam.
pub const BEAM: usize = GROUPS * GROUP;

/// The common point may be this far from the tree's centre, in its coordinates: farther away the
/// lines of a beam cannot be told apart well enough in `f32`.
const FARTHEST: f64 = 64.0;
/// How far lines may miss the common point, as a share of the coordinates' size.
const MISSED: f64 = 1.0 / (1u64 << 44) as f64;

/// A line that may join a beam.
#[derive(Clone, Copy, Debug)]
pub struct BeamLine {
    /// The line.
    pub ray: Ray,
    /// The parameter at which it passes the common point.
    pub at: f64,
    /// What counts of it lies between there and here.
    pub end: f64,
}

/// Lines through one point.
#[derive(Clone, Debug)]
pub struct Beam {
    frame: BeamFrame,
    /// The lines in order. What counts of them may be shortened.
    pub groups: [Group; GROUPS],
    /// Of all lines.
    bounds: Bounds,
    /// Depth per parameter of each line.
    rates: [f64; BEAM],
    at: [f64; BEAM],
}

/// A child of a node that is still to be seen, and the depth before which nothing in it counts.
#[derive(Clone, Copy, Debug, Default)]
pub struct PendingBeam {
    entry: f32,
    node: u32,
    lane: u32,
}

/// What looks at the items of leaves for a beam.
pub trait BeamVisitor {
    /// The beam, shortened as far as the visitor has found something.
    fn beam(&self) -> &Beam;

    /// Looks at the items that stand at `places` of [`WideTree::items`] for some of the lines: a mask for
    /// each group.
    fn leaf(&mut self, kernels: impl Kernels, places: Range<usize>, lines: [u32; GROUPS]);
}

impl Default for Beam {
    /// No lines.
    fn default() -> Self {
        Self {
            frame: BeamFrame::new([0.0; 3], 0, false, 1.0, 1.0),
            groups: [Group::NONE; GROUPS],
            bounds: Bounds::NONE,
            rates: [0.0; BEAM],
            at: [0.0; BEAM],
        }
    }
}

impl Beam {
    /// For the kernels.
    #[must_use]
    pub const fn frame(&self) -> &BeamFrame {
        &self.frame
    }

    /// To be called after ends of groups have changed.
    #[inline]
    pub fn shorten(&mut self) {
        let end = |i: usize| self.groups[i].bounds.end;
        self.bounds.end = end(0).max(end(1)).max(end(2)).max(end(3));
    }

    /// A depth on the line that is not below the one at parameter `t`.
    #[must_use]
    #[inline]
    pub fn depth(&self, line: usize, t: f64) -> f32 {
        let depth = (t - self.at[line]).abs() * self.rates[line];
        round_up(depth * (1.0 + 1.0 / (1u64 << 40) as f64)) + self.frame.error()
    }
}

impl WideTree {
    /// Makes a beam of up to [`BEAM`] lines that pass about the point at which the first does; `false` if
    /// there is no use in it: one is `None`, they have no main axis in common, pass too far from the
    /// point, or their slopes differ by more than `widest`.
    pub fn beam(
        &self,
        count: usize,
        line: impl Fn(usize) -> Option<BeamLine>,
        widest: f32,
        beam: &mut Beam,
    ) -> bool {
        self.try_beam(count, line, widest, beam).is_some()
    }

    fn try_beam(
        &self,
        count: usize,
        line: impl Fn(usize) -> Option<BeamLine>,
        widest: f32,
        beam: &mut Beam,
    ) -> Option<()> {
        if self.nodes.is_empty() || !(1..=BEAM).contains(&count) {
            return None;
        }
        let first = line(0)?;
        let through = first.ray.origin + first.ray.direction * first.at;
        let toward = |line: &BeamLine| {
            let d = line.ray.direction;
            if line.end < line.at { -d } else { d }
        };
        let d = toward(&first);
        let size = d.abs();
        let main = if size.x >= size.y && size.x >= size.z {
            0
        } else if size.y >= size.z {
            1
        } else {
            2
        };
        let down = d[main] < 0.0;
        let origin = self.frame.point(through);
        let distance = origin.abs().max_element();
        // NaN is not near.
        let is_near = distance <= FARTHEST;
        if !is_near {
            return None;
        }
        let (x, y) = ((main + 1) % 3, (main + 2) % 3);
        let scale = self.frame.scale();
        let Beam {
            frame,
            groups,
            bounds,
            rates,
            at,
        } = beam;
        let (mut missed, mut far) = (0.0_f64, 0.0_f64);
        for index in 0..count {
            let line = line(index)?;
            let d = toward(&line);
            let along = if down { -d[main] } else { d[main] };
            let share = 1.0 / along;
            let slopes = [d[x] * share, d[y] * share];
            let passed = line.ray.origin + line.ray.direction * line.at;
            let joins = along > 0.0
                && slopes[0].abs() <= STEEPEST_SLOPE
                && slopes[1].abs() <= STEEPEST_SLOPE;
            if !joins {
                return None;
            }
            missed = missed.max((passed - through).abs().max_element());
            far = far.max(line.ray.origin.abs().max_element());
            let group = &mut groups[index / GROUP];
            let place = index % GROUP;
            group.slopes[0][place] = slopes[0] as f32;
            group.slopes[1][place] = slopes[1] as f32;
            rates[index] = along * scale;
            at[index] = line.at;
            group.ends[place] = round_up((line.end - line.at).abs() * rates[index]);
        }
        // Line origins are rounded where they are, whatever the tree's centre.
        let far = far * scale + self.frame.center().abs().max_element() * scale + distance + 16.0;
        if !(missed * scale <= far * MISSED && far <= 1e6) {
            return None;
        }
        let extent = self.frame.point(self.bounds.max).abs().max_element();
        let extent = extent.max(self.frame.point(self.bounds.min).abs().max_element());
        let slack = far * (1.0 / (1u64 << 40) as f64);
        *frame = BeamFrame::new(origin.to_array(), main, down, extent, slack);
        *bounds = Bounds::NONE;
        for (index, group) in groups.iter_mut().enumerate() {
            let count = count.saturating_sub(index * GROUP).min(GROUP);
            group.ends[count..].fill(f32::NEG_INFINITY);
            group.bounds = Bounds::NONE;
            for (axis, [low, high]) in group.bounds.slopes.iter_mut().enumerate() {
                for &slope in &group.slopes[axis][..count] {
                    *low = low.min(slope);
                    *high = high.max(slope);
                }
            }
            group.shorten();
            *bounds = bounds.union(&group.bounds);
        }
        let wide = |[low, high]: [f32; 2]| high - low > widest;
        if wide(bounds.slopes[0]) || wide(bounds.slopes[1]) {
            return None;
        }
        Some(())
    }

    /// Walks a beam from leaf to leaf, about front to back. To be used inside `dispatch!` on
    /// [`WideTree::lanes`]. Counts nodes; items are the visitor's.
    ///
    /// `stack` is working memory, at least [`WideTree::stack_length`] long.
    #[inline(always)]
    pub fn walk_beam(
        &self,
        kernels: impl Kernels,
        stack: &mut [PendingBeam],
        cost: &mut WalkCost,
        visitor: &mut impl BeamVisitor,
    ) {
        let mut entries = [0.0f32; 8];
        let mut height = 0;
        let mut inner = 0;
        'nodes: loop {
            cost.nodes += 1;
            let beam = visitor.beam();
            let node = &self.nodes[inner as usize];
            let mut any = kernels.test_boxes(&beam.frame, &beam.bounds, &node.boxes, &mut entries);
            let bottom = height;
            while any != 0 {
                let lane = any.trailing_zeros() as usize & 7;
                any &= any - 1;
                let next = PendingBeam {
                    entry: entries[lane],
                    node: inner,
                    lane: lane as u32,
                };
                let mut place = height;
                while place > bottom && stack[place - 1].entry < next.entry {
                    stack[place] = stack[place - 1];
                    place -= 1;
                }
                stack[place] = next;
                height += 1;
            }
            loop {
                if height == 0 {
                    return;
                }
                height -= 1;
                let part = stack[height];
                let beam = visitor.beam();
                if part.entry > beam.bounds.end {
                    continue;
                }
                let node = &self.nodes[part.node as usize];
                let lane = part.lane as usize & 7;
                let Some(places) = link::items(node.links[lane]) else {
                    inner = node.links[lane];
                    continue 'nodes;
                };
                let mut lines = [0; GROUPS];
                let mut any = 0;
                for (lines, group) in lines.iter_mut().zip(&beam.groups) {
                    if part.entry <= group.bounds.end {
                        *lines = kernels.test_box(&beam.frame, group, &node.boxes, lane);
                        any |= *lines;
                    }
                }
                if any != 0 {
                    visitor.leaf(kernels, places, lines);
                }
            }
        }
    }
}
