//! Data as bytes: little endian, large arrays aligned, whatever the machine.
//!
//! What is read is not trusted: every size is compared with the bytes that are left before anything
//! is allocated, and everything that does not fit is an error that says where.

mod content_hash;
mod reader;
mod writer;

pub use content_hash::ContentHash;
pub use reader::{ByteReader, BytesError};
pub use writer::ByteWriter;

/// Arrays begin at multiples of this many bytes.
const ALIGNMENT: usize = 8;

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn what_is_written_is_read(
            byte in any::<u8>(),
            floats in proptest::collection::vec(any::<f64>(), 0..9),
            indices in proptest::collection::vec(any::<u32>(), 0..9),
            text in ".{0,9}",
            count in any::<u64>(),
        ) {
            let mut writer = ByteWriter::new();
            writer.u8(byte);
            writer.f64s(&floats);
            writer.str(&text);
            writer.u32s(&indices);
            writer.u64(count);
            writer.bool(true);
            let bytes = writer.into_bytes();
            let mut reader = ByteReader::new(&bytes);
            prop_assert_eq!(reader.u8(), Ok(byte));
            let read = reader.f64s().expect("floats");
            let bits = |all: &[f64]| all.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            prop_assert_eq!(bits(&read), bits(&floats));
            prop_assert_eq!(reader.str(), Ok(text.as_str()));
            prop_assert_eq!(reader.u32s(), Ok(indices));
            prop_assert_eq!(reader.u64(), Ok(count));
            prop_assert_eq!(reader.bool(), Ok(true));
            prop_assert!(reader.finish().is_ok());
            // Nothing shorter can be read to its end.
            for length in 0..bytes.len() {
                let mut reader = ByteReader::new(&bytes[..length]);
                let mut read = || -> Result<(), BytesError> {
                    reader.u8()?;
                    reader.f64s()?;
                    reader.str()?;
                    reader.u32s()?;
                    reader.u64()?;
                    reader.bool().map(|_| ())
                };
                prop_assert!(read().is_err());
            }
        }
    }

    #[test]
    fn a_huge_count_is_refused_before_memory_is_taken() {
        let mut writer = ByteWriter::new();
        writer.u64(u64::MAX / 8);
        let bytes = writer.into_bytes();
        let mut reader = ByteReader::new(&bytes);
        let error = reader.f64s().expect_err("there are no such numbers");
        assert_eq!(
            error.to_string(),
            "byte 8: more numbers than there are bytes"
        );
        assert!(ByteReader::new(&bytes).finish().is_err());
    }

    #[test]
    fn one_bit_changes_the_hash() {
        let bytes: Vec<u8> = (0..100).collect();
        let hash = ContentHash::of(&bytes);
        for at in 0..bytes.len() {
            for bit in 0..8 {
                let mut other = bytes.clone();
                other[at] ^= 1 << bit;
                assert_ne!(ContentHash::of(&other), hash);
            }
            assert_ne!(ContentHash::of(&bytes[..at]), hash);
        }
        // Zeros are told apart by how many they are.
        assert_ne!(ContentHash::of(&[0; 3]), ContentHash::of(&[0; 4]));
        assert_eq!(hash.to_string().len(), 32);
        assert_eq!(ContentHash::from_bytes(hash.to_bytes()), hash);
    }
}
