//! The viewpoint.

use octray_math::DVec3;
use octray_scene::Camera;

use super::Reader;
use crate::Span;
use crate::text::Word;

/// What stands after `v`.
#[derive(Default)]
pub(super) struct ViewPoint {
    pub place: Option<Span>,
    pub from: Option<DVec3>,
    pub at: Option<DVec3>,
    pub up: Option<DVec3>,
    /// Degrees.
    pub angle: Option<f64>,
}

impl Reader<'_> {
    pub(super) fn angle(&mut self, keyword: Word<'_>) {
        let Some([degrees]) = self.numbers::<1>(keyword) else {
            return;
        };
        if degrees > 0.0 && degrees < 180.0 {
            self.view.angle = Some(degrees);
        } else {
            let message = format!("the angle must lie between 0 and 180 degrees, not {degrees}");
            self.diagnostics.error(keyword.span(self.source), message);
        }
    }

    pub(super) fn resolution(&mut self, keyword: Word<'_>) {
        let Some(size) = self.numbers::<2>(keyword) else {
            return;
        };
        if size
            .iter()
            .all(|&n| libm::trunc(n) == n && (1.0..=65536.0).contains(&n))
        {
            let [width, height] = size.map(|n| n as u32);
            self.builder.settings_mut().size = Some((width, height));
        } else {
            let [width, height] = size;
            let message = format!("a picture of {width} by {height} pixels cannot be made");
            self.diagnostics.error(keyword.span(self.source), message);
        }
    }

    pub(super) fn camera(&mut self) {
        let ViewPoint {
            place,
            from,
            at,
            up,
            angle,
        } = std::mem::take(&mut self.view);
        if let Some(up) = up.and_then(DVec3::try_normalize) {
            self.builder.settings_mut().up = up;
        }
        let Some(place) = place else {
            if from.is_none() {
                self.diagnostics
                    .warning(None, "no viewpoint `v`: all of the scene is shown");
            }
            return;
        };
        let (Some(from), Some(at), Some(up), Some(angle)) = (from, at, up, angle) else {
            let message = "a viewpoint needs `from`, `at`, `up` and `angle`";
            return self.diagnostics.error(place, message);
        };
        match Camera::look_at(from, at, up, angle.to_radians()) {
            Some(camera) => self.builder.set_camera(camera),
            None => self.diagnostics.error(
                place,
                "`from` and `at` must be apart, and `up` must not point along the view",
            ),
        }
    }
}
