//! Numbers for the page: a head of JSON, then arrays. Text would take three times the bytes, and bytes are time.

use serde::Serialize;

/// Most runs of an array: above, what lies between them is sent too.
const MOST_RUNS: usize = 2048;

/// Runs with fewer words between them are one: a run takes as many in the head.
const SHORTEST_GAP: usize = 4;

/// Words that are compared together.
const BLOCK: usize = 1024;

/// Places of points by number, in order.
pub(super) type Places = Vec<(u32, [f32; 3])>;

/// Arrays on their way to the page.
#[derive(Debug, Default)]
pub(super) struct Packed {
    arrays: Vec<Array>,
}

#[derive(Debug)]
struct Array {
    name: &'static str,
    /// `f32`, `u32` or `i8`.
    kind: &'static str,
    /// Little-endian, as browsers have them.
    words: Vec<u32>,
    /// First and number of the words that have changed since the page heard of them; of what it never heard, nothing.
    runs: Option<Vec<[usize; 2]>>,
}

/// An array, for the page.
#[derive(Serialize)]
struct Sent<'a> {
    name: &'static str,
    kind: &'static str,
    /// How many words of four bytes.
    words: usize,
    /// Which of them come, if not all.
    #[serde(skip_serializing_if = "Option::is_none")]
    runs: Option<&'a [[usize; 2]]>,
}

/// The head with what comes behind it.
#[derive(Serialize)]
struct Head<'a, T> {
    #[serde(flatten)]
    content: &'a T,
    arrays: Vec<Sent<'a>>,
}

impl Packed {
    pub(super) fn floats(&mut self, name: &'static str, numbers: impl IntoIterator<Item = f32>) {
        self.add(name, "f32", numbers.into_iter().map(|number| number.to_bits().to_le()));
    }

    pub(super) fn ids(&mut self, name: &'static str, numbers: impl IntoIterator<Item = u32>) {
        self.add(name, "u32", numbers.into_iter().map(u32::to_le));
    }

    /// Tuples of numbers from -128 to 127.
    pub(super) fn small(&mut self, name: &'static str, tuples: impl IntoIterator<Item = [i8; 4]>) {
        self.add(name, "i8", tuples.into_iter().map(bytemuck::cast));
    }

    fn add(&mut self, name: &'static str, kind: &'static str, words: impl Iterator<Item = u32>) {
        self.arrays.push(Array { name, kind, words: words.collect(), runs: None });
    }

    /// Leaves out what the page has heard before.
    pub(super) fn leave_out(&mut self, before: &Self) {
        for array in &mut self.arrays {
            let known =
                before.arrays.iter().find(|known| (known.name, known.kind) == (array.name, array.kind));
            array.runs = known.map(|known| changed_runs(&known.words, &array.words));
        }
    }

    /// Places some points of arrays of floats anew, by number and in order; the page hears of nothing else.
    pub(super) fn place(&mut self, points: &[(&str, Places)]) {
        for Array { name, words, runs, .. } in &mut self.arrays {
            let runs = runs.insert(Vec::new());
            let moved = points.iter().find(|(moved, _)| moved == name);
            for (point, place) in moved.into_iter().flat_map(|(_, points)| points) {
                let start = 3 * *point as usize;
                words[start..start + 3]
                    .copy_from_slice(&place.map(|coordinate| coordinate.to_bits().to_le()));
                add_run(runs, start, 3);
            }
        }
    }

    /// The head's length as a 32-bit number, the head, filled up with blanks, and the arrays, or their runs, in the order in which they came.
    pub(super) fn bytes(&self, content: &impl Serialize) -> serde_json::Result<Vec<u8>> {
        let arrays = self.arrays.iter().map(|Array { name, kind, words, runs }| Sent {
            name,
            kind,
            words: words.len(),
            runs: runs.as_deref(),
        });
        let mut head = serde_json::to_vec(&Head { content, arrays: arrays.collect() })?;
        head.resize(head.len().next_multiple_of(4), b' ');
        // Heads tell a few facts a grain: far from 4 GB.
        let length = u32::try_from(head.len()).unwrap_or(u32::MAX);
        let mut bytes = [&length.to_le_bytes()[..], &head].concat();
        for Array { words, runs, .. } in &self.arrays {
            match runs {
                None => bytes.extend_from_slice(bytemuck::cast_slice(words)),
                Some(runs) => {
                    for [start, count] in runs {
                        bytes.extend_from_slice(bytemuck::cast_slice(&words[*start..start + count]));
                    }
                }
            }
        }
        Ok(bytes)
    }
}

/// Where words differ from those before, or are more.
fn changed_runs(before: &[u32], now: &[u32]) -> Vec<[usize; 2]> {
    let mut runs = Vec::new();
    let common = before.len().min(now.len());
    let blocks = before[..common].chunks(BLOCK).zip(now[..common].chunks(BLOCK)).enumerate();
    for (block, (before, now)) in blocks.filter(|(_, (before, now))| before != now) {
        let words = before.iter().zip(now).enumerate();
        for (word, _) in words.filter(|(_, (before, now))| before != now) {
            add_run(&mut runs, block * BLOCK + word, 1);
        }
    }
    if now.len() > common {
        add_run(&mut runs, common, now.len() - common);
    }
    match (runs.first(), runs.last()) {
        (Some(&[start, _]), Some(&[last, count])) if runs.len() > MOST_RUNS => {
            vec![[start, last + count - start]]
        }
        _ => runs,
    }
}

/// Adds a run behind the others, or makes the last one longer.
fn add_run(runs: &mut Vec<[usize; 2]>, start: usize, count: usize) {
    match runs.last_mut() {
        Some([last, length]) if start < *last + *length + SHORTEST_GAP => *length = start + count - *last,
        _ => runs.push([start, count]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parts(bytes: &[u8]) -> (serde_json::Value, &[u8]) {
        let length = u32::from_le_bytes(bytes[..4].try_into().unwrap()) as usize;
        (serde_json::from_slice(&bytes[4..4 + length]).unwrap(), &bytes[4 + length..])
    }

    #[test]
    fn arrays_stand_behind_the_head() {
        let mut packed = Packed::default();
        packed.small("a", [[1, -2, 3, 0]]);
        packed.floats("b", [0.5]);
        packed.ids("c", [7, 8]);
        let bytes = packed.bytes(&serde_json::json!({ "x": 1 })).unwrap();
        let (head, arrays) = parts(&bytes);
        assert_eq!((&head["x"], &head["arrays"][1]["name"]), (&1.into(), &"b".into()));
        assert_eq!(arrays[..4], [1, 254, 3, 0]);
        assert_eq!(arrays[4..8], 0.5_f32.to_le_bytes());
        assert_eq!(arrays[8..], [7, 0, 0, 0, 8, 0, 0, 0]);
    }

    #[test]
    fn what_is_known_is_left_out() {
        let packed = |ids: Vec<u32>| {
            let mut packed = Packed::default();
            packed.ids("ids", ids);
            packed.floats("same", [1.0, 2.0]);
            packed
        };
        let before = packed((0..5000).collect());
        let mut ids: Vec<u32> = (0..5002).collect();
        (ids[10], ids[12], ids[3000]) = (1, 1, 1);
        let mut now = packed(ids);
        now.leave_out(&before);
        let bytes = now.bytes(&()).unwrap();
        let (head, words) = parts(&bytes);
        assert_eq!(head["arrays"][0]["runs"], serde_json::json!([[10, 3], [3000, 1], [5000, 2]]));
        assert_eq!(
            (&head["arrays"][0]["words"], &head["arrays"][1]["runs"]),
            (&5002.into(), &serde_json::json!([]))
        );
        let words: Vec<u32> = words.as_chunks::<4>().0.iter().map(|word| u32::from_le_bytes(*word)).collect();
        assert_eq!(words, [1, 11, 1, 1, 5000, 5001]);
        // All of it, where runs would be too many.
        let mut all = packed((0..5000).map(|id| id + u32::from(id % 8 == 0)).chain(0..50_000).collect());
        all.leave_out(&packed((0..5000).chain((0..50_000).map(|id| id + u32::from(id % 8 == 0))).collect()));
        assert_eq!(all.arrays[0].runs.as_ref().unwrap().len(), 1);
    }

    #[test]
    fn points_are_placed_anew() {
        let mut packed = Packed::default();
        packed.ids("ids", [3]);
        packed.floats("points", [0.0; 30]);
        packed.place(&[("points", vec![(1, [1.0; 3]), (2, [2.0; 3]), (9, [9.0; 3])])]);
        let bytes = packed.bytes(&()).unwrap();
        let (head, words) = parts(&bytes);
        assert_eq!(head["arrays"][0]["runs"], serde_json::json!([]));
        assert_eq!(head["arrays"][1]["runs"], serde_json::json!([[3, 6], [27, 3]]));
        assert_eq!((words.len(), &words[32..]), (36, &9.0_f32.to_le_bytes()[..]));
    }
}
