//! POV-Ray's scene description language (versions 3.0 to 3.7).
//!
//! A scene is a program: directives (`#declare`, `#while`, `#macro`, ...) run while tokens are
//! taken, and what is left between them are the objects. So the importer is an interpreter: a
//! [`reader::Reader`] holds the stack of sources and macros, the identifiers and what the
//! statements have made; the other files teach it one part of the language each. When all is
//! read, [`lower::Lowering`] turns the objects into a [`octray_scene::Scene`].
//!
//! A mistake ends its statement and reading goes on behind it; what is well-formed and not
//! supported is warned of and left out. Loops, recursion and memory are bounded.
//!
//! Semantics: the reference of POV-Ray 3.7 (<https://www.povray.org/documentation/3.7.0/>).

mod camera;
mod color;
mod color_map;
mod declare;
mod directives;
mod expect;
mod expression;
mod finish;
mod functions;
mod implicit;
mod include;
mod lexer;
mod light;
mod loops;
mod lower;
mod macros;
mod materials;
mod meshes;
mod object;
mod operators;
mod pigment;
mod primitives;
mod profile;
mod reader;
mod scene;
mod scope;
mod splines;
mod standard;
mod strings;
mod swept;
mod texture;
mod transforms;
mod triangles;
mod value;

use std::path::Path;

use octray_math::DVec3;
use octray_scene::{Background, Encoding, View};

use crate::{Diagnostics, FileSystem, Imported, Options};
use reader::Reader;

/// What `image_width` and `image_height` are: only their ratio is of use to a scene, and a
/// camera that uses it is fitted to the picture's shape.
const IMAGE_SIZE: (f64, f64) = (640.0, 480.0);

/// Reads the bytes of the file `path`; other files it names come from `files`.
#[must_use]
pub fn import(path: &Path, bytes: Vec<u8>, files: &dyn FileSystem, options: &Options) -> Imported {
    let folder = path.parent().unwrap_or_else(|| Path::new("")).to_owned();
    let mut reader = Reader::new(Diagnostics::default(), files, options, folder);
    if reader.open_source(path, bytes).is_ok() {
        reader.statements();
    }
    finish(reader)
}

fn finish(mut reader: Reader<'_>) -> Imported {
    let camera = if let Some((state, span)) = reader.scene.camera {
        reader.made_camera(&state, span)
    } else {
        None
    };
    let mut lowering = reader.lowering;
    let mut scene = reader.scene;
    lowering.diagnostics = reader.diagnostics;
    lowering.default_texture = reader.default_texture;
    if let Some(camera) = camera {
        lowering.builder.set_camera(camera);
    }
    let settings = lowering.builder.settings_mut();
    settings.up = DVec3::Y;
    settings.view = View::Standard;
    settings.encoding = match scene.assumed_gamma {
        Some(encoding) => encoding,
        None if scene.modern => Encoding::Linear,
        None => Encoding::Srgb,
    };
    settings.ambient_light = scene.ambient_light.unwrap_or(DVec3::ONE);
    settings.max_generations = scene.max_trace_level.unwrap_or(5.0).clamp(1.0, 256.0) as u32;
    settings.contribution_threshold = scene.adc_bailout.unwrap_or(1.0 / 255.0).max(0.0);
    lowering.builder.set_background(if scene.sky.is_empty() {
        Background::Uniform(scene.background)
    } else {
        Background::Sky {
            base: scene.background,
            layers: scene.sky,
        }
    });
    if !lowering.diagnostics.has_errors() {
        for object in scene.objects.drain(..) {
            lowering.add(&object);
        }
        lowering.finish();
    }
    Imported::finish(lowering.builder, lowering.diagnostics)
}

/// Blocks that are read over, and what they are called in messages.
fn ignored(word: &str) -> Option<&'static str> {
    Some(match word {
        "fog" => "fog",
        "rainbow" => "a rainbow",
        "media" => "media",
        "density" => "a density",
        "normal" => "a normal",
        "photons" => "a photons block",
        "radiosity" => "radiosity",
        "normal_map" => "a normal map",
        "slope_map" => "a slope map",
        "texture_map" => "a texture map",
        "density_map" => "a density map",
        "pigment_map" => "a pigment map",
        "interior_texture" => "an interior texture",
        "spline" => "a spline",
        _ => return None,
    })
}

/// Words that begin a statement: reading goes on there after a mistake.
const STATEMENTS: [&str; 27] = [
    "sphere",
    "box",
    "cylinder",
    "cone",
    "plane",
    "torus",
    "disc",
    "polygon",
    "triangle",
    "mesh",
    "mesh2",
    "union",
    "merge",
    "intersection",
    "difference",
    "object",
    "light_source",
    "camera",
    "global_settings",
    "background",
    "sky_sphere",
    "fog",
    "lathe",
    "prism",
    "sor",
    "blob",
    "height_field",
];

/// Whether this word is the language's own.
fn is_reserved(word: &str) -> bool {
    KEYWORDS.contains(&word)
        || expression::is_built_in(word)
        || functions::is_text_function(word)
        || object::OBJECTS.contains(&word)
}

/// Words of the language that are not the user's to declare, for suggestions.
const KEYWORDS: [&str; 123] = [
    "aa_level",
    "adaptive",
    "ambient",
    "angle",
    "area_light",
    "array",
    "assumed_gamma",
    "background",
    "bicubic_patch",
    "blob",
    "blue",
    "bounded_by",
    "box",
    "bozo",
    "brilliance",
    "bumps",
    "camera",
    "checker",
    "clipped_by",
    "clock",
    "color",
    "color_map",
    "colour",
    "colour_map",
    "cone",
    "crackle",
    "cubic",
    "cylinder",
    "difference",
    "diffuse",
    "direction",
    "disc",
    "emission",
    "fade_distance",
    "fade_power",
    "false",
    "falloff",
    "filter",
    "finish",
    "fog",
    "function",
    "global_settings",
    "gradient",
    "granite",
    "green",
    "height_field",
    "hollow",
    "image_height",
    "image_map",
    "image_width",
    "interior",
    "intersection",
    "inverse",
    "ior",
    "isosurface",
    "julia_fractal",
    "lathe",
    "leopard",
    "light_source",
    "location",
    "look_at",
    "marble",
    "material",
    "matrix",
    "max_trace_level",
    "merge",
    "mesh",
    "mesh2",
    "metallic",
    "no",
    "no_shadow",
    "normal",
    "object",
    "off",
    "on",
    "onion",
    "open",
    "orthographic",
    "parallel",
    "perspective",
    "phong",
    "phong_size",
    "pi",
    "pigment",
    "plane",
    "point_at",
    "poly",
    "polygon",
    "polynomial",
    "prism",
    "quadric",
    "quartic",
    "radius",
    "red",
    "reflection",
    "rgb",
    "rgbf",
    "rgbft",
    "rgbt",
    "right",
    "rotate",
    "roughness",
    "scale",
    "sky",
    "sky_sphere",
    "sor",
    "specular",
    "sphere",
    "spotlight",
    "superellipsoid",
    "text",
    "texture",
    "torus",
    "transform",
    "translate",
    "transmit",
    "triangle",
    "true",
    "turbulence",
    "union",
    "up",
    "version",
    "wood",
];
