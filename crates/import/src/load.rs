//! One door for all formats.

use std::io;
use std::path::Path;

use crate::{Diagnostics, FileSystem, Imported, Options, dress, nff, obj, openscad, ply, pov, stl};

/// Reads a scene or mesh file of any supported format, with a default look where it has none.
///
/// The format is told by the file's suffix, and by its content where the suffix says nothing or
/// something else than the content. Of files that describe geometry only, what is missing is
/// added by [`dress::dress`]; a scene file keeps its own lights (or darkness).
#[must_use]
pub fn load(path: &Path, files: &dyn FileSystem, options: &Options) -> Imported {
    let bytes = match files.read(path, options.memory_budget) {
        Ok(bytes) => bytes,
        Err(error) => return refuse(path, Vec::new(), &io_problem(&error), None),
    };
    let format = match Format::of(path, &bytes) {
        Ok(format) => format,
        Err((problem, help)) => return refuse(path, bytes, &problem, help),
    };
    let read = match format {
        Format::Pov => pov::import,
        Format::Csg => openscad::import,
        Format::Nff => nff::import,
        Format::Obj => obj::import,
        Format::Ply => ply::import,
        Format::Stl => stl::import,
    };
    let mut imported = read(path, bytes, files, options);
    if let Some(scene) = imported.scene.take() {
        let keeps_its_look = matches!(format, Format::Pov | Format::Nff);
        imported.scene = Some(if keeps_its_look {
            dress::add_camera(scene)
        } else {
            dress::dress(scene)
        });
    }
    imported
}

fn refuse(path: &Path, bytes: Vec<u8>, problem: &str, help: Option<&str>) -> Imported {
    let mut diagnostics = Diagnostics::default();
    diagnostics.add_source(path, bytes);
    diagnostics.push(crate::Diagnostic {
        severity: crate::Severity::Error,
        span: None,
        message: problem.to_owned(),
        help: help.map(str::to_owned),
    });
    Imported::failed(diagnostics)
}

/// Why a file cannot be read, in words of our own: the system's differ from machine to machine.
pub(crate) fn io_problem(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::NotFound => "there is no such file".to_owned(),
        io::ErrorKind::PermissionDenied => "there is no permission to read it".to_owned(),
        io::ErrorKind::IsADirectory => "it is a folder, not a file".to_owned(),
        io::ErrorKind::FileTooLarge => {
            "it is larger than the memory that the scene may use".to_owned()
        }
        _ => format!("it cannot be read: {error}"),
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Pov,
    Csg,
    Nff,
    Obj,
    Ply,
    Stl,
}

type Refusal = (String, Option<&'static str>);

impl Format {
    fn of(path: &Path, bytes: &[u8]) -> Result<Self, Refusal> {
        // These two cannot be mistaken for anything else.
        if ply::is_ply(bytes) {
            return Ok(Self::Ply);
        }
        if stl::Kind::is_exact_binary(bytes) {
            return Ok(Self::Stl);
        }
        let suffix = path.extension().unwrap_or_default();
        let suffix = suffix.to_string_lossy().to_ascii_lowercase();
        Ok(match suffix.as_str() {
            "pov" | "inc" => Self::Pov,
            "csg" => Self::Csg,
            "nff" => Self::Nff,
            "obj" => Self::Obj,
            "ply" => Self::Ply,
            "stl" => Self::Stl,
            "scad" => {
                return Err((
                    "OpenSCAD programs are not run here".to_owned(),
                    Some("let OpenSCAD export the evaluated tree: openscad -o part.csg part.scad"),
                ));
            }
            _ if begins_as_ascii_stl(bytes) => Self::Stl,
            "" => {
                return Err((
                    "the file has no suffix to tell its format".to_owned(),
                    FORMATS,
                ));
            }
            _ => return Err((format!("`.{suffix}` is no format that is read"), FORMATS)),
        })
    }
}

const FORMATS: Option<&str> = Some(
    "supported are .pov (POV-Ray), .csg (OpenSCAD), .nff (Neutral File Format), .obj, .ply and .stl",
);

fn begins_as_ascii_stl(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(1024)];
    head.trim_ascii_start().starts_with(b"solid") && head.windows(5).any(|w| w == b"facet")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::InMemory;

    fn first_message(path: &str, bytes: Option<&[u8]>) -> String {
        let mut files = InMemory::default();
        if let Some(bytes) = bytes {
            files.insert(path, bytes);
        }
        let imported = load(Path::new(path), &files, &Options::default());
        assert!(imported.scene.is_none());
        let diagnostics = &imported.diagnostics;
        let first = diagnostics.iter().next().expect("a message");
        diagnostics.render(first)
    }

    #[test]
    fn what_cannot_be_read_is_said_with_the_file_s_name() {
        assert_eq!(
            first_message("gone.stl", None),
            "gone.stl: error: there is no such file"
        );
        let unknown = first_message("a.step", Some(b"ISO-10303-21;"));
        assert!(
            unknown.contains(".csg") && unknown.contains(".ply"),
            "{unknown}"
        );
        assert!(first_message("a.scad", Some(b"cube(1);")).contains("openscad -o"));
        assert!(first_message("nothing", Some(b"")).contains("suffix"));
    }

    #[test]
    fn content_overrules_the_suffix() {
        let mut binary = b"solid is what many binary files begin with".to_vec();
        binary.resize(80, b' ');
        binary.extend(1_u32.to_le_bytes());
        for x in [0_f32, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
            binary.extend(x.to_le_bytes());
        }
        binary.extend([0, 0]);
        let mut files = InMemory::default();
        for name in ["a.stl", "a.obj", "a"] {
            files.insert(name, binary.clone());
            let imported = load(Path::new(name), &files, &Options::default());
            let scene = imported.scene.expect("one triangle");
            assert_eq!(scene.objects().len(), 1);
            assert!(scene.camera().is_some() && !scene.lights().is_empty());
        }
    }
}
