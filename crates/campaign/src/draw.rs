//! Random numbers of one run.

use std::ops::RangeInclusive;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// The random numbers of one run. They follow from the campaign's seed and the run's index alone.
#[derive(Debug, Clone)]
pub struct Draw(ChaCha8Rng);

impl Draw {
    /// The numbers of run `index`: stream `index` of the generator that `seed` starts.
    pub fn of_run(seed: u64, index: u64) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(index);
        Self(generator)
    }

    /// A number in [0, 1).
    pub fn fraction(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 * 2f64.powi(-53)
    }

    /// True in this share of cases.
    pub fn chance(&mut self, share: f64) -> bool {
        self.fraction() < share
    }

    /// A number between two, uniform.
    pub fn between(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * self.fraction()
    }

    /// A positive number between two whose logarithm is uniform.
    pub fn magnitude(&mut self, least: f64, most: f64) -> f64 {
        (least.ln() + (most / least).ln() * self.fraction()).exp()
    }

    /// A number of things from 1 to `most` whose logarithm is uniform.
    pub fn count(&mut self, most: u32) -> u32 {
        let count = self.magnitude(1.0, f64::from(most) + 1.0);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "from 1 to below most + 1"
        )]
        let whole = count as u32;
        whole.min(most)
    }

    /// A whole number, each alike.
    pub fn whole(&mut self, range: RangeInclusive<u32>) -> u32 {
        let count = u64::from(range.end() - range.start()) + 1;
        // A remainder below 2^32 fits, and of 64 bits its bias is far below what a campaign can tell.
        range.start() + u32::try_from(self.0.next_u64() % count).unwrap_or(0)
    }

    /// One of some values, each alike.
    ///
    /// # Panics
    /// When there are none.
    pub fn one_of<T: Copy>(&mut self, values: &[T]) -> T {
        let last = u32::try_from(values.len() - 1).unwrap_or(u32::MAX);
        values[self.whole(0..=last) as usize]
    }

    /// One of some values, each as often as its weight says.
    ///
    /// # Panics
    /// When there are none.
    pub fn weighted<T: Copy>(&mut self, values: &[(f64, T)]) -> T {
        let mut place = self.fraction() * values.iter().map(|(weight, _)| weight).sum::<f64>();
        let chosen = values.iter().find(|(weight, _)| {
            place -= weight;
            place < 0.0
        });
        chosen.unwrap_or(&values[values.len() - 1]).1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(seed: u64, index: u64) -> Vec<f64> {
        let mut draw = Draw::of_run(seed, index);
        (0..5).map(|_| draw.fraction()).collect()
    }

    #[test]
    fn run_draws_the_same_numbers_whatever_ran_before() {
        assert_eq!(numbers(7, 731), numbers(7, 731));
        assert_ne!(numbers(7, 731), numbers(7, 732));
        assert_ne!(numbers(7, 731), numbers(8, 731));
    }

    #[test]
    fn numbers_keep_to_their_ranges() {
        let mut draw = Draw::of_run(1, 0);
        let mut seen = [0; 3];
        for _ in 0..1000 {
            assert!((2.0..3.0).contains(&draw.between(2.0, 3.0)));
            assert!((1e-9..1e6).contains(&draw.magnitude(1e-9, 1e6)));
            assert!((1..=9).contains(&draw.count(9)));
            seen[draw.whole(0..=2) as usize] += 1;
            assert!(draw.weighted(&[(1.0, true), (0.0, false)]));
        }
        // Of 1000 draws a third each, within five standard deviations of sqrt(1000 2/9).
        assert!(seen.iter().all(|count| (259..408).contains(count)), "{seen:?}");
    }
}
