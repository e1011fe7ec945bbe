use std::fmt;

use crate::{hash_combine, hash_u64};

/// 128 bits that tell contents apart. It finds accidents, not forgers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ContentHash([u64; 2]);

/// Chains that do not wait for each other.
const LANES: usize = 4;

impl ContentHash {
    /// The hash of these bytes and their number.
    #[must_use]
    pub fn of(bytes: &[u8]) -> Self {
        let mut lanes: [u64; LANES] = std::array::from_fn(|lane| hash_u64(lane as u64));
        let word = |bytes: &[u8]| {
            let mut word = [0; 8];
            word[..bytes.len()].copy_from_slice(bytes);
            u64::from_le_bytes(word)
        };
        for block in bytes.chunks(8 * LANES) {
            for (lane, part) in lanes.iter_mut().zip(block.chunks(8)) {
                *lane = hash_u64(*lane ^ word(part));
            }
        }
        let fold = |seed: u64| {
            lanes
                .iter()
                .fold(seed, |key, lane| hash_combine(key, *lane))
        };
        let length = bytes.len() as u64;
        Self([fold(length), fold(!length)])
    }

    /// As 16 bytes.
    #[must_use]
    pub fn to_bytes(self) -> [u8; 16] {
        (u128::from(self.0[0]) | u128::from(self.0[1]) << 64).to_le_bytes()
    }

    /// What [`ContentHash::to_bytes`] gave.
    #[must_use]
    pub fn from_bytes(bytes: [u8; 16]) -> Self {
        let both = u128::from_le_bytes(bytes);
        Self([both as u64, (both >> 64) as u64])
    }
}

impl fmt::Display for ContentHash {
    /// 32 hexadecimal digits.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:016x}{:016x}", self.0[0], self.0[1])
    }
}
