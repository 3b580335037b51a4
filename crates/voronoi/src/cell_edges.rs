use crate::generator::Generator;

/// The edges of one cell, by the two planes that they run along: a hash table of linear probing.
pub(crate) struct CellEdges {
    slots: Vec<Slot>,
    /// Slots that are not free.
    used: usize,
}

#[derive(Clone, Copy)]
struct Slot {
    key: [Generator; 2],
    /// What the user knows the edge's first end by.
    end: u32,
}

/// End of a slot that was never used.
const FREE: u32 = u32::MAX;
/// End of an edge of which both ends are known.
const CLOSED: u32 = u32::MAX - 1;

const FREE_SLOT: Slot = Slot { key: [Generator(0); 2], end: FREE };

/// Slots of an ordinary cell, which has 20 edges.
const SLOTS: usize = 128;

impl CellEdges {
    pub(crate) fn new() -> Self {
        Self { slots: vec![FREE_SLOT; SLOTS], used: 0 }
    }

    /// Turns to another cell.
    pub(crate) fn clear(&mut self) {
        self.used = 0;
        self.slots.truncate(SLOTS);
        self.slots.fill(FREE_SLOT);
    }

    /// Gives an edge an end: returns the first one if this is the second.
    #[inline]
    pub(crate) fn add(&mut self, [a, b]: [Generator; 2], end: u32) -> Option<u32> {
        let key = [a.min(b), a.max(b)];
        let mask = self.slots.len() - 1;
        let mut place = hash(key) & mask;
        loop {
            let slot = &mut self.slots[place];
            if slot.end == FREE {
                *slot = Slot { key, end };
                break;
            }
            if slot.key == key {
                debug_assert!(slot.end != CLOSED, "an edge has two ends");
                return Some(std::mem::replace(&mut slot.end, CLOSED));
            }
            place = (place + 1) & mask;
        }
        self.used += 1;
        if 2 * self.used > self.slots.len() {
            self.grow();
        }
        None
    }

    fn grow(&mut self) {
        let len = 4 * self.slots.len();
        let slots = std::mem::replace(&mut self.slots, vec![FREE_SLOT; len]);
        for slot in slots.into_iter().filter(|slot| slot.end != FREE) {
            let mut place = hash(slot.key) & (len - 1);
            while self.slots[place].end != FREE {
                place = (place + 1) & (len - 1);
            }
            self.slots[place] = slot;
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
