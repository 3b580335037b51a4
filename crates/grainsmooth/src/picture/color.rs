//! Colours that readers can tell apart, colour-blind ones too.

use std::collections::BTreeSet;

/// Red, green and blue, from 0 to 1.
pub(crate) type Color = [f64; 3];

/// For kinds: Okabe and Ito's without black, then grey.
const KINDS: [u32; 8] =
    [0xe6_9f00, 0x56_b4e9, 0x00_9e73, 0xf0_e442, 0x00_72b2, 0xd5_5e00, 0xcc_79a7, 0x99_9999];

/// By how much the colours are darker that come when all were taken.
const DARKER: f64 = 0.75;

pub(super) fn channels(color: colorous::Color) -> Color {
    [color.r, color.g, color.b].map(|channel| f64::from(channel) / 255.0)
}

/// The colour of a kind.
pub(super) fn kind(number: usize) -> Color {
    let shade = (0..number / KINDS.len()).fold(1.0, |shade, _| shade * DARKER);
    let [_, channels @ ..] = KINDS[number % KINDS.len()].to_be_bytes();
    channels.map(|channel| shade * f64::from(channel) / 255.0)
}

/// Numbers of kinds such that no two of a pair are alike: those with most kinds around them come first (Brelaz 1979).
pub(crate) fn differing(count: usize, pairs: impl IntoIterator<Item = [usize; 2]>) -> Vec<usize> {
    let mut beside = vec![BTreeSet::new(); count];
    for [a, b] in pairs.into_iter().filter(|[a, b]| a != b) {
        beside[a].insert(b);
        beside[b].insert(a);
    }
    let mut kinds = vec![None; count];
    let mut around = vec![BTreeSet::new(); count];
    // By the number of kinds around, the least first; of these the first in order.
    let mut waiting: BTreeSet<(usize, std::cmp::Reverse<usize>)> =
        (0..count).map(|one| (0, std::cmp::Reverse(one))).collect();
    while let Some((_, std::cmp::Reverse(one))) = waiting.pop_last() {
        let kind = (0..).find(|kind| !around[one].contains(kind)).unwrap_or_default();
        kinds[one] = Some(kind);
        for &other in &beside[one] {
            let known = around[other].len();
            if kinds[other].is_none() && around[other].insert(kind) {
                waiting.remove(&(known, std::cmp::Reverse(other)));
                waiting.insert((known + 1, std::cmp::Reverse(other)));
            }
        }
    }
    kinds.into_iter().map(Option::unwrap_or_default).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_differ() {
        // A wheel with an even rim takes three kinds, with an odd one four.
        for (rim, wanted) in [(6, 3), (7, 4)] {
            let pairs: Vec<[usize; 2]> = (0..rim).flat_map(|k| [[k, (k + 1) % rim], [k, rim]]).collect();
            let kinds = differing(rim + 1, pairs.iter().copied());
            assert!(pairs.iter().all(|[a, b]| kinds[*a] != kinds[*b]), "{kinds:?}");
            assert_eq!(kinds.iter().max().unwrap() + 1, wanted, "{kinds:?}");
        }
        assert_eq!(differing(2, [[1, 1]]), [0, 0]);
    }

    #[test]
    fn kinds_go_on_darker() {
        assert_eq!(kind(0), [230.0 / 255.0, 159.0 / 255.0, 0.0]);
        assert_eq!(kind(8)[0], 0.75 * kind(0)[0]);
    }
}
