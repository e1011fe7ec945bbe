//! OpenSCAD's `.csg` dumps: what a program comes to, without its variables and loops.
//!
//! A dump is written by `openscad -o model.csg model.scad`. Both dialects are read: 2021.01 writes
//! every parameter, later versions leave out defaults.
//!
//! - Round shapes with `$fn = 0` are exact; with `$fn > 0`, or all of them with
//!   [`Options::facets`], they are the polyhedra OpenSCAD makes.
//! - Top-level statements are a union in OpenSCAD. Here each is an object of its own, also through
//!   groups, transforms and colours; the set of points is the same. Where opaque parts overlap
//!   so is the picture; opaque parts show inside of transparent ones.
//! - `linear_extrude` draws out circles, squares, polygons and set operations of them, without
//!   twist and scale. Other flat things are not read.
//! - The outermost `color()` counts, as in OpenSCAD. What has no colour is yellow, and green where
//!   something without colour was subtracted.
//! - `%` and `*` take a statement out of the model, `!` leaves only the statement it marks, `#`
//!   changes nothing.

mod arguments;
mod color_names;
mod cursor;
mod drawing;
mod extrude;
mod facets;
mod flat;
mod lexer;
mod lower;
mod modules;
mod objects;
mod operand;
mod orientation;
mod paint;
mod parser;
mod placement;
mod polyhedron;
mod primitives;
mod refusal;
mod syntax;
mod text;

use std::path::Path;

use octray_math::DVec3;

use crate::{Diagnostics, FileSystem, Imported, Options, Span};

/// Statements take at most this many times the memory of their text.
const BYTES_PER_BYTE: u64 = 64;

/// Reads the bytes of the dump `path`. Dumps that name other files (`import`, `surface`) do not
/// get them yet, so `files` is not asked.
#[must_use]
pub fn import(path: &Path, bytes: Vec<u8>, _files: &dyn FileSystem, options: &Options) -> Imported {
    let mut diagnostics = Diagnostics::default();
    let size = bytes.len() as u64;
    let text = String::from_utf8(bytes);
    let (text, invalid) = match text {
        Ok(text) => (text, None),
        Err(error) => {
            let at = error.utf8_error().valid_up_to();
            let source = diagnostics.add_source(path, error.into_bytes());
            (String::new(), Some(Span::new(source, at..at + 1)))
        }
    };
    if let Some(span) = invalid {
        diagnostics.error(span, "this is not UTF-8 text, as an OpenSCAD dump is");
        return failed(diagnostics);
    }
    if size.saturating_mul(BYTES_PER_BYTE) > options.memory_budget || u32::try_from(size).is_err() {
        let source = diagnostics.add_source(path, Vec::new());
        let message = format!(
            "the file has {size} bytes, too many for the memory budget of {} MiB",
            options.memory_budget >> 20
        );
        diagnostics.error(Span::new(source, 0..0), message);
        return failed(diagnostics);
    }
    let source = diagnostics.add_source(path, text.clone().into_bytes());
    let statements = parser::parse(&text, source, &mut diagnostics);
    let mut lowering = lower::Lowering::new(&mut diagnostics, options);
    match find_root(&statements) {
        Some(root) => lowering.scene(std::slice::from_ref(root)),
        None => lowering.scene(&statements),
    }
    let mut builder = lowering.builder;
    if diagnostics.has_errors() {
        return failed(diagnostics);
    }
    builder.settings_mut().up = DVec3::Z;
    match builder.build() {
        Ok(scene) => Imported {
            scene: Some(scene),
            diagnostics,
        },
        Err(errors) => {
            for error in errors {
                diagnostics.error(None, error.to_string());
            }
            failed(diagnostics)
        }
    }
}

const fn failed(diagnostics: Diagnostics) -> Imported {
    Imported {
        scene: None,
        diagnostics,
    }
}

/// The first statement marked `!`, in the order of the text.
fn find_root<'s, 't>(statements: &'s [syntax::Statement<'t>]) -> Option<&'s syntax::Statement<'t>> {
    let mut stack: Vec<_> = statements.iter().rev().collect();
    while let Some(statement) = stack.pop() {
        if statement.modifiers.root {
            return Some(statement);
        }
        stack.extend(statement.children.iter().rev());
    }
    None
}
