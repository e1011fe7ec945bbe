//! Finished tiles as bytes: what a rendering has done so far, to go on with later or elsewhere.
//!
//! One format for a local rendering that was interrupted and for the tiles that come back from
//! the workers of a cluster. Nothing here touches files.
//!
//! ```text
//! 0   "octray-C"            what it is
//! 8   version: u32, 0: u32
//! 16  hash of the scene's bytes: 16 bytes
//! 32  hash of the settings ([`Plan::hash`]): 16 bytes
//! 48  records: tile, sums, hash of both
//! ```
//!
//! A record holds its tile as six `u32` (x, y, width, height, stride, refines), the number of bytes of
//! its sums as `u64`, for each of the tile's pixels in order the six sums as zigzag varints (LEB128),
//! and 16 bytes of hash. The sums are integers, so a picture put together from records in any
//! order, from any number of workers, has the same bits.

use octray_math::bytes::{ByteReader, ByteWriter, BytesError, ContentHash};
use thiserror::Error;

use crate::film::PixelSums;
use crate::tile::TileFilm;
use crate::{Crop, Film, Plan, Shows, Tile};

const MAGIC: &[u8; 8] = b"octray-C";
/// Counts changes of the format.
const VERSION: u32 = 1;
const RECORDS_AT: usize = 48;
/// A tile, the length of its sums, and the hash.
const LEAST_RECORD: usize = 24 + 8 + 16;

/// What a rendering is of: only parts of the same picture go together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JobId {
    /// Of the scene's bytes.
    pub scene: ContentHash,
    /// Of everything else that decides about the picture's bits.
    pub settings: ContentHash,
}

/// Why a checkpoint cannot be used.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum CheckpointError {
    /// Another kind of file.
    #[error("this is not a checkpoint of octray")]
    NotACheckpoint,
    /// Written by another version of octray.
    #[error("the checkpoint has version {0} of the format; this octray reads version {VERSION}")]
    Version(u32),
    /// Of another scene.
    #[error("the checkpoint is of another scene, or of this one before it was changed")]
    OtherScene,
    /// Of the same scene, rendered otherwise.
    #[error("the checkpoint is of this scene with other settings or by another version of octray")]
    OtherSettings,
    /// Bytes were changed or lost.
    #[error("the checkpoint is damaged: {0}")]
    Damaged(#[from] BytesError),
}

/// Finished tiles of one picture, as bytes.
#[derive(Clone, Debug)]
pub struct Checkpoint {
    bytes: ByteWriter,
    tiles: usize,
}

impl Checkpoint {
    /// Of a picture of which nothing is finished.
    #[must_use]
    pub fn new(job: &JobId) -> Self {
        let mut bytes = ByteWriter::new();
        bytes.raw(MAGIC);
        bytes.u32(VERSION);
        bytes.u32(0);
        bytes.raw(&job.scene.to_bytes());
        bytes.raw(&job.settings.to_bytes());
        Self { bytes, tiles: 0 }
    }

    /// Adds what [`tile_record`] gave.
    pub fn add(&mut self, record: &[u8]) {
        self.bytes.raw(record);
        self.tiles += 1;
    }

    /// How many tiles have been added.
    #[must_use]
    pub const fn tiles(&self) -> usize {
        self.tiles
    }

    /// All bytes of the file.
    #[must_use]
    pub fn as_bytes(&self) -> &[u8] {
        self.bytes.as_bytes()
    }
}

/// The records in a checkpoint of this job.
///
/// # Errors
/// It is of another job, or no checkpoint at all.
pub fn checkpoint_records<'a>(bytes: &'a [u8], job: &JobId) -> Result<&'a [u8], CheckpointError> {
    if !bytes.starts_with(MAGIC) {
        return Err(CheckpointError::NotACheckpoint);
    }
    let mut reader = ByteReader::starting_at(bytes, MAGIC.len());
    let version = reader.u32()?;
    if version != VERSION {
        return Err(CheckpointError::Version(version));
    }
    reader.u32()?;
    if reader.raw(16)? != job.scene.to_bytes() {
        return Err(CheckpointError::OtherScene);
    }
    if reader.raw(16)? != job.settings.to_bytes() {
        return Err(CheckpointError::OtherSettings);
    }
    Ok(&bytes[RECORDS_AT..])
}

/// A finished tile as a record.
#[must_use]
pub fn tile_record(tile: &Tile, light: &TileFilm) -> Vec<u8> {
    let mut sums = Vec::new();
    for pixel in tile.pixels() {
        for sum in light.sums(pixel).channels() {
            write_varint(sum, &mut sums);
        }
    }
    let mut out = ByteWriter::new();
    for x in [tile.x, tile.y, tile.width, tile.height, tile.stride] {
        out.u32(x);
    }
    out.u32(u32::from(tile.refines));
    out.u64(sums.len() as u64);
    out.raw(&sums);
    let hash = ContentHash::of(out.as_bytes());
    out.raw(&hash.to_bytes());
    out.into_bytes()
}

/// Puts the tiles of some records into a film; gives each tile, and the bytes of its record.
///
/// Records come from other machines and from files: what is not a tile of this film is refused, and
/// nothing of that record is taken.
///
/// # Errors
/// The first record that is damaged or not of this film.
pub fn place_records<'a>(
    records: &'a [u8],
    film: &mut Film,
) -> Result<Vec<(Tile, &'a [u8])>, CheckpointError> {
    let mut reader = ByteReader::new(records);
    let mut placed = Vec::new();
    while reader.left() > 0 {
        if reader.left() < LEAST_RECORD {
            return Err(reader.error("a record that is cut off").into());
        }
        let start = reader.position();
        let tile = read_tile(&mut reader, film.crop())?;
        let length = reader.count(1)?;
        let sums = reader.raw(length)?;
        let hash = ContentHash::of(&records[start..reader.position()]).to_bytes();
        if reader.raw(16)? != hash {
            return Err(reader.error("a record whose hash is another").into());
        }
        let mut sums = ByteReader::new(sums);
        let mut light = Vec::new();
        for _ in tile.pixels() {
            let mut channels = [0; 6];
            for channel in &mut channels {
                *channel = read_varint(&mut sums)?;
            }
            light.push(PixelSums::from_channels(channels));
        }
        sums.finish()?;
        for (pixel, light) in tile.pixels().zip(light) {
            film.finish_pixel(pixel, light);
        }
        placed.push((tile, &records[start..reader.position()]));
    }
    Ok(placed)
}

/// A tile that lies in the film.
fn read_tile(reader: &mut ByteReader<'_>, crop: Crop) -> Result<Tile, BytesError> {
    let tile = Tile {
        x: reader.u32()?,
        y: reader.u32()?,
        width: reader.u32()?,
        height: reader.u32()?,
        stride: reader.u32()?,
        refines: reader.u32()? != 0,
    };
    let fits = |start: u32, length: u32, whole: u32| {
        length > 0 && u64::from(start) + u64::from(length) <= u64::from(whole)
    };
    // A pixel takes at least six bytes, so the work is in proportion to what is there.
    let stride = tile.stride;
    let pixels = u64::from(tile.width.div_ceil(stride.max(1)))
        * u64::from(tile.height.div_ceil(stride.max(1)));
    let is_tile = (1..=64).contains(&stride)
        && fits(tile.x, tile.width, crop.width)
        && fits(tile.y, tile.height, crop.height)
        && tile.x.is_multiple_of(stride)
        && tile.y.is_multiple_of(stride)
        && pixels <= reader.left() as u64;
    if is_tile {
        Ok(tile)
    } else {
        Err(reader.error("a tile that does not lie in the picture"))
    }
}

fn write_varint(value: i64, out: &mut Vec<u8>) {
    // Zigzag: small numbers of either sign are short.
    let mut rest = ((value << 1) ^ (value >> 63)) as u64;
    while rest >= 0x80 {
        out.push(rest as u8 | 0x80);
        rest >>= 7;
    }
    out.push(rest as u8);
}

fn read_varint(reader: &mut ByteReader<'_>) -> Result<i64, BytesError> {
    let mut value: u64 = 0;
    for shift in (0..64).step_by(7) {
        let byte = reader.u8()?;
        value |= u64::from(byte & 0x7f) << shift;
        if byte & 0x80 == 0 {
            return Ok((value >> 1) as i64 ^ -((value & 1) as i64));
        }
    }
    Err(reader.error("a number that is too long"))
}

impl Plan {
    /// Of everything that, besides the scene, decides about the picture's bits: the order in which
    /// its pixels are rendered does not.
    #[must_use]
    pub fn hash(&self) -> ContentHash {
        let mut out = ByteWriter::new();
        // Other versions may shade otherwise.
        out.str(env!("CARGO_PKG_VERSION"));
        let crop = self.crop;
        for x in [self.size.0, self.size.1, crop.x, crop.y] {
            out.u32(x);
        }
        for x in [crop.width, crop.height, self.spp, self.max_generations] {
            out.u32(x);
        }
        out.f64(self.contribution_threshold);
        out.u64(self.seed);
        out.u8(match self.shows {
            Shows::Light => 0,
            Shows::Cost => 1,
        });
        ContentHash::of(out.as_bytes())
    }
}
