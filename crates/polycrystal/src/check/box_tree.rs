//! A tree of boxes for finding what overlaps.

use glam::DVec3;
use rayon::prelude::*;

use crate::mesh::id::id;

/// A box with sides along the axes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bounds {
    lower: DVec3,
    upper: DVec3,
}

impl Default for Bounds {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl Bounds {
    /// Around nothing: overlaps nothing.
    const EMPTY: Self = Self { lower: DVec3::INFINITY, upper: DVec3::NEG_INFINITY };

    /// The smallest box around some points.
    #[inline]
    pub(crate) fn around(points: impl IntoIterator<Item = DVec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::with_point)
    }

    #[inline]
    pub(crate) fn with_point(self, point: DVec3) -> Self {
        Self { lower: self.lower.min(point), upper: self.upper.max(point) }
    }

    /// Around the ray along x from a point.
    pub(crate) fn of_ray(from: DVec3) -> Self {
        Self { lower: from, upper: from.with_x(f64::INFINITY) }
    }

    #[inline]
    pub(crate) fn with(self, other: Self) -> Self {
        Self { lower: self.lower.min(other.lower), upper: self.upper.max(other.upper) }
    }

    /// The box with so much added on every side.
    pub(crate) fn widened(self, by: f64) -> Self {
        Self { lower: self.lower - by, upper: self.upper + by }
    }

    /// Whether the boxes have a point in common; touching counts.
    #[inline]
    pub(crate) fn overlaps(&self, other: &Self) -> bool {
        self.lower.cmple(other.upper).all() && other.lower.cmple(self.upper).all()
    }

    #[inline]
    pub(crate) fn lower(&self) -> DVec3 {
        self.lower
    }

    #[inline]
    pub(crate) fn size(&self) -> DVec3 {
        self.upper - self.lower
    }

    /// The squared distance of a point from the box; 0 within it.
    #[inline]
    fn squared_distance(&self, point: DVec3) -> f64 {
        point.distance_squared(point.clamp(self.lower, self.upper))
    }

    #[inline]
    fn middle(&self) -> DVec3 {
        self.lower.midpoint(self.upper)
    }
}

/// Items and the boxes around groups of them. The boxes of the items themselves are asked for where they are needed: most never are.
#[derive(Debug)]
pub(crate) struct BoxTree {
    /// The items, those of each leaf together.
    items: Vec<u32>,
    /// Boxes of the leaves, then of each few of these, and so on to the root.
    boxes: Vec<Bounds>,
}

/// Items in a leaf, and nodes in a node above; powers of two. Four and eight are as good.
const LEAF_SIZE: usize = 8;
const BRANCHES: usize = 4;

/// How many times as large as those of the items the squared diagonals of the leaves may be, all in all, for the items to stay in
/// the order in which they come. Eight neighbours of a surface have once to four times as much, of a line eight times, strewn
/// items as many times as there are leaves.
const LARGEST_SPREAD: f64 = 16.0;

/// Leaves whose overlaps one task looks for: enough to be worth a task, and few enough for all threads to have some.
const LEAVES_PER_TASK: usize = 64;

/// Most items that one task sorts.
const SORTED_BY_ONE: usize = 4096;

/// A node: its level above the leaves, and its number there and in the list of all boxes.
#[derive(Debug, Clone, Copy)]
struct Node {
    level: u32,
    index: usize,
    place: usize,
}

impl BoxTree {
    /// The tree of some items with these boxes. They stay in their order where neighbours in it lie together.
    pub(crate) fn new(items: Vec<u32>, bounds: impl Fn(u32) -> Bounds) -> Self {
        let mut tree = Self { items, boxes: Vec::new() };
        let leaves = tree.items.len().div_ceil(LEAF_SIZE);
        tree.boxes.reserve_exact(leaves + leaves / (BRANCHES - 1) + 2);
        let spread = tree.add_leaves(&bounds);
        if leaves > 2 && spread > LARGEST_SPREAD {
            return Self::of_strewn(tree.items, bounds);
        }
        tree.add_nodes();
        tree
    }

    /// The tree of items in no order.
    pub(crate) fn of_strewn(items: Vec<u32>, bounds: impl Fn(u32) -> Bounds) -> Self {
        let mut middles: Vec<(u32, DVec3)> =
            items.into_iter().map(|item| (item, bounds(item).middle())).collect();
        sort(&mut middles);
        let mut tree = Self { items: middles.iter().map(|(item, _)| *item).collect(), boxes: Vec::new() };
        tree.add_leaves(&bounds);
        tree.add_nodes();
        tree
    }

    /// Adds the boxes of the leaves, and tells how many times as large as those of the items their squared diagonals are.
    fn add_leaves(&mut self, bounds: &impl Fn(u32) -> Bounds) -> f64 {
        let [mut of_items, mut of_leaves] = [0.0; 2];
        for leaf in self.items.chunks(LEAF_SIZE) {
            let mut around = Bounds::EMPTY;
            for item in leaf {
                let item = bounds(*item);
                of_items += item.size().length_squared();
                around = around.with(item);
            }
            of_leaves += around.size().length_squared();
            self.boxes.push(around);
        }
        of_leaves / of_items
    }

    /// Adds the boxes of all nodes above the leaves.
    fn add_nodes(&mut self) {
        let mut start = 0;
        while self.boxes.len() > start + 1 {
            let end = self.boxes.len();
            for first in (start..end).step_by(BRANCHES) {
                let below = &self.boxes[first..end.min(first + BRANCHES)];
                let around = below.iter().fold(Bounds::EMPTY, |bounds, node| bounds.with(*node));
                self.boxes.push(around);
            }
            start = end;
        }
    }

    /// The items, those that lie together one after the other.
    pub(crate) fn items(&self) -> &[u32] {
        &self.items
    }

    /// Calls `found` with each two items of the tree whose boxes overlap.
    pub(crate) fn overlaps_within(&self, bounds: impl Fn(u32) -> Bounds, found: &mut impl FnMut(u32, u32)) {
        if let Some(root) = self.root() {
            self.within(root, &bounds, found);
        }
    }

    /// The places in [`Self::items`] of each two items whose boxes overlap, in order, the lower first; in parallel.
    pub(crate) fn overlapping_places(&self, bounds: impl Fn(u32) -> Bounds) -> Vec<[u32; 2]> {
        let Some(root) = self.root() else { return Vec::new() };
        // By place: boxes that are compared are near each other in memory.
        let bounds: Vec<Bounds> = self.items.iter().map(|item| bounds(*item)).collect();
        let leaves = self.items.len().div_ceil(LEAF_SIZE);
        let of_task = |task: usize| {
            let (mut near, mut found) = (Vec::new(), Vec::new());
            for leaf in task * LEAVES_PER_TASK..leaves.min((task + 1) * LEAVES_PER_TASK) {
                near.clear();
                self.places_near(root, leaf, &mut near);
                near.retain(|b| bounds[*b].overlaps(&self.boxes[leaf]));
                for a in leaf * LEAF_SIZE..self.items.len().min((leaf + 1) * LEAF_SIZE) {
                    let overlapping = near.iter().filter(|b| **b > a && bounds[a].overlaps(&bounds[**b]));
                    found.extend(overlapping.map(|b| [id(a), id(*b)]));
                }
            }
            found
        };
        (0..leaves.div_ceil(LEAVES_PER_TASK)).into_par_iter().flat_map_iter(of_task).collect()
    }

    /// Adds the places of the items below a node, of a leaf and those after it, whose leaves overlap that leaf.
    fn places_near(&self, node: Node, leaf: usize, near: &mut Vec<usize>) {
        let end = (node.index + 1) * BRANCHES.pow(node.level);
        if end <= leaf || !self.boxes[node.place].overlaps(&self.boxes[leaf]) {
            return;
        }
        if node.level == 0 {
            let first = node.index * LEAF_SIZE;
            near.extend(first..self.items.len().min(first + LEAF_SIZE));
        } else {
            self.below(node).for_each(|below| self.places_near(below, leaf, near));
        }
    }

    /// Calls `found` with each item of the tree and item of the other whose boxes overlap.
    pub(crate) fn overlaps_with(
        &self,
        other: &Self,
        bounds: impl Fn(u32) -> Bounds,
        found: &mut impl FnMut(u32, u32),
    ) {
        if let (Some(root), Some(other_root)) = (self.root(), other.root()) {
            self.between(root, other, other_root, &bounds, found);
        }
    }

    /// The item nearest to a point, given its squared distance from items, and that from one of them, which stays the answer unless another is nearer.
    pub(crate) fn nearest(
        &self,
        point: DVec3,
        known: (u32, f64),
        squared_distance: impl Fn(u32) -> f64,
    ) -> u32 {
        let mut best = known;
        if let Some(root) = self.root() {
            self.nearer(root, point, &squared_distance, &mut best);
        }
        best.0
    }

    fn nearer(
        &self,
        node: Node,
        point: DVec3,
        squared_distance: &impl Fn(u32) -> f64,
        best: &mut (u32, f64),
    ) {
        if node.level == 0 {
            for item in self.leaf_items(node) {
                let distance = squared_distance(*item);
                if distance < best.1 {
                    *best = (*item, distance);
                }
            }
            return;
        }
        // The nearest box first: it leaves the least to look for in the others.
        let mut below = [(f64::INFINITY, node); BRANCHES];
        let mut count = 0;
        for child in self.below(node) {
            below[count] = (self.boxes[child.place].squared_distance(point), child);
            count += 1;
        }
        below[..count].sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        for (distance, child) in &below[..count] {
            if *distance < best.1 {
                self.nearer(*child, point, squared_distance, best);
            }
        }
    }

    fn root(&self) -> Option<Node> {
        let mut count = self.items.len().div_ceil(LEAF_SIZE);
        let mut level = 0;
        while count > 1 {
            count = count.div_ceil(BRANCHES);
            level += 1;
        }
        Some(Node { level, index: 0, place: self.boxes.len().checked_sub(1)? })
    }

    /// The nodes below a node that is no leaf.
    fn below(&self, node: Node) -> impl Iterator<Item = Node> + Clone {
        let mut count = self.items.len().div_ceil(LEAF_SIZE);
        let mut start = 0;
        for _ in 1..node.level {
            start += count;
            count = count.div_ceil(BRANCHES);
        }
        let first = node.index * BRANCHES;
        (first..count.min(first + BRANCHES)).map(move |index| Node {
            level: node.level - 1,
            index,
            place: start + index,
        })
    }

    fn leaf_items(&self, leaf: Node) -> &[u32] {
        let first = leaf.index * LEAF_SIZE;
        &self.items[first..self.items.len().min(first + LEAF_SIZE)]
    }

    fn within(&self, node: Node, bounds: &impl Fn(u32) -> Bounds, found: &mut impl FnMut(u32, u32)) {
        if node.level == 0 {
            let items = self.leaf_items(node);
            for (index, a) in items.iter().enumerate() {
                let around = bounds(*a);
                for b in items[index + 1..].iter().filter(|b| around.overlaps(&bounds(**b))) {
                    found(*a, *b);
                }
            }
            return;
        }
        let mut below = self.below(node);
        while let Some(first) = below.next() {
            self.within(first, bounds, found);
            for second in below.clone() {
                self.between(first, self, second, bounds, found);
            }
        }
    }

    fn between(
        &self,
        node: Node,
        other: &Self,
        other_node: Node,
        bounds: &impl Fn(u32) -> Bounds,
        found: &mut impl FnMut(u32, u32),
    ) {
        let (here, there) = (&self.boxes[node.place], &other.boxes[other_node.place]);
        if !here.overlaps(there) {
            return;
        }
        if node.level == 0 && other_node.level == 0 {
            let mut near = [(0, Bounds::EMPTY); LEAF_SIZE];
            let mut count = 0;
            for b in other.leaf_items(other_node) {
                near[count] = (*b, bounds(*b));
                count += usize::from(near[count].1.overlaps(here));
            }
            let near = &near[..count];
            if near.is_empty() {
                return;
            }
            for a in self.leaf_items(node) {
                let around = bounds(*a);
                if around.overlaps(there) {
                    for (b, _) in near.iter().filter(|(_, other)| around.overlaps(other)) {
                        found(*a, *b);
                    }
                }
            }
        } else if node.level >= other_node.level {
            // The larger is split.
            for below in self.below(node) {
                self.between(below, other, other_node, bounds, found);
            }
        } else {
            for below in other.below(other_node) {
                self.between(node, other, below, bounds, found);
            }
        }
    }
}

/// Puts items that lie together one after the other: halves along the longest side, each filling whole nodes.
fn sort(items: &mut [(u32, DVec3)]) {
    if items.len() <= LEAF_SIZE {
        return;
    }
    let axis = Bounds::around(items.iter().map(|(_, middle)| *middle)).size().max_position();
    let half = items.len().div_ceil(LEAF_SIZE).next_power_of_two() / 2 * LEAF_SIZE;
    items.select_nth_unstable_by(half, |(_, a), (_, b)| a[axis].total_cmp(&b[axis]));
    let (first, second) = items.split_at_mut(half);
    if half >= SORTED_BY_ONE {
        rayon::join(|| sort(first), || sort(second));
    } else {
        sort(first);
        sort(second);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Boxes in the order of space and in none.
    fn boxes(count: u32) -> Vec<Bounds> {
        let place = |k: u32| f64::from(k * 7919 % count.max(1));
        let corner = |k: u32| DVec3::new(place(k) % 10.0, (place(k) / 10.0).floor(), 0.3 * f64::from(k % 3));
        (0..count).map(|k| Bounds::around([corner(k), corner(k) + DVec3::new(1.2, 0.9, 0.1)])).collect()
    }

    #[test]
    fn the_nearest_item_is_found() {
        for count in [1, 7, 33, 300] {
            let boxes = boxes(count);
            let tree = BoxTree::new((0..count).collect(), |item| boxes[item as usize]);
            for k in 0..50 {
                let point = DVec3::new(f64::from(k * 37 % 50) / 4.0, f64::from(k) / 2.0, 0.4);
                let distance = |item: u32| boxes[item as usize].middle().distance_squared(point);
                let nearest = tree.nearest(point, (0, distance(0)), distance);
                let least = (0..count).map(distance).fold(f64::INFINITY, f64::min);
                assert_eq!(distance(nearest), least);
            }
        }
    }

    #[test]
    fn what_overlaps_is_found_once() {
        for count in [0, 1, 2, 7, 8, 9, 31, 32, 33, 64, 100, 257, 300] {
            let boxes = boxes(count);
            let bounds = |item: u32| boxes[item as usize];
            let tree = BoxTree::new((0..count).collect(), bounds);
            let mut within = Vec::new();
            tree.overlaps_within(bounds, &mut |a, b| within.push([a.min(b), a.max(b)]));
            within.sort_unstable();
            let all = (0..count).flat_map(|a| (0..count).map(move |b| [a, b]));
            let mut overlapping: Vec<[u32; 2]> =
                all.filter(|[a, b]| bounds(*a).overlaps(&bounds(*b))).collect();
            let mut between = Vec::new();
            let half = count / 3;
            let first = BoxTree::new((0..half).collect(), bounds);
            let second = BoxTree::new((half..count).collect(), bounds);
            first.overlaps_with(&second, bounds, &mut |a, b| between.push([a, b]));
            between.sort_unstable();
            overlapping.retain(|[a, b]| a < b);
            assert_eq!(within, overlapping, "{count} boxes");
            let places = tree.overlapping_places(bounds);
            assert!(places.is_sorted() && places.iter().all(|[a, b]| a < b), "{count} boxes");
            let items = |[a, b]: &[u32; 2]| [a, b].map(|place| tree.items()[*place as usize]);
            let mut by_place: Vec<[u32; 2]> =
                places.iter().map(items).map(|[a, b]| [a.min(b), a.max(b)]).collect();
            by_place.sort_unstable();
            assert_eq!(by_place, overlapping, "{count} boxes");
            overlapping.retain(|[a, b]| *a < half && half <= *b);
            assert_eq!(between, overlapping, "{count} boxes");
        }
    }
}
