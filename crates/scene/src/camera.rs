use octray_math::{Aabb, DVec3};

/// Where the picture is taken from.
///
/// The picture point `(x, y)`, both in `[0, 1]` with `(0, 0)` at the top left, lies in the
/// direction `forward + (x - 0.5) * right + (0.5 - y) * up` from the eye (perspective), or starts
/// at `eye + (x - 0.5) * right + (0.5 - y) * up` and goes along `forward` (orthographic).
/// A left-handed triple makes the mirrored picture that left-handed scene languages expect;
/// geometry is never mirrored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Perspective or parallel.
    pub projection: Projection,
    /// The point of view.
    pub eye: DVec3,
    /// The middle of the picture; its length matters in perspective.
    pub forward: DVec3,
    /// Spans the picture's width.
    pub right: DVec3,
    /// Spans the picture's height.
    pub up: DVec3,
    /// `true`: `right` is meant for a square picture and is stretched by width / height.
    /// `false`: it is used as it is, whatever the picture's shape.
    pub fit_aspect: bool,
}

/// How the picture's points become rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Projection {
    /// All rays start at the eye.
    Perspective,
    /// All rays are parallel.
    Orthographic,
}

impl Camera {
    /// A pinhole at `eye` that sees `target` in the middle, `up` upwards, `vertical_fov` radians
    /// from the bottom to the top of the picture.
    ///
    /// `None` where eye and target coincide, `up` points along the view, or the angle is not in
    /// `(0, pi)`.
    #[must_use]
    pub fn look_at(eye: DVec3, target: DVec3, up: DVec3, vertical_fov: f64) -> Option<Self> {
        if !(vertical_fov > 0.0 && vertical_fov < std::f64::consts::PI) {
            return None;
        }
        let height = 2.0 * libm::tan(0.5 * vertical_fov);
        Self::frame(Projection::Perspective, eye, target, up, height)
    }

    /// A parallel projection whose picture is `height` scene units high.
    ///
    /// `None` where eye and target coincide, `up` points along the view, or `height` is not
    /// positive.
    #[must_use]
    pub fn orthographic(eye: DVec3, target: DVec3, up: DVec3, height: f64) -> Option<Self> {
        if !(height > 0.0 && height.is_finite()) {
            return None;
        }
        Self::frame(Projection::Orthographic, eye, target, up, height)
    }

    fn frame(
        projection: Projection,
        eye: DVec3,
        target: DVec3,
        up: DVec3,
        height: f64,
    ) -> Option<Self> {
        let forward = (target - eye).try_normalize()?;
        let right = forward.cross(up.try_normalize()?).try_normalize()?;
        Some(Self {
            projection,
            eye,
            forward,
            right: right * height,
            up: right.cross(forward) * height,
            fit_aspect: true,
        })
    }

    /// A pinhole that shows all of `bounds`, seen along `direction` (any length).
    ///
    /// `None` for an empty or unbounded box, or where `up` points along `direction`.
    #[must_use]
    pub fn view_all(bounds: &Aabb, direction: DVec3, up: DVec3, vertical_fov: f64) -> Option<Self> {
        if bounds.is_empty() || !bounds.is_bounded() {
            return None;
        }
        let radius = 0.5 * bounds.diagonal();
        let radius = if radius > 0.0 { radius } else { 1.0 };
        let center = bounds.center();
        let distance = radius / libm::sin(0.5 * vertical_fov);
        let eye = center - direction.try_normalize()? * distance;
        Self::look_at(eye, center, up, vertical_fov)
    }
}
