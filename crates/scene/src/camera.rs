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

/// Share of the picture that what is to be seen may take.
const FILL: f64 = 0.92;

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

    /// A pinhole that shows all of `bounds`, seen along `direction` (any length), as near as it
    /// can be with a small margin, in any picture that is not higher than wide.
    ///
    /// `None` for an empty or unbounded box, or where `up` points along `direction`.
    #[must_use]
    pub fn view_all(bounds: &Aabb, direction: DVec3, up: DVec3, vertical_fov: f64) -> Option<Self> {
        if bounds.is_empty() || !bounds.is_bounded() {
            return None;
        }
        Self::view_points(bounds.corners(), direction, up, vertical_fov)
    }

    /// Like [`Camera::view_all`], of points: they fill the picture in one direction and lie in
    /// its middle.
    ///
    /// `None` without points, or where `up` points along `direction`.
    #[must_use]
    pub fn view_points(
        points: impl IntoIterator<Item = DVec3>,
        direction: DVec3,
        up: DVec3,
        vertical_fov: f64,
    ) -> Option<Self> {
        let forward = direction.try_normalize()?;
        let mut camera = Self::look_at(DVec3::ZERO, forward, up, vertical_fov)?;
        let slope = FILL * libm::tan(0.5 * vertical_fov);
        let sides = [camera.right, camera.up].map(DVec3::normalize_or_zero);
        // A point at offset h and depth z is seen by an eye at (e, d) if
        // |h - e| <= (z - d) * slope: e - d slope >= h - z slope and e + d slope <= h + z slope.
        let mut low = [f64::NEG_INFINITY; 2];
        let mut high = [f64::INFINITY; 2];
        let mut nearest = f64::INFINITY;
        for point in points {
            let depth = point.dot(forward);
            nearest = nearest.min(depth);
            for (axis, side) in sides.iter().enumerate() {
                let offset = point.dot(*side);
                low[axis] = low[axis].max(offset - depth * slope);
                high[axis] = high[axis].min(offset + depth * slope);
            }
        }
        let mut depth = f64::min(high[0] - low[0], high[1] - low[1]) / (2.0 * slope);
        if depth >= nearest {
            // A single point, or points in one line of sight.
            depth = nearest - 1.0;
        }
        let [x, y] = [0, 1].map(|axis| 0.5 * low[axis] + 0.5 * high[axis]);
        camera.eye = sides[0] * x + sides[1] * y + forward * depth;
        camera.eye.is_finite().then_some(camera)
    }

    /// A parallel projection of points along `direction` (any length): they lie in the middle and
    /// fill the picture in one direction, in any picture that is not higher than wide.
    ///
    /// `None` without points, or where `up` points along `direction`.
    #[must_use]
    pub fn project_points(
        points: impl IntoIterator<Item = DVec3>,
        direction: DVec3,
        up: DVec3,
    ) -> Option<Self> {
        let forward = direction.try_normalize()?;
        let unit = Self::orthographic(DVec3::ZERO, forward, up, 1.0)?;
        let axes = [unit.right, unit.up, forward];
        let (low, high) = points.into_iter().fold(
            (DVec3::INFINITY, DVec3::NEG_INFINITY),
            |(low, high), point| {
                let place = DVec3::from_array(axes.map(|axis| point.dot(axis)));
                (low.min(place), high.max(place))
            },
        );
        let size = high - low;
        let extent = if size.x.max(size.y) > 0.0 {
            size.x.max(size.y)
        } else {
            // A single point, or points in one line of sight.
            1.0
        };
        let middle = 0.5 * low + 0.5 * high;
        let depth = low.z - extent;
        let eye = axes[0] * middle.x + axes[1] * middle.y + forward * depth;
        Self::orthographic(eye, eye + forward * extent, up, extent / FILL)
            .filter(|camera| camera.eye.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn view_all_shows_every_corner_and_wastes_little() {
        for size in [
            DVec3::ONE,
            DVec3::new(1e-9, 3.0, 2e-9),
            DVec3::new(5e8, 1.0, 20.0),
        ] {
            let bounds = Aabb::new(DVec3::splat(7.0), DVec3::splat(7.0) + size);
            for direction in [DVec3::Y, DVec3::new(1.0, -2.0, -0.5), DVec3::NEG_X] {
                let camera = Camera::view_all(&bounds, direction, DVec3::Z, 0.6).expect("a box");
                let mut farthest: f64 = 0.0;
                for corner in bounds.corners() {
                    let p = corner - camera.eye;
                    let depth = p.dot(camera.forward);
                    assert!(depth > 0.0);
                    for side in [camera.right, camera.up] {
                        // Offset from the middle of the picture, in pictures.
                        let offset = p.dot(side) / side.length_squared() / depth;
                        farthest = farthest.max(offset.abs());
                    }
                }
                assert!(farthest <= 0.5 && farthest > 0.4, "{farthest}");
            }
        }
        let point = Aabb::from_points([DVec3::ONE]);
        assert!(Camera::view_all(&point, DVec3::Y, DVec3::Z, 0.6).is_some());
        assert!(Camera::view_all(&Aabb::EMPTY, DVec3::Y, DVec3::Z, 0.6).is_none());
        assert!(Camera::view_all(&Aabb::ALL, DVec3::Y, DVec3::Z, 0.6).is_none());
    }
}
