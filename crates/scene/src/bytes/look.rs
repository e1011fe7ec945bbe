//! Materials, lights, camera, background and settings.

use octray_math::bytes::{ByteReader, ByteWriter, BytesError};
use octray_math::{DVec3, transform};

use crate::{
    Background, Camera, Color, ColorStop, Encoding, Fade, Falloff, Finish, Interior, Light,
    LightKind, Material, Pattern, Pigment, Projection, Reflection, Scene, SceneBuilder, View,
};

/// Checkers of checkers of checkers: more than any scene has.
const MAX_PIGMENT_DEPTH: u32 = 64;

pub(super) fn write(scene: &Scene, out: &mut ByteWriter) {
    out.u64(scene.materials().len() as u64);
    for material in scene.materials() {
        out.str(&material.name);
        write_pigment(&material.pigment, out);
        write_finish(&material.finish, out);
        write_interior(&material.interior, out);
    }
    out.u64(scene.lights().len() as u64);
    scene.lights().iter().for_each(|l| write_light(l, out));
    out.bool(scene.camera().is_some());
    if let Some(camera) = scene.camera() {
        out.bool(camera.projection == Projection::Orthographic);
        for v in [camera.eye, camera.forward, camera.right, camera.up] {
            out.vec3(v);
        }
        out.bool(camera.fit_aspect);
    }
    match scene.background() {
        Background::Uniform(rgb) => {
            out.u8(0);
            out.vec3(*rgb);
        }
        Background::Gradient { axis, map } => {
            out.u8(1);
            out.vec3(*axis);
            write_map(map, out);
        }
        Background::Sky { base, layers } => {
            out.u8(2);
            out.vec3(*base);
            out.u64(layers.len() as u64);
            layers.iter().for_each(|layer| write_pigment(layer, out));
        }
    }
    let settings = scene.settings();
    out.vec3(settings.up);
    out.vec3(settings.ambient_light);
    out.u32(settings.max_generations);
    out.f64(settings.contribution_threshold);
    let (encoding, gamma) = match settings.encoding {
        Encoding::Linear => (0, 1.0),
        Encoding::Gamma(gamma) => (1, gamma),
        Encoding::Srgb => (2, 1.0),
    };
    out.u8(encoding);
    out.f64(gamma);
    out.u8(match settings.view {
        View::Neutral => 0,
        View::Standard => 1,
        View::Raw => 2,
    });
    let (width, height) = settings.size.unwrap_or_default();
    out.bool(settings.size.is_some());
    out.u32(width);
    out.u32(height);
    out.str(&settings.units);
}

fn write_color(color: &Color, out: &mut ByteWriter) {
    out.vec3(color.rgb);
    out.f64(color.filter);
    out.f64(color.transmit);
}

fn write_map(map: &[ColorStop], out: &mut ByteWriter) {
    out.u64(map.len() as u64);
    for stop in map {
        out.f64(stop.position);
        write_color(&stop.color, out);
    }
}

fn write_pigment(pigment: &Pigment, out: &mut ByteWriter) {
    match pigment {
        Pigment::Uniform(color) => {
            out.u8(0);
            write_color(color, out);
        }
        Pigment::Pattern {
            pattern,
            pattern_from_world,
        } => {
            match pattern {
                Pattern::Checker(pair) => {
                    out.u8(1);
                    pair.iter().for_each(|p| write_pigment(p, out));
                }
                Pattern::Gradient { axis, map } => {
                    out.u8(2);
                    out.vec3(*axis);
                    write_map(map, out);
                }
            }
            out.affine(pattern_from_world);
        }
    }
}

fn write_finish(f: &Finish, out: &mut ByteWriter) {
    out.vec3(f.ambient);
    out.vec3(f.emission);
    for x in [f.diffuse, f.brilliance, f.phong, f.phong_size] {
        out.f64(x);
    }
    for x in [f.specular, f.roughness, f.metallic] {
        out.f64(x);
    }
    out.vec3(f.reflection.min);
    out.vec3(f.reflection.max);
    out.bool(f.reflection.fresnel);
    out.f64(f.reflection.falloff);
    out.f64(f.reflection.metallic);
    out.bool(f.conserve_energy);
}

fn write_interior(interior: &Interior, out: &mut ByteWriter) {
    out.f64(interior.ior);
    out.vec3(interior.absorption);
    out.bool(interior.fade.is_some());
    if let Some(fade) = interior.fade {
        out.f64(fade.half_distance);
        out.f64(fade.power);
        out.vec3(fade.color);
    }
}

fn write_light(light: &Light, out: &mut ByteWriter) {
    match light.kind {
        LightKind::Point { position } => {
            out.u8(0);
            out.vec3(position);
        }
        LightKind::Spot {
            position,
            direction,
            inner,
            outer,
            tightness,
        } => {
            out.u8(1);
            out.vec3(position);
            out.vec3(direction);
            [inner, outer, tightness]
                .into_iter()
                .for_each(|x| out.f64(x));
        }
        LightKind::Directional { direction } => {
            out.u8(2);
            out.vec3(direction);
        }
    }
    out.vec3(light.color);
    match light.falloff {
        Falloff::None => out.u8(0),
        Falloff::InverseSquare => out.u8(1),
        Falloff::Fade { distance, power } => {
            out.u8(2);
            out.f64(distance);
            out.f64(power);
        }
    }
    out.bool(light.casts_shadows);
    out.bool(light.makes_highlights);
}

pub(super) fn read(
    reader: &mut ByteReader<'_>,
    builder: &mut SceneBuilder,
) -> Result<(), BytesError> {
    for _ in 0..reader.count(200)? {
        let material = Material {
            name: reader.str()?.to_owned(),
            pigment: read_pigment(reader, MAX_PIGMENT_DEPTH)?,
            finish: read_finish(reader)?,
            interior: read_interior(reader)?,
        };
        builder.add_material(material);
    }
    for _ in 0..reader.count(50)? {
        builder.add_light(read_light(reader)?);
    }
    if reader.bool()? {
        let projection = if reader.bool()? {
            Projection::Orthographic
        } else {
            Projection::Perspective
        };
        builder.set_camera(Camera {
            projection,
            eye: reader.vec3()?,
            forward: reader.vec3()?,
            right: reader.vec3()?,
            up: reader.vec3()?,
            fit_aspect: reader.bool()?,
        });
    }
    let background = match reader.u8()? {
        0 => Background::Uniform(reader.vec3()?),
        1 => Background::Gradient {
            axis: reader.vec3()?,
            map: read_map(reader)?,
        },
        2 => {
            let base = reader.vec3()?;
            let mut layers = Vec::new();
            for _ in 0..reader.count(41)? {
                layers.push(read_pigment(reader, MAX_PIGMENT_DEPTH)?);
            }
            Background::Sky { base, layers }
        }
        other => return Err(unknown(reader, "background", other)),
    };
    builder.set_background(background);
    read_settings(reader, builder)
}

fn read_settings(
    reader: &mut ByteReader<'_>,
    builder: &mut SceneBuilder,
) -> Result<(), BytesError> {
    let settings = builder.settings_mut();
    settings.up = reader.vec3()?;
    settings.ambient_light = reader.vec3()?;
    settings.max_generations = reader.u32()?;
    settings.contribution_threshold = reader.f64()?;
    let (encoding, gamma) = (reader.u8()?, reader.f64()?);
    settings.encoding = match encoding {
        0 => Encoding::Linear,
        1 => Encoding::Gamma(gamma),
        2 => Encoding::Srgb,
        other => return Err(unknown(reader, "encoding", other)),
    };
    settings.view = match reader.u8()? {
        0 => View::Neutral,
        1 => View::Standard,
        2 => View::Raw,
        other => return Err(unknown(reader, "view", other)),
    };
    let has_size = reader.bool()?;
    let size = (reader.u32()?, reader.u32()?);
    settings.size = has_size.then_some(size);
    reader.str()?.clone_into(&mut settings.units);
    Ok(())
}

fn unknown(reader: &ByteReader<'_>, what: &str, kind: u8) -> BytesError {
    reader.error(format_args!("a {what} of unknown kind {kind}"))
}

fn read_color(reader: &mut ByteReader<'_>) -> Result<Color, BytesError> {
    Ok(Color {
        rgb: reader.vec3()?,
        filter: reader.f64()?,
        transmit: reader.f64()?,
    })
}

/// Positions in `[0, 1]` and rising, at least one.
fn read_map(reader: &mut ByteReader<'_>) -> Result<Vec<ColorStop>, BytesError> {
    let mut map: Vec<ColorStop> = Vec::new();
    for _ in 0..reader.count(48)? {
        let position = reader.f64()?;
        let least = map.last().map_or(f64::NEG_INFINITY, |stop| stop.position);
        // Written so that NaN fails.
        if !(position >= least && position.is_finite()) {
            return Err(reader.error("a colour map that is not sorted"));
        }
        let color = read_color(reader)?;
        map.push(ColorStop { position, color });
    }
    Ok(map)
}

fn read_pigment(reader: &mut ByteReader<'_>, depth_left: u32) -> Result<Pigment, BytesError> {
    let pattern = match reader.u8()? {
        0 => return Ok(Pigment::Uniform(read_color(reader)?)),
        1 => {
            let Some(depth) = depth_left.checked_sub(1) else {
                return Err(reader.error("pigments nested too deeply"));
            };
            let pair = [read_pigment(reader, depth)?, read_pigment(reader, depth)?];
            Pattern::Checker(Box::new(pair))
        }
        2 => Pattern::Gradient {
            axis: reader.vec3()?,
            map: read_map(reader)?,
        },
        other => return Err(unknown(reader, "pigment", other)),
    };
    let pattern_from_world = reader.affine()?;
    if !transform::is_invertible(&pattern_from_world) {
        return Err(reader.error("a pattern's transform that has no inverse"));
    }
    Ok(Pigment::Pattern {
        pattern,
        pattern_from_world,
    })
}

fn read_finish(reader: &mut ByteReader<'_>) -> Result<Finish, BytesError> {
    Ok(Finish {
        ambient: reader.vec3()?,
        emission: reader.vec3()?,
        diffuse: reader.f64()?,
        brilliance: reader.f64()?,
        phong: reader.f64()?,
        phong_size: reader.f64()?,
        specular: reader.f64()?,
        roughness: reader.f64()?,
        metallic: reader.f64()?,
        reflection: Reflection {
            min: reader.vec3()?,
            max: reader.vec3()?,
            fresnel: reader.bool()?,
            falloff: reader.f64()?,
            metallic: reader.f64()?,
        },
        conserve_energy: reader.bool()?,
    })
}

fn read_interior(reader: &mut ByteReader<'_>) -> Result<Interior, BytesError> {
    let (ior, absorption) = (reader.f64()?, reader.vec3()?);
    let fade = if reader.bool()? {
        Some(Fade {
            half_distance: reader.f64()?,
            power: reader.f64()?,
            color: reader.vec3()?,
        })
    } else {
        None
    };
    Ok(Interior {
        ior,
        absorption,
        fade,
    })
}

fn read_light(reader: &mut ByteReader<'_>) -> Result<Light, BytesError> {
    let kind = match reader.u8()? {
        0 => LightKind::Point {
            position: reader.vec3()?,
        },
        1 => LightKind::Spot {
            position: reader.vec3()?,
            direction: reader.vec3()?,
            inner: reader.f64()?,
            outer: reader.f64()?,
            tightness: reader.f64()?,
        },
        2 => LightKind::Directional {
            direction: reader.vec3()?,
        },
        other => return Err(unknown(reader, "light", other)),
    };
    let color: DVec3 = reader.vec3()?;
    let falloff = match reader.u8()? {
        0 => Falloff::None,
        1 => Falloff::InverseSquare,
        2 => Falloff::Fade {
            distance: reader.f64()?,
            power: reader.f64()?,
        },
        other => return Err(unknown(reader, "falloff", other)),
    };
    Ok(Light {
        kind,
        color,
        falloff,
        casts_shadows: reader.bool()?,
        makes_highlights: reader.bool()?,
    })
}
