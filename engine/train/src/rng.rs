//! One seed, split into named streams.

use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;

/// The generator of every random number in training.
pub type Generator = Xoshiro256PlusPlus;

/// The stream of random numbers with this name under this seed.
///
/// Streams are independent of each other and of the order in which they are made, so a part
/// that draws more does not disturb the others. Their seeds are those of
/// [`pubs_core::seed::stream`].
#[must_use]
pub fn stream(seed: u64, name: &str) -> Generator {
    Generator::seed_from_u64(pubs_core::seed::stream(seed, name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_differ_by_name_and_seed_and_repeat() {
        assert_eq!(stream(1, "actions"), stream(1, "actions"));
        assert_ne!(stream(1, "actions"), stream(2, "actions"));
        assert_ne!(stream(1, "actions"), stream(1, "minibatches"));
    }
}
