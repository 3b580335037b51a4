//! Seeds that benches have in common.

use glam::DVec3;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// Seeds in the unit cube, or flat ones in the unit square.
pub(crate) fn random_seeds(count: u32, is_flat: bool) -> Vec<DVec3> {
    let mut generator = ChaCha8Rng::seed_from_u64(1);
    let mut coordinate = || (generator.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
    let mut seed = || DVec3::new(coordinate(), coordinate(), if is_flat { 0.0 } else { coordinate() });
    (0..count).map(|_| seed()).collect()
}
