//! A scene as bytes, for other processes and machines: the same scene gives the same bytes, and
//! from them the same scene comes back, to the last bit.
//!
//! ```text
//! 0   "octray-S"            what it is
//! 8   version: u32, 0: u32
//! 16  hash of all that follows: 16 bytes
//! 32  meshes, solids, prototypes, names, objects, materials, lights, camera, background, settings
//! ```
//!
//! All is little endian; arrays of meshes and transforms begin at multiples of 8 bytes. Nothing of
//! what is read is trusted: sizes are compared with the bytes that are there, ids with what they
//! name, shapes go through their constructors and the whole through [`SceneBuilder::build`].

mod look;
mod objects;

use octray_math::bytes::{ByteReader, ByteWriter, BytesError, ContentHash};
use thiserror::Error;

use crate::{Scene, SceneBuilder, SceneError};

const MAGIC: &[u8; 8] = b"octray-S";
/// Counts changes of the format.
const VERSION: u32 = 1;
const HASH_AT: usize = 16;
const BODY_AT: usize = 32;

/// Why bytes are no scene.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SceneBytesError {
    /// Something else, or the beginning is missing.
    #[error("these bytes are not a scene of octray")]
    NotAScene,
    /// Written by another version of octray.
    #[error("the scene has version {0} of the format; this octray reads version {VERSION}")]
    Version(u32),
    /// Bytes were changed or lost on the way.
    #[error("the scene was damaged on its way: its hash is another")]
    Damaged,
    /// Not what can be a scene.
    #[error("the scene's bytes are wrong: {0}")]
    Malformed(#[from] BytesError),
    /// Read well, but not valid.
    #[error("the scene is not valid: {}", .0.first().map_or_else(String::new, ToString::to_string))]
    Invalid(Vec<SceneError>),
}

impl Scene {
    /// Everything in the scene as bytes.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut out = ByteWriter::new();
        out.raw(MAGIC);
        out.u32(VERSION);
        out.u32(0);
        out.raw(&[0; BODY_AT - HASH_AT]);
        objects::write(self, &mut out);
        look::write(self, &mut out);
        let mut bytes = out.into_bytes();
        let hash = ContentHash::of(&bytes[BODY_AT..]).to_bytes();
        bytes[HASH_AT..BODY_AT].copy_from_slice(&hash);
        bytes
    }

    /// The scene that [`Scene::to_bytes`] wrote.
    ///
    /// # Errors
    /// The bytes are not those of a valid scene.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, SceneBytesError> {
        let (hash, body) = Self::parts(bytes)?;
        if ContentHash::of(body) != hash {
            return Err(SceneBytesError::Damaged);
        }
        Self::from_body(bytes)
    }

    /// What tells this scene's bytes from those of others, as they say it themselves.
    ///
    /// # Errors
    /// The bytes are not those of a scene.
    pub fn hash_of_bytes(bytes: &[u8]) -> Result<ContentHash, SceneBytesError> {
        Self::parts(bytes).map(|(hash, _)| hash)
    }

    fn parts(bytes: &[u8]) -> Result<(ContentHash, &[u8]), SceneBytesError> {
        if !bytes.starts_with(MAGIC) {
            return Err(SceneBytesError::NotAScene);
        }
        let mut reader = ByteReader::starting_at(bytes, MAGIC.len());
        let version = reader.u32()?;
        if version != VERSION {
            return Err(SceneBytesError::Version(version));
        }
        if reader.u32()? != 0 {
            return Err(reader.error("a gap that is not empty").into());
        }
        let mut hash = [0; BODY_AT - HASH_AT];
        hash.copy_from_slice(reader.raw(BODY_AT - HASH_AT)?);
        Ok((ContentHash::from_bytes(hash), &bytes[BODY_AT..]))
    }

    fn from_body(bytes: &[u8]) -> Result<Self, SceneBytesError> {
        let mut reader = ByteReader::starting_at(bytes, BODY_AT);
        let mut builder = SceneBuilder::new();
        objects::read(&mut reader, &mut builder)?;
        look::read(&mut reader, &mut builder)?;
        reader.finish()?;
        builder.build().map_err(SceneBytesError::Invalid)
    }
}

#[cfg(test)]
mod tests;
