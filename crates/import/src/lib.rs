//! Scene and mesh files into [`Scene`]s, with diagnostics that name file, line and column.
//!
//! Every importer is a function from bytes to what it could read plus everything that was wrong,
//! all in one go. None panics, hangs, or allocates more than a multiple of its input: sizes that
//! a file claims are checked against [`Options::memory_budget`] first. Only [`Disk`] touches the file system.

mod budget;
pub mod diagnostic;
pub mod dress;
mod face_colors;
mod files;
pub mod load;
mod mesh_object;
pub mod nff;
pub mod obj;
pub mod openscad;
pub mod ply;
pub use octray_geometry::polygon;
pub mod pov;
pub mod stl;
mod text;
mod weld;

mod spelling;

pub use diagnostic::{Diagnostic, Diagnostics, Severity, SourceId, Span};
pub use files::{Disk, FileSystem, InMemory};
pub use load::load;

use octray_scene::{Scene, SceneBuilder};

/// How to read.
#[derive(Clone, Debug)]
pub struct Options {
    /// OpenSCAD: make the polyhedra OpenSCAD makes even where `$fn` is 0.
    pub facets: bool,
    /// At most this many bytes of scene data (positions, nodes, expanded loops) are made.
    pub memory_budget: u64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            facets: false,
            memory_budget: 8 << 30,
        }
    }
}

/// What an importer returns.
#[derive(Debug)]
pub struct Imported {
    /// The scene; `None` when an error makes a picture meaningless.
    pub scene: Option<Scene>,
    /// Everything worth saying, in source order.
    pub diagnostics: Diagnostics,
}

impl Imported {
    /// The scene if nothing was wrong with it, and all messages.
    pub(crate) fn finish(builder: SceneBuilder, mut diagnostics: Diagnostics) -> Self {
        if diagnostics.has_errors() {
            return Self::failed(diagnostics);
        }
        match builder.build() {
            Ok(scene) => Self {
                scene: Some(scene),
                diagnostics,
            },
            Err(errors) => {
                for error in errors {
                    diagnostics.error(None, error.to_string());
                }
                Self::failed(diagnostics)
            }
        }
    }

    /// No scene, only messages.
    pub(crate) const fn failed(diagnostics: Diagnostics) -> Self {
        Self {
            scene: None,
            diagnostics,
        }
    }
}
