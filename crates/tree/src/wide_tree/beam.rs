//! Lines through one point walk the tree together.
//!
//! Primary rays meet in the eye, shadow rays in a lamp. A node is entered once for all lines of a
//! beam; four groups of sixteen lines tell for themselves which of its eight boxes they may meet
//! ([`octray_kernels::beam`] proves that none is missed). Boxes that all groups miss, or that begin
//! behind what every line has found already, are left out. After Reshetov, Soupikov and Hurley,
//! "Multi-level ray tracing algorithm" (SIGGRAPH 2005), and Wald, Boulos and Shirley, "Ray tracing
//! deformable scenes using dynamic bounding volume hierarchies" (2007).

use std::ops::Range;

use octray_kernels::beam::{GROUP, STEEPEST_SLOPE};
use octray_kernels::slab::round_up;
use octray_kernels::{BeamFrame, Group, Kernels};
use octray_math::{DVec3, Ray};

use super::{WalkCost, WideTree, link};

/// Groups in a beam.
pub const GROUPS: usize = 4;
/// Lines in a beam.
pub const BEAM: usize = GROUPS * GROUP;

/// The common point may be this far from the tree's centre, in its coordinates: farther away the
/// lines of a beam cannot be told apart well enough in `f32`.
const FARTHEST: f64 = 64.0;
/// Slopes of a beam's lines may differ by this much; wider beams meet too much in common.
const WIDEST: f32 = 0.25;
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
    /// Depth per parameter of each line.
    rates: [f64; BEAM],
    at: [f64; BEAM],
}

/// A child of a node that is still to be seen, the depth before which nothing in it counts, and the
/// groups that may meet it.
#[derive(Clone, Copy, Debug, Default)]
pub struct PendingBeam {
    entry: f32,
    node: u32,
    lane: u32,
    groups: u32,
}

/// What looks at the items of leaves for a beam.
pub trait BeamVisitor {
    /// The beam, shortened as far as the visitor has found something.
    fn beam(&self) -> &Beam;

    /// Looks at the items that stand at `places` of [`WideTree::items`] for some of the lines: a mask for
    /// each group.
    fn leaf(&mut self, kernels: impl Kernels, places: Range<usize>, lines: [u32; GROUPS]);
}

impl Beam {
    /// For the kernels.
    #[must_use]
    pub const fn frame(&self) -> &BeamFrame {
        &self.frame
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
    /// The beam of up to [`BEAM`] lines that pass about `through`; `None` if they have no main axis in
    /// common, pass too far from the point, or are too far apart.
    #[must_use]
    pub fn beam(&self, through: DVec3, lines: &[BeamLine]) -> Option<Beam> {
        let first = lines.first()?;
        if self.nodes.is_empty() || lines.len() > BEAM || !through.is_finite() {
            return None;
        }
        let toward = |line: &BeamLine| {
            let d = line.ray.direction;
            if line.end < line.at { -d } else { d }
        };
        let d = toward(first);
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
        if !(distance <= FARTHEST) {
            return None;
        }
        let (x, y) = ((main + 1) % 3, (main + 2) % 3);
        let scale = self.frame.scale();
        let mut groups = [Group::NONE; GROUPS];
        let (mut rates, mut at) = ([0.0; BEAM], [0.0; BEAM]);
        let (mut missed, mut far) = (0.0_f64, 0.0_f64);
        for (index, line) in lines.iter().enumerate() {
            let d = toward(line);
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
        let frame = BeamFrame::new(origin.to_array(), main, down, extent, slack);
        let mut whole = [[f32::INFINITY, f32::NEG_INFINITY]; 2];
        for (index, group) in groups.iter_mut().enumerate() {
            let count = lines.len().saturating_sub(index * GROUP).min(GROUP);
            if count == 0 {
                break;
            }
            for axis in 0..2 {
                let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
                for &slope in &group.slopes[axis][..count] {
                    low = low.min(slope);
                    high = high.max(slope);
                }
                group.bounds[axis] = [low, high];
                whole[axis] = [whole[axis][0].min(low), whole[axis][1].max(high)];
            }
            group.shorten();
        }
        let wide = |[low, high]: [f32; 2]| high - low > WIDEST;
        if wide(whole[0]) || wide(whole[1]) {
            return None;
        }
        Some(Beam {
            frame,
            groups,
            rates,
            at,
        })
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
        let mut active = 0;
        for (index, group) in visitor.beam().groups.iter().enumerate() {
            active |= u32::from(group.end >= 0.0) << index;
        }
        let mut height = 0;
        let mut inner = 0;
        loop {
            if active != 0 {
                cost.nodes += 1;
                let beam = visitor.beam();
                let node = &self.nodes[inner as usize];
                let mut met = [0; GROUPS];
                let mut any = 0;
                while active != 0 {
                    let index = active.trailing_zeros() as usize & (GROUPS - 1);
                    active &= active - 1;
                    let group = &beam.groups[index];
                    met[index] = kernels.test_boxes(&beam.frame, group, &node.boxes, &mut entries);
                    any |= met[index];
                }
                let bottom = height;
                while any != 0 {
                    let lane = any.trailing_zeros() as usize & 7;
                    any &= any - 1;
                    let mut groups = 0;
                    for (index, mask) in met.iter().enumerate() {
                        groups |= (mask >> lane & 1) << index;
                    }
                    let next = PendingBeam {
                        entry: entries[lane],
                        node: inner,
                        lane: lane as u32,
                        groups,
                    };
                    let mut place = height;
                    while place > bottom && stack[place - 1].entry < next.entry {
                        stack[place] = stack[place - 1];
                        place -= 1;
                    }
                    stack[place] = next;
                    height += 1;
                }
            }
            if height == 0 {
                return;
            }
            height -= 1;
            let part = stack[height];
            let beam = visitor.beam();
            for (index, group) in beam.groups.iter().enumerate() {
                active |= u32::from(part.entry <= group.end) << index;
            }
            active &= part.groups;
            if active == 0 {
                continue;
            }
            let node = &self.nodes[part.node as usize];
            let lane = part.lane as usize & 7;
            let Some(places) = link::items(node.links[lane]) else {
                inner = node.links[lane];
                continue;
            };
            let mut lines = [0; GROUPS];
            let mut any = 0;
            while active != 0 {
                let index = active.trailing_zeros() as usize & (GROUPS - 1);
                active &= active - 1;
                let group = &beam.groups[index];
                lines[index] = kernels.test_box(&beam.frame, group, &node.boxes, lane);
                any |= lines[index];
            }
            if any != 0 {
                visitor.leaf(kernels, places, lines);
            }
        }
    }
}
