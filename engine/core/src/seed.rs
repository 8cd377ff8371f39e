//! One seed, split into named streams.

/// The seed of a named stream: equal names give equal streams, and a stream that is added later
/// changes none of the others.
///
/// FNV-1a over the name, mixed with the seed by the finaliser of SplitMix64 (Steele et al. 2014).
pub fn stream(seed: u64, name: &str) -> u64 {
    mix(fnv_1a(name.as_bytes()) ^ mix(seed))
}

fn fnv_1a(bytes: &[u8]) -> u64 {
    const OFFSET: u64 = 0xcbf2_9ce4_8422_2325;
    const PRIME: u64 = 0x0000_0100_0000_01b3;
    bytes.iter().fold(OFFSET, |hash, &byte| {
        (hash ^ u64::from(byte)).wrapping_mul(PRIME)
    })
}

fn mix(value: u64) -> u64 {
    let value = value.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let value = (value ^ (value >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let value = (value ^ (value >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    value ^ (value >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_differ_by_name_and_by_seed() {
        let streams = [
            stream(1, "filter"),
            stream(1, "driver"),
            stream(2, "filter"),
            stream(2, "driver"),
        ];
        for (index, one) in streams.iter().enumerate() {
            for other in &streams[index + 1..] {
                assert_ne!(one, other);
            }
        }
    }

    #[test]
    fn hash_and_finaliser_are_the_published_ones() {
        // Test vectors of the FNV reference.
        assert_eq!(fnv_1a(b""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(fnv_1a(b"a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(fnv_1a(b"foobar"), 0x8594_4171_f739_67e8);
        // SplitMix64 from state 0 gives 0xe220a8397b1dcdaf first (reference implementation).
        assert_eq!(mix(0), 0xe220_a839_7b1d_cdaf);
    }
}
