//! The names a dump may use, and what octray makes of them.

/// What a statement means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Module {
    Cube,
    Sphere,
    Cylinder,
    Polyhedron,
    /// `group`, `union` and `render`: all children together.
    Union,
    Intersection,
    Difference,
    Transform,
    Color,
    Circle,
    Square,
    Polygon,
    LinearExtrude,
    RotateExtrude,
    /// A shape in the plane z = 0; not supported.
    FlatShape,
    /// Makes something flat of its children; not supported.
    FlatOperation,
    /// A solid; not supported.
    UnsupportedShape,
    /// Makes a solid of its children; not supported.
    UnsupportedOperation,
}

/// All modules that OpenSCAD writes into dumps.
const MODULES: [(&str, Module); 32] = [
    ("cube", Module::Cube),
    ("sphere", Module::Sphere),
    ("cylinder", Module::Cylinder),
    ("polyhedron", Module::Polyhedron),
    ("group", Module::Union),
    ("union", Module::Union),
    ("render", Module::Union),
    ("intersection", Module::Intersection),
    ("difference", Module::Difference),
    ("multmatrix", Module::Transform),
    ("color", Module::Color),
    ("circle", Module::Circle),
    ("square", Module::Square),
    ("polygon", Module::Polygon),
    ("text", Module::FlatShape),
    ("offset", Module::FlatOperation),
    ("fill", Module::FlatOperation),
    ("projection", Module::FlatOperation),
    ("import", Module::UnsupportedShape),
    ("linear_extrude", Module::LinearExtrude),
    ("rotate_extrude", Module::RotateExtrude),
    ("surface", Module::UnsupportedShape),
    ("hull", Module::UnsupportedOperation),
    ("minkowski", Module::UnsupportedOperation),
    ("resize", Module::UnsupportedOperation),
    ("roof", Module::UnsupportedOperation),
    ("glide", Module::UnsupportedOperation),
    ("subdiv", Module::UnsupportedOperation),
    ("import_dxf", Module::FlatShape),
    ("import_stl", Module::UnsupportedShape),
    ("import_off", Module::UnsupportedShape),
    ("dxf_linear_extrude", Module::UnsupportedOperation),
];

/// Modules of OpenSCAD's language that a dump has written out.
const EVALUATED: [&str; 15] = [
    "translate",
    "rotate",
    "scale",
    "mirror",
    "for",
    "intersection_for",
    "if",
    "let",
    "assign",
    "children",
    "child",
    "echo",
    "assert",
    "each",
    "assemble",
];

impl Module {
    /// The module called `name`.
    pub(super) fn called(name: &str) -> Option<Self> {
        let found = MODULES.iter().find(|(known, _)| *known == name);
        found.map(|(_, module)| *module)
    }
}

/// Whether the name is one of OpenSCAD's language that no dump has.
pub(super) fn is_evaluated(name: &str) -> bool {
    EVALUATED.contains(&name)
}

/// All names a dump may use.
pub(super) fn names() -> impl Iterator<Item = &'static str> {
    MODULES.iter().map(|(name, _)| *name)
}
