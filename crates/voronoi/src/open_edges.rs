use crate::generator::Generator;

/// Edges of which one end is known, by the three planes that they run along: a hash table of linear probing.
pub(crate) struct OpenEdges {
    slots: Vec<Slot>,
    /// Slots that are not free.
    used: usize,
}

/// The three generators of an edge, sorted.
pub(crate) type EdgeKey = [Generator; 3];

#[derive(Clone, Copy)]
struct Slot {
    key: EdgeKey,
    /// What the user knows the edge's first end by.
    end: u32,
}

/// End of a slot that was never used.
const FREE: u32 = u32::MAX;
/// End of an edge of which both ends are known.
const CLOSED: u32 = u32::MAX - 1;

const FREE_SLOT: Slot = Slot { key: [Generator(0); 3], end: FREE };

impl OpenEdges {
    pub(crate) fn new() -> Self {
        Self { slots: vec![FREE_SLOT; 1024], used: 0 }
    }

    /// Gives an edge an end: returns the first one if this is the second.
    #[inline]
    pub(crate) fn add(&mut self, key: EdgeKey, end: u32) -> Option<u32> {
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
            self.forget_closed();
        }
        None
    }

    /// Leaves only edges with one end in the table, and makes it large enough to be filled by at most a quarter.
    fn forget_closed(&mut self) {
        let open: Vec<Slot> = self.slots.iter().filter(|slot| slot.end < CLOSED).copied().collect();
        self.used = open.len();
        self.slots.fill(FREE_SLOT);
        let len = (4 * open.len()).next_power_of_two().max(self.slots.len());
        self.slots.resize(len, FREE_SLOT);
        for slot in open {
            let mut place = hash(slot.key) & (len - 1);
            while self.slots[place].end != FREE {
                place = (place + 1) & (len - 1);
            }
            self.slots[place] = slot;
        }
    }
}

/// Multiplication by odd constants without a pattern (the fractions of square roots of 2, 3 and 5), of which high bits depend on all bits of the key.
#[inline]
fn hash([a, b, c]: EdgeKey) -> usize {
    let mixed = u64::from(a.0).wrapping_mul(0x6a09_e667_f3bc_c909)
        ^ u64::from(b.0).wrapping_mul(0xbb67_ae85_84ca_a73b)
        ^ u64::from(c.0).wrapping_mul(0x3c6e_f372_fe94_f82b);
    (mixed >> 32) as usize
}
