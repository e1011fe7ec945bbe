//! Random scenes, coincident boundaries strongly preferred.
//!
//! A scene draws all its lengths from one small lattice and all its poses from a small pool, and
//! builds equal poses along different chains of transforms: what coincides arrives by different
//! rounding.

mod pose;
mod rays;
mod shapes;

use octray_geometry::surface::SURFACE_TOLERANCE;
use octray_geometry::{Primitive, Solid, SolidNode};
use octray_world::Method;

use crate::draw::Draw;
use crate::model::{Model, Part};
use pose::Pose;

pub(crate) use rays::Family;
pub(crate) use rays::{Rays, aim};

/// What a scene's numbers are drawn from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lattice {
    step: f64,
    nudge: Nudge,
}

/// How numbers that would be equal are pulled apart.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Nudge {
    None,
    /// By a few units in the last place: they still count as equal.
    Ulps,
    /// By a few of the surface table's tolerances: they may count as different.
    Tolerances,
}

impl Lattice {
    fn new(draw: &mut Draw) -> Self {
        Self {
            step: draw.pick(&[1.0, 0.5, 0.5, 0.25, 0.1, 1.0 / 3.0]),
            nudge: match draw.weighted(&[7, 2, 1]) {
                0 => Nudge::None,
                1 => Nudge::Ulps,
                _ => Nudge::Tolerances,
            },
        }
    }

    fn nudged(&self, draw: &mut Draw, value: f64) -> f64 {
        let unit = match self.nudge {
            Nudge::None => return value,
            Nudge::Ulps => f64::EPSILON,
            Nudge::Tolerances => SURFACE_TOLERANCE,
        };
        if draw.chance(0.7) {
            return value;
        }
        value * (1.0 + f64::from(draw.whole(-3, 3)) * unit)
    }

    pub(super) fn coordinate(&self, draw: &mut Draw) -> f64 {
        let value = f64::from(draw.whole(-3, 3)) * self.step;
        self.nudged(draw, value)
    }

    pub(super) fn length(&self, draw: &mut Draw) -> f64 {
        let value = match draw.weighted(&[20, 1]) {
            0 => f64::from(draw.whole(1, 4)) * self.step,
            _ => self.step / draw.pick(&[16.0, 100.0, 1000.0]),
        };
        self.nudged(draw, value)
    }
}

/// The scene of a stream of choices.
pub(crate) fn scene(draw: &mut Draw) -> Model {
    let lattice = Lattice::new(draw);
    let poses: Vec<Pose> = (0..draw.whole(1, 2)).map(|_| Pose::draw(draw)).collect();
    let around = pose::surroundings(draw);
    let count = draw.pick(&[1, 1, 1, 1, 2, 2, 3]);
    let mut spare: Vec<Solid> = Vec::new();
    let mut parts = Vec::new();
    for _ in 0..count {
        let operands = draw.pick(&[1, 2, 2, 3, 3, 4, 5, 6, 8, 12]) / count.min(2);
        let mut tree = Tree {
            draw,
            lattice,
            poses: &poses,
            spare: &mut spare,
        };
        let solid = tree.grow(operands.max(1));
        let solid = match around {
            Some(transform) => SolidNode::Transformed {
                child: solid,
                parent_from_child: transform,
            }
            .into(),
            None => solid,
        };
        parts.push(Part {
            priority: if draw.chance(0.3) {
                draw.whole(-1, 1)
            } else {
                0
            },
            solid,
        });
    }
    // A polynomial may have a factor that is a plane: no table knows, and slivers are real.
    let products = parts.iter().any(|part| has_polynomial(&part.solid));
    Model {
        method: Method::Auto,
        parts,
        delicate: products || lattice.nudge == Nudge::Tolerances,
    }
}

fn has_polynomial(solid: &Solid) -> bool {
    match solid.node() {
        SolidNode::Primitive(primitive) => matches!(primitive, Primitive::Polynomial { .. }),
        SolidNode::Empty => false,
        SolidNode::Transformed { child, .. }
        | SolidNode::WithMaterial { child, .. }
        | SolidNode::Complement(child) => has_polynomial(child),
        SolidNode::Union(all) | SolidNode::Intersection(all) | SolidNode::Difference(all) => {
            all.iter().any(has_polynomial)
        }
    }
}

/// A tree of solids that grows.
struct Tree<'a> {
    draw: &'a mut Draw,
    lattice: Lattice,
    poses: &'a [Pose],
    /// Placed primitives, to be used again.
    spare: &'a mut Vec<Solid>,
}

impl Tree<'_> {
    fn grow(&mut self, operands: usize) -> Solid {
        if self.draw.chance(0.06) {
            return SolidNode::Complement(self.grow(operands)).into();
        }
        if operands <= 1 {
            return self.leaf();
        }
        let mut left = operands;
        let mut children = Vec::new();
        let arity = 2 + self.draw.below(operands.min(4) - 1);
        for last in (0..arity).rev() {
            let most = left - last;
            let own = if last == 0 {
                most
            } else {
                1 + self.draw.below(most)
            };
            left -= own;
            children.push(self.grow(own));
        }
        let node = match self.draw.weighted(&[5, 2, 5]) {
            0 => SolidNode::Union(children),
            1 => SolidNode::Intersection(children),
            _ => SolidNode::Difference(children),
        };
        if self.draw.chance(0.1) {
            return pose::moved_as_a_whole(self.draw, self.lattice, node.into());
        }
        node.into()
    }

    fn leaf(&mut self) -> Solid {
        if !self.spare.is_empty() && self.draw.chance(0.25) {
            return self.draw.pick(self.spare);
        }
        let pose = self.draw.pick(self.poses);
        let primitive = shapes::primitive(self.draw, self.lattice);
        let solid = pose::placed(self.draw, self.lattice, &pose, primitive);
        self.spare.push(solid.clone());
        solid
    }
}
