/// The end of a directed edge.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EdgeEnd {
    /// The vertex that has the edge's two planes next to each other in the edge's order.
    pub(crate) vertex: u16,
    /// The vertex's third plane.
    pub(crate) across: u16,
}

#[derive(Debug, Clone, Copy)]
struct Slot {
    edge: [u16; 2],
    end: EdgeEnd,
}

/// No edge lies between a plane and itself.
const FREE: Slot = Slot { edge: [0, 0], end: EdgeEnd { vertex: 0, across: 0 } };

/// The ends of a cell's edges by the two planes that meet in the edge: a hash table of linear probing that is cleared often.
#[derive(Debug)]
pub(crate) struct EdgeEnds {
    slots: Vec<Slot>,
    count: usize,
}

impl Default for EdgeEnds {
    fn default() -> Self {
        // Three times the 27 vertices of a mean random cell fill a third.
        Self { slots: vec![FREE; 256], count: 0 }
    }
}

impl EdgeEnds {
    pub(crate) fn clear(&mut self) {
        self.slots.fill(FREE);
        self.count = 0;
    }

    pub(crate) fn get(&self, edge: [u16; 2]) -> Option<EdgeEnd> {
        let slot = self.slots[self.find(edge)];
        (slot.edge == edge).then_some(slot.end)
    }

    pub(crate) fn insert(&mut self, edge: [u16; 2], vertex: u16, across: u16) {
        if 2 * self.count >= self.slots.len() {
            let old = std::mem::take(&mut self.slots);
            self.slots = vec![FREE; 2 * old.len()];
            for slot in old.into_iter().filter(|slot| slot.edge != FREE.edge) {
                let place = self.find(slot.edge);
                self.slots[place] = slot;
            }
        }
        let place = self.find(edge);
        self.slots[place] = Slot { edge, end: EdgeEnd { vertex, across } };
        self.count += 1;
    }

    /// The slot that holds an edge, or the free one where it belongs.
    #[inline]
    fn find(&self, edge: [u16; 2]) -> usize {
        let mask = self.slots.len() - 1;
        // Small plane numbers, which most cells have, fall into slots of their own.
        let mut place = (usize::from(edge[0]) * 16 + usize::from(edge[1])) & mask;
        loop {
            let slot = &self.slots[place & mask];
            if slot.edge == edge || slot.edge == FREE.edge {
                return place & mask;
            }
            place += 1;
        }
    }
}
