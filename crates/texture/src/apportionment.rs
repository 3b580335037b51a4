//! Volumes given to parts, each of which is to have a share of them.

/// What parts of a whole still lack.
///
/// Given the largest first, each volume goes to the part that lacks most of its share, half of the volume itself counted as there (Webster's
/// divisors): so parts get volumes alike in size. By what they lack absolutely, a part with a fifth of the whole had a mean diameter of
/// 0.77 of the others'.
#[derive(Debug, Clone, PartialEq)]
pub struct Apportionment {
    shares: Vec<f64>,
    lacking: Vec<f64>,
}

impl Apportionment {
    /// Parts with shares of a volume, of which none is given yet.
    pub fn new(shares: Vec<f64>, total: f64) -> Self {
        let lacking = shares.iter().map(|share| share * total).collect();
        Self { shares, lacking }
    }

    /// Gives a volume to one of some parts, of equal claims to the first; nothing where there are none.
    ///
    /// # Panics
    /// When a part is not one of these.
    pub fn give(&mut self, volume: f64, parts: impl Iterator<Item = usize>) -> Option<usize> {
        let claim = |part: usize| (self.lacking[part] - 0.5 * volume) / self.shares[part];
        let part = parts.reduce(|best, part| if claim(part) > claim(best) { part } else { best })?;
        self.lacking[part] -= volume;
        Some(part)
    }
}
