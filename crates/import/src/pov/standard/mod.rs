//! What octray knows of POV-Ray's standard includes: names and values, in words of our own.

pub(super) mod colors;

/// A standard include.
pub(super) struct Standard {
    /// Declarations in the scene language; empty where there are none.
    pub(super) text: &'static str,
    /// It declares the colour names.
    pub(super) colors: bool,
    /// Everything that a scene can use of it is there.
    pub(super) complete: bool,
    /// Includes that it includes.
    pub(super) needs: &'static [&'static str],
}

const NAMES: [&str; 44] = [
    "arrays.inc",
    "chars.inc",
    "colors.inc",
    "consts.inc",
    "debug.inc",
    "finish.inc",
    "functions.inc",
    "glass.inc",
    "glass_old.inc",
    "golds.inc",
    "ior.inc",
    "logo.inc",
    "makegrass.inc",
    "math.inc",
    "meshmaker.inc",
    "metals.inc",
    "rad_def.inc",
    "rand.inc",
    "screen.inc",
    "shapes.inc",
    "shapes2.inc",
    "shapes3.inc",
    "shapes_old.inc",
    "shapesq.inc",
    "skies.inc",
    "stage1.inc",
    "stars.inc",
    "stdcam.inc",
    "stdinc.inc",
    "stones.inc",
    "stones1.inc",
    "stones2.inc",
    "stoneold.inc",
    "strings.inc",
    "sunpos.inc",
    "textures.inc",
    "transforms.inc",
    "woodmaps.inc",
    "woods.inc",
    "ash.map",
    "rdgranit.map",
    "cedar.map",
    "teak.map",
    "whiteash.map",
];

/// The include of this name, if it is a standard one.
pub(super) fn find(name: &str) -> Option<Standard> {
    let name = name.to_lowercase();
    if !NAMES.contains(&&*name) {
        return None;
    }
    let (text, colors, complete, needs): (_, _, _, &'static [&'static str]) = match &*name {
        "colors.inc" => ("", true, true, &[]),
        "consts.inc" => (include_str!("consts.inc"), false, true, &[]),
        "math.inc" => (include_str!("math.inc"), false, false, &[]),
        "shapes.inc" => (include_str!("shapes.inc"), false, false, &[]),
        "shapesq.inc" => (include_str!("shapesq.inc"), false, false, &[]),
        "finish.inc" => (include_str!("finish.inc"), false, true, &[]),
        "textures.inc" => (include_str!("textures.inc"), false, false, &["colors.inc"]),
        "glass.inc" | "glass_old.inc" => (include_str!("glass.inc"), false, false, &[]),
        "stdinc.inc" => (include_str!("stdinc.inc"), false, false, &["colors.inc"]),
        "debug.inc" | "strings.inc" | "rand.inc" => ("", false, false, &[]),
        "metals.inc" | "golds.inc" | "stones.inc" | "woods.inc" | "skies.inc" => {
            ("", false, false, &["colors.inc"])
        }
        _ => ("", false, false, &[]),
    };
    Some(Standard {
        text,
        colors,
        complete,
        needs,
    })
}

/// A standard include with a similar name.
pub(super) fn nearest(name: &str) -> Option<&'static str> {
    crate::spelling::nearest(name, NAMES)
}
