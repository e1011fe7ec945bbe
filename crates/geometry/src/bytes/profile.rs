//! Prisms, lathes and concave polyhedra as what they are made from.

use std::sync::Arc;

use octray_math::bytes::{ByteReader, ByteWriter, BytesError};
use octray_math::{DVec2, DVec3};

use crate::boundary::Boundary;
use crate::profile::{Curve, MAX_EDGES, Piece, Region, Turning};
use crate::{Primitive, ShapeError, Solid, polyhedron};

const PRISM: u8 = 0;
const LATHE: u8 = 1;
const POLYHEDRON: u8 = 2;

const LINE: u8 = 0;
const ARC: u8 = 1;
const BEZIER: u8 = 2;

/// Facets that a lathe in steps may have at most.
const MAX_FACETS: usize = 1 << 24;

pub(super) fn write(boundary: &Boundary, out: &mut ByteWriter) {
    match boundary {
        Boundary::Prism { pieces, z, scale } => {
            out.u8(PRISM);
            write_pieces(pieces, out);
            [z[0], z[1], scale[0], scale[1]]
                .into_iter()
                .for_each(|x| out.f64(x));
        }
        Boundary::Lathe { pieces, turning } => {
            out.u8(LATHE);
            write_pieces(pieces, out);
            out.f64(turning.start);
            out.f64(turning.sweep);
            out.bool(turning.steps.is_some());
            out.u32(turning.steps.unwrap_or_default());
        }
        Boundary::Triangles { source, .. } => {
            out.u8(POLYHEDRON);
            out.f64s(bytemuck::cast_slice(&source.vertices));
            out.u64(source.faces.len() as u64);
            source.faces.iter().for_each(|face| out.u32s(face));
        }
    }
}

pub(super) fn read(reader: &mut ByteReader<'_>) -> Result<Result<Solid, ShapeError>, BytesError> {
    Ok(match reader.u8()? {
        PRISM => {
            let region = read_region(reader)?;
            let z = [reader.f64()?, reader.f64()?];
            let scale = [reader.f64()?, reader.f64()?];
            region.and_then(|region| Solid::tapered_prism(&region, z, scale))
        }
        LATHE => {
            let region = read_region(reader)?;
            let mut turning = Turning {
                start: reader.f64()?,
                sweep: reader.f64()?,
                steps: None,
            };
            let has_steps = reader.bool()?;
            let steps = reader.u32()?;
            turning.steps = has_steps.then_some(steps);
            region.and_then(|region| {
                if steps as usize > MAX_FACETS / region.pieces().len().max(1) {
                    return Err(ShapeError::BadProfile("is too intricate"));
                }
                Solid::turned_lathe(&region, turning)
            })
        }
        POLYHEDRON => {
            let numbers = reader.f64s()?;
            let (rows, rest) = numbers.as_chunks::<3>();
            if !rest.is_empty() {
                return Err(reader.error("an array that ends within a row"));
            }
            let vertices: Vec<DVec3> = rows.iter().copied().map(Into::into).collect();
            let count = reader.count(8)?;
            let mut faces = Vec::with_capacity(count);
            for _ in 0..count {
                faces.push(reader.u32s()?);
            }
            if vertices.iter().any(|v| !v.is_finite()) {
                return Err(reader.error("a corner that is not finite"));
            }
            polyhedron::polyhedron(&vertices, &faces)
                .map(|made| Solid::primitive(Primitive::Composite(Arc::new(made))))
        }
        other => return Err(reader.error(format_args!("a composite of unknown kind {other}"))),
    })
}

fn write_pieces(pieces: &[Piece], out: &mut ByteWriter) {
    out.u64(pieces.len() as u64);
    for piece in pieces {
        match piece {
            Piece::Line(a, b) => {
                out.u8(LINE);
                out.vec2(*a);
                out.vec2(*b);
            }
            Piece::Arc { center, ends } => {
                out.u8(ARC);
                out.vec2(*center);
                ends.iter().for_each(|end| out.vec2(*end));
            }
            Piece::Bezier(curve) => {
                let points = curve.weighted_points();
                out.u8(BEZIER);
                out.u8(points.len() as u8);
                points.iter().for_each(|p| out.vec3(*p));
            }
        }
    }
}

fn read_region(reader: &mut ByteReader<'_>) -> Result<Result<Region, ShapeError>, BytesError> {
    let count = reader.count(33)?;
    // Every edge may have become a few pieces.
    if count > 64 * MAX_EDGES {
        return Err(reader.error("a profile of too many edges"));
    }
    let mut pieces = Vec::with_capacity(count);
    for _ in 0..count {
        pieces.push(match reader.u8()? {
            LINE => Piece::Line(reader.vec2()?, reader.vec2()?),
            ARC => {
                let (center, ends) = (reader.vec2()?, [reader.vec2()?, reader.vec2()?]);
                let [u, v]: [DVec2; 2] = ends.map(|p| p - center);
                let square = 0.5 * (u.length_squared() + v.length_squared());
                // At most a quarter turn, but for rounding; written so that NaN fails.
                let turns_little = u.dot(v) > -0.5 * square;
                if !turns_little {
                    return Err(reader.error("an arc that turns too far"));
                }
                Piece::Arc { center, ends }
            }
            BEZIER => {
                let mut points = [DVec3::ZERO; 4];
                let count = usize::from(reader.u8()?);
                if !(2..=points.len()).contains(&count) {
                    return Err(reader.error("a curve of another degree"));
                }
                for point in &mut points[..count] {
                    *point = reader.vec3()?;
                }
                let curve = Curve::from_weighted(&points[..count]);
                Piece::Bezier(curve.ok_or_else(|| reader.error("a curve without weight"))?)
            }
            other => return Err(reader.error(format_args!("an edge of unknown kind {other}"))),
        });
    }
    Ok(Region::from_pieces(pieces))
}
