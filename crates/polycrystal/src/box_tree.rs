//! A tree of boxes for finding what overlaps.

use glam::DVec3;

/// A box with sides along the axes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bounds {
    lower: DVec3,
    upper: DVec3,
}

impl Bounds {
    const EMPTY: Self = Self { lower: DVec3::INFINITY, upper: DVec3::NEG_INFINITY };

    /// The smallest box around some points.
    pub(crate) fn around(points: impl IntoIterator<Item = DVec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |bounds, point| Self {
            lower: bounds.lower.min(point),
            upper: bounds.upper.max(point),
        })
    }

    fn with(self, other: Self) -> Self {
        Self { lower: self.lower.min(other.lower), upper: self.upper.max(other.upper) }
    }

    /// The box with so much added on every side.
    pub(crate) fn widened(self, by: f64) -> Self {
        Self { lower: self.lower - by, upper: self.upper + by }
    }

    /// Whether the boxes have a point in common; touching counts.
    pub(crate) fn overlaps(&self, other: &Self) -> bool {
        self.lower.cmple(other.upper).all() && other.lower.cmple(self.upper).all()
    }

    pub(crate) fn size(&self) -> DVec3 {
        self.upper - self.lower
    }

    fn middle(&self) -> DVec3 {
        self.lower.midpoint(self.upper)
    }
}

/// Boxes by position in a list, sorted into a binary tree.
#[derive(Debug)]
pub(crate) struct BoxTree {
    /// Positions of the boxes in the list, and the boxes: those of each leaf together.
    items: Vec<(u32, Bounds)>,
    /// The root first; the first child of an inner node follows it.
    nodes: Vec<Node>,
}

#[derive(Debug, Clone, Copy)]
struct Node {
    bounds: Bounds,
    /// The items below.
    start: u32,
    end: u32,
    /// The second child of an inner node, 0 for leaves.
    second: u32,
}

/// Boxes in a leaf: fewer make the tree deeper, more make leaves that are compared in vain.
const LEAF_SIZE: usize = 6;

impl BoxTree {
    /// # Panics
    /// When there are 2^32 boxes or more.
    pub(crate) fn new(boxes: impl Iterator<Item = Bounds>) -> Self {
        let mut tree = Self { items: (0u32..).zip(boxes).collect(), nodes: Vec::new() };
        let count = tree.items.len();
        if count > 0 {
            tree.nodes.reserve(count.div_ceil(LEAF_SIZE / 2) * 2);
            tree.split(0, count);
        }
        tree
    }

    fn split(&mut self, start: usize, end: usize) -> u32 {
        let id = |index: usize| u32::try_from(index).expect("fewer boxes than 2^32");
        let items = &mut self.items[start..end];
        let bounds = items.iter().fold(Bounds::EMPTY, |bounds, (_, item)| bounds.with(*item));
        let node = self.nodes.len();
        self.nodes.push(Node { bounds, start: id(start), end: id(end), second: 0 });
        if items.len() > LEAF_SIZE {
            let axis = bounds.size().max_position();
            let half = items.len() / 2;
            items
                .select_nth_unstable_by(half, |(_, a), (_, b)| a.middle()[axis].total_cmp(&b.middle()[axis]));
            self.split(start, start + half);
            self.nodes[node].second = self.split(start + half, end);
        }
        id(node)
    }

    /// The box around all boxes, if there are any.
    pub(crate) fn bounds(&self) -> Option<&Bounds> {
        self.nodes.first().map(|root| &root.bounds)
    }

    /// Calls `found` with each two boxes of the tree that overlap.
    pub(crate) fn overlaps_within(&self, found: &mut impl FnMut(u32, u32)) {
        if !self.nodes.is_empty() {
            self.within(0, found);
        }
    }

    /// Calls `found` with each box of the tree and box of the other that overlap.
    pub(crate) fn overlaps_with(&self, other: &Self, found: &mut impl FnMut(u32, u32)) {
        if !self.nodes.is_empty() && !other.nodes.is_empty() {
            self.between(0, other, 0, found);
        }
    }

    fn within(&self, node: usize, found: &mut impl FnMut(u32, u32)) {
        let Node { start, end, second, .. } = self.nodes[node];
        if second == 0 {
            let items = &self.items[start as usize..end as usize];
            for (index, (a, bounds)) in items.iter().enumerate() {
                for (b, _) in items[index + 1..].iter().filter(|(_, other)| bounds.overlaps(other)) {
                    found(*a, *b);
                }
            }
            return;
        }
        let second = second as usize;
        self.within(node + 1, found);
        self.within(second, found);
        self.between(node + 1, self, second, found);
    }

    fn between(&self, node: usize, other: &Self, other_node: usize, found: &mut impl FnMut(u32, u32)) {
        let (here, there) = (&self.nodes[node], &other.nodes[other_node]);
        if !here.bounds.overlaps(&there.bounds) {
            return;
        }
        match (here.second, there.second) {
            (0, 0) => {
                let others = &other.items[there.start as usize..there.end as usize];
                for (a, bounds) in &self.items[here.start as usize..here.end as usize] {
                    if bounds.overlaps(&there.bounds) {
                        for (b, _) in others.iter().filter(|(_, other)| bounds.overlaps(other)) {
                            found(*a, *b);
                        }
                    }
                }
            }
            // The larger is split.
            (second, other_second)
                if other_second == 0 || (second != 0 && here.end - here.start > there.end - there.start) =>
            {
                self.between(node + 1, other, other_node, found);
                self.between(second as usize, other, other_node, found);
            }
            (_, other_second) => {
                self.between(node, other, other_node + 1, found);
                self.between(node, other, other_second as usize, found);
            }
        }
    }
}
