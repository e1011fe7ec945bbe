use octray_math::DVec3;

/// A light without extent.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Where it is and where it shines.
    pub kind: LightKind,
    /// Colour times strength.
    pub color: DVec3,
    /// How it weakens with distance.
    pub falloff: Falloff,
    /// `false`: it shines through everything.
    pub casts_shadows: bool,
    /// `false`: it makes no highlights (a fill light).
    pub makes_highlights: bool,
}

/// The kinds of light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// Shines from a point in all directions.
    Point {
        /// Where it is.
        position: DVec3,
    },
    /// Shines from a point in a cone: fully within `inner`, not at all beyond `outer`, between
    /// them by the cubic `s^2 (3 - 2 s)`, where `s` goes from 0 to 1 with the cosine of the angle
    /// to the axis: `s = (cos - cos outer) / (cos inner - cos outer)`, as in POV-Ray. All of it
    /// times `max(cos, 0)^tightness`; a tightness of 0 leaves the cone as it is beyond 90 degrees.
    Spot {
        /// Where it is.
        position: DVec3,
        /// The cone's axis, unit length.
        direction: DVec3,
        /// Half angle in radians.
        inner: f64,
        /// Half angle in radians, at least `inner`, at most pi.
        outer: f64,
        /// Exponent of the cosine to the axis.
        tightness: f64,
    },
    /// Shines from infinitely far.
    Directional {
        /// The way the light travels, unit length.
        direction: DVec3,
    },
}

/// How a light weakens with the distance `r`; directional light never does.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Falloff {
    /// Not at all (the usual in Whitted's model, NFF and POV-Ray).
    #[default]
    None,
    /// By `1 / r^2`: the colour is radiant intensity.
    InverseSquare,
    /// By `2 / (1 + (r / distance)^power)` (POV-Ray's `fade_distance`, `fade_power`).
    Fade {
        /// Where the light has its nominal strength.
        distance: f64,
        /// Exponent.
        power: f64,
    },
}

impl Light {
    /// A point light that does not weaken.
    #[must_use]
    pub const fn point(position: DVec3, color: DVec3) -> Self {
        Self::new(LightKind::Point { position }, color)
    }

    /// Light from infinitely far, travelling along `direction` (unit length).
    #[must_use]
    pub const fn directional(direction: DVec3, color: DVec3) -> Self {
        Self::new(LightKind::Directional { direction }, color)
    }

    /// A light with shadows and highlights that does not weaken.
    #[must_use]
    pub const fn new(kind: LightKind, color: DVec3) -> Self {
        Self {
            kind,
            color,
            falloff: Falloff::None,
            casts_shadows: true,
            makes_highlights: true,
        }
    }
}
