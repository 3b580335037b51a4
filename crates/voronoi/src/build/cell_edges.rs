use crate::exact::generator::Generator;

/// The edges of one cell, by the two planes that they run along: a hash table of linear probing.
pub(crate) struct CellEdges {
    /// Apart from the ends, which alone are looked at in slots that are free.
    keys: Vec<[Generator; 2]>,
    /// What the user knows each edge's first end by.
    ends: Vec<u32>,
    /// Slots that are not free.
    used: usize,
}

/// End of a slot that was never used.
const FREE: u32 = u32::MAX;
/// End of an edge of which both ends are known.
const CLOSED: u32 = u32::MAX - 1;

/// Slots of an ordinary cell: of its 40 edges, earlier cells know most.
const SLOTS: usize = 128;

impl CellEdges {
    pub(crate) fn new() -> Self {
        Self::with_slots(SLOTS)
    }

    fn with_slots(count: usize) -> Self {
        Self { keys: vec![[Generator::NONE; 2]; count], ends: vec![FREE; count], used: 0 }
    }

    /// Turns to another cell.
    pub(crate) fn clear(&mut self) {
        self.used = 0;
        self.keys.truncate(SLOTS);
        self.ends.truncate(SLOTS);
        self.ends.fill(FREE);
    }

    /// Gives an edge an end: returns the first one if this is the second.
    #[inline]
    pub(crate) fn add(&mut self, [a, b]: [Generator; 2], end: u32) -> Option<u32> {
        let key = [a.min(b), a.max(b)];
        let slot = self.slot(key);
        if self.ends[slot] != FREE {
            debug_assert!(self.ends[slot] != CLOSED, "an edge has two ends");
            return Some(std::mem::replace(&mut self.ends[slot], CLOSED));
        }
        (self.keys[slot], self.ends[slot]) = (key, end);
        self.used += 1;
        if 2 * self.used > self.ends.len() {
            self.grow();
        }
        None
    }

    /// The slot of an edge, or the free one that it would take.
    #[inline]
    fn slot(&self, key: [Generator; 2]) -> usize {
        let mask = self.ends.len() - 1;
        let mut slot = hash(key) & mask;
        while self.ends[slot] != FREE && self.keys[slot] != key {
            slot = (slot + 1) & mask;
        }
        slot
    }

    fn grow(&mut self) {
        let grown = Self { used: self.used, ..Self::with_slots(4 * self.ends.len()) };
        let old = std::mem::replace(self, grown);
        for (key, end) in old.keys.into_iter().zip(old.ends).filter(|(_, end)| *end != FREE) {
            let slot = self.slot(key);
            (self.keys[slot], self.ends[slot]) = (key, end);
        }
    }
}

/// Multiplication by odd constants without a pattern (the fractions of square roots of 2 and 3), of which high bits depend on all
/// bits of the key.
#[inline]
fn hash([a, b]: [Generator; 2]) -> usize {
    let mixed = u64::from(a.0).wrapping_mul(0x6a09_e667_f3bc_c909)
        ^ u64::from(b.0).wrapping_mul(0xbb67_ae85_84ca_a73b);
    (mixed >> 32) as usize
}
