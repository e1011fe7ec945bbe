//! The one source of randomness: hashes of what a sample is, never of when it was made.

/// A bijective mix of 64 bits (`splitmix64` finaliser, Steele, Lea & Flood 2014).
#[must_use]
pub const fn hash_u64(value: u64) -> u64 {
    let mut z = value.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// The key of the child `branch` of the path or object named `parent`.
#[must_use]
pub const fn hash_combine(parent: u64, branch: u64) -> u64 {
    hash_u64(hash_u64(parent) ^ branch.wrapping_mul(0xd6e8_feb8_6659_fd93))
}

/// A key as a number in `[0, 1)` with 53 random bits.
#[must_use]
pub fn unit_f64(key: u64) -> f64 {
    (key >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn branches_differ_and_numbers_stay_in_range() {
        let mut seen = std::collections::BTreeSet::new();
        let mut mean = 0.0;
        for branch in 0..4096 {
            let key = hash_combine(7, branch);
            assert!(seen.insert(key));
            let u = unit_f64(key);
            assert!((0.0..1.0).contains(&u));
            mean += u / 4096.0;
        }
        assert!((mean - 0.5).abs() < 0.02, "{mean}");
    }
}
