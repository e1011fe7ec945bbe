//! Spheres, cones and polygons.

use octray_geometry::{ShapeError, Sheet, Solid};
use octray_math::DVec3;
use octray_scene::{MaterialId, Object};

use super::{BYTES_PER_CORNER, Reader, cone};
use crate::text::Word;

impl Reader<'_> {
    pub(super) fn current_material(&mut self, keyword: Word<'_>) -> MaterialId {
        if let Some(material) = self.material {
            return material;
        }
        let message = "no `f` comes before this: it gets the default material";
        self.diagnostics.warning(keyword.span(self.source), message);
        let material = self.builder.add_material(crate::dress::default_material());
        self.material = Some(material);
        material
    }

    pub(super) fn sphere(&mut self, keyword: Word<'_>) {
        let Some([x, y, z, radius]) = self.numbers::<4>(keyword) else {
            return;
        };
        let material = self.current_material(keyword);
        // A negative radius shows only the inside; here both sides are always seen.
        let sphere = Solid::sphere(radius.abs()).and_then(|s| s.translate(DVec3::new(x, y, z)));
        let Some(solid) = self.made(keyword, sphere) else {
            return;
        };
        self.counts[0] += 1;
        let name = format!("sphere {}", self.counts[0]);
        self.builder
            .add_object(Object::solid(name, solid, material));
    }

    pub(super) fn cone(&mut self, keyword: Word<'_>) {
        let Some([x0, y0, z0, r0, x1, y1, z1, r1]) = self.numbers::<8>(keyword) else {
            return;
        };
        let material = self.current_material(keyword);
        let (base, apex) = (DVec3::new(x0, y0, z0), DVec3::new(x1, y1, z1));
        let cone = cone::open_cone(base, r0.abs(), apex, r1.abs());
        let Some(sheet) = self.made(keyword, cone) else {
            return;
        };
        self.counts[1] += 1;
        let kind = if r0 == r1 { "cylinder" } else { "cone" };
        let name = format!("{kind} {}", self.counts[1]);
        self.builder
            .add_object(Object::sheet(name, sheet, material));
    }

    /// A shape, or a warning: what has no extent cannot be seen.
    pub(super) fn made<T>(&mut self, keyword: Word<'_>, shape: Result<T, ShapeError>) -> Option<T> {
        match shape {
            Ok(shape) => Some(shape),
            Err(error) => {
                let message = format!("passed over: {error}");
                self.diagnostics.warning(keyword.span(self.source), message);
                None
            }
        }
    }

    pub(super) fn polygon(&mut self, keyword: Word<'_>, with_normals: bool) {
        let span = keyword.span(self.source);
        let Some([count]) = self.numbers::<1>(keyword) else {
            return;
        };
        if !(count >= 3.0 && libm::trunc(count) == count) {
            let message = format!("a polygon has at least 3 vertices, not {count}");
            self.diagnostics.error(span, message);
            return self.skip();
        }
        self.current_material(keyword);
        let (mut corners, mut normals) = (Vec::new(), Vec::new());
        let mut finite = true;
        // The numbers there are decide how far this goes, not the count that is claimed.
        while (corners.len() as f64) < count {
            if !self.budget.take(BYTES_PER_CORNER) {
                return;
            }
            let mut values = [0.0; 6];
            let needed = if with_normals { 6 } else { 3 };
            for value in &mut values[..needed] {
                let Some(number) = self.number() else {
                    let message = format!(
                        "the polygon has {count} vertices, but only {} are complete",
                        corners.len()
                    );
                    self.diagnostics.error(span, message);
                    return self.skip();
                };
                finite &= number.is_finite();
                *value = number;
            }
            let [x, y, z, nx, ny, nz] = values;
            corners.push(DVec3::new(x, y, z));
            normals.push(DVec3::new(nx, ny, nz));
        }
        if !finite {
            return;
        }
        match self.triangulator.triangulate(&corners) {
            Ok(triangles) => {
                let normals = with_normals.then_some(&normals[..]);
                self.polygons.add(&corners, normals, &triangles);
            }
            Err(error) => self.diagnostics.error(span, error.to_string()),
        }
    }

    /// The polygons since the last `f` become one object.
    pub(super) fn end_polygons(&mut self) {
        let polygons = std::mem::take(&mut self.polygons);
        let Some(material) = self.material.filter(|_| !polygons.is_empty()) else {
            return;
        };
        self.counts[2] += 1;
        let name = format!("polygons {}", self.counts[2]);
        match polygons.into_mesh() {
            Ok(mesh) => {
                let object = Object::sheet(name, Sheet::mesh(mesh), material);
                self.builder.add_object(object);
            }
            Err(error) => self.diagnostics.error(None, format!("{name}: {error}")),
        }
    }
}
