//! One seed, split into named streams.

use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;

/// The generator of every random number in training.
pub type Generator = Xoshiro256PlusPlus;

/// The stream of random numbers with this name under this seed.
///
/// Streams are independent of each other and of the order in which they are made, so a part
/// that draws more does not disturb the others. The state of the generator is filled by
/// SplitMix64 from `seed` xor the 64-bit FNV-1a hash of the name.
#[must_use]
pub fn stream(seed: u64, name: &str) -> Generator {
    Generator::seed_from_u64(seed ^ fnv_1a(name.as_bytes()))
}

fn fnv_1a(bytes: &[u8]) -> u64 {
    const OFFSET: u64 = 0xcbf2_9ce4_8422_2325;
    const PRIME: u64 = 0x0000_0100_0000_01b3;
    bytes.iter().fold(OFFSET, |hash, &byte| {
        (hash ^ u64::from(byte)).wrapping_mul(PRIME)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_is_the_published_one() {
        // Test vectors of the FNV reference.
        assert_eq!(fnv_1a(b""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(fnv_1a(b"a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(fnv_1a(b"foobar"), 0x8594_4171_f739_67e8);
    }

    #[test]
    fn streams_differ_by_name_and_seed_and_repeat() {
        assert_eq!(stream(1, "actions"), stream(1, "actions"));
        assert_ne!(stream(1, "actions"), stream(2, "actions"));
        assert_ne!(stream(1, "actions"), stream(1, "minibatches"));
    }
}
