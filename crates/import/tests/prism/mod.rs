//! Prisms over plane outlines: polyhedra whose volume and area are known in closed form.
#![allow(dead_code, reason = "each test file uses its part")]

use octray_geometry::{Sheet, SolidNode, TriangleMesh};
use octray_import::Imported;
use octray_math::DVec3;
use octray_scene::{Object, Shape};

/// A closed polyhedron with polygons for faces.
#[derive(Clone, Debug)]
pub(crate) struct Prism {
    pub(crate) positions: Vec<DVec3>,
    /// Counter-clockwise from outside.
    pub(crate) faces: Vec<Vec<usize>>,
    pub(crate) volume: f64,
    pub(crate) area: f64,
}

impl Prism {
    /// Over a regular polygon with `n` corners in the unit circle.
    pub(crate) fn regular(n: usize, height: f64) -> Self {
        let half = std::f64::consts::PI / n as f64;
        let base = n as f64 * half.sin() * half.cos();
        let edge = 2.0 * half.sin();
        Self::over(&star(n, 1.0, 1.0), base, n as f64 * edge, height)
    }

    /// Over a star with `n` points on the unit circle and `n` inward corners at `inner`: concave.
    pub(crate) fn star(n: usize, inner: f64, height: f64) -> Self {
        let half = std::f64::consts::PI / n as f64;
        // 2n triangles with sides 1 and `inner` and the angle `half` between them.
        let base = n as f64 * inner * half.sin();
        let edge = (1.0 + inner * inner - 2.0 * inner * half.cos()).sqrt();
        let outline = star(2 * n, 1.0, inner);
        Self::over(&outline, base, 2.0 * n as f64 * edge, height)
    }

    fn over(outline: &[DVec3], base: f64, perimeter: f64, height: f64) -> Self {
        let n = outline.len();
        let top = outline.iter().map(|p| *p + DVec3::Z * height);
        let mut faces = vec![(0..n).rev().collect(), (n..2 * n).collect()];
        for i in 0..n {
            let j = (i + 1) % n;
            faces.push(vec![i, j, j + n, i + n]);
        }
        Self {
            positions: outline.iter().copied().chain(top).collect(),
            faces,
            volume: base * height,
            area: 2.0 * base + perimeter * height,
        }
    }

    /// Checks a mesh that was read back: closed, of the right size and number of triangles.
    pub(crate) fn check(&self, mesh: &TriangleMesh, tolerance: f64) {
        assert_eq!(mesh.check_closed(), Ok(()));
        let corners: usize = self.faces.iter().map(|f| f.len() - 2).sum();
        assert_eq!(mesh.triangles().len(), corners);
        let (volume, area) = measure(mesh);
        assert!(
            (volume - self.volume).abs() <= tolerance,
            "{volume} {}",
            self.volume
        );
        assert!(
            (area - self.area).abs() <= tolerance,
            "{area} {}",
            self.area
        );
    }
}

fn star(n: usize, even: f64, odd: f64) -> Vec<DVec3> {
    let corner = |i: usize| {
        let angle = 2.0 * std::f64::consts::PI * i as f64 / n as f64;
        let radius = if i.is_multiple_of(2) { even } else { odd };
        DVec3::new(radius * angle.cos(), radius * angle.sin(), 0.0)
    };
    (0..n).map(corner).collect()
}

/// Volume by the divergence theorem, and area.
pub(crate) fn measure(mesh: &TriangleMesh) -> (f64, f64) {
    let (mut volume, mut area) = (0.0, 0.0);
    for triangle in mesh.triangles() {
        let [a, b, c] = triangle.map(|i| mesh.positions()[i as usize]);
        volume += a.dot(b.cross(c)) / 6.0;
        area += (b - a).cross(c - a).length() / 2.0;
    }
    (volume, area)
}

/// The mesh of an object, whether sheet or solid.
pub(crate) fn mesh_of(object: &Object) -> &TriangleMesh {
    match &object.shape {
        Shape::Sheet(Sheet::Mesh { mesh, .. }) => mesh,
        Shape::Solid(solid) => match solid.node() {
            SolidNode::Primitive(octray_geometry::Primitive::Mesh(mesh)) => mesh,
            other => panic!("no mesh: {other:?}"),
        },
        other => panic!("no mesh: {other:?}"),
    }
}

/// The only object's mesh.
pub(crate) fn only_mesh(imported: &Imported) -> &TriangleMesh {
    let scene = imported.scene.as_ref();
    let scene = scene.unwrap_or_else(|| panic!("{:#?}", imported.diagnostics));
    assert_eq!(scene.objects().len(), 1);
    mesh_of(&scene.objects()[0])
}

/// The first lines of all messages.
pub(crate) fn messages(imported: &Imported) -> Vec<String> {
    let first_line = |d| {
        let shown = imported.diagnostics.render(d);
        shown.lines().next().unwrap_or_default().to_owned()
    };
    imported.diagnostics.iter().map(first_line).collect()
}

/// Checks that the file is refused with messages that begin so.
pub(crate) fn check_refused(imported: &Imported, expected: &[&str]) {
    assert!(imported.scene.is_none(), "accepted, though {expected:?}");
    let messages = messages(imported);
    assert_eq!(messages.len(), expected.len(), "{messages:#?}");
    for (message, expected) in messages.iter().zip(expected) {
        assert!(
            message.starts_with(expected),
            "{message}\n  is not\n{expected}"
        );
    }
}
