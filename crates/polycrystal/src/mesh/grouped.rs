/// Items in groups, in each group in the order in which they came.
#[derive(Debug)]
pub(crate) struct Grouped<T> {
    /// Where each group starts, and the end.
    starts: Vec<usize>,
    items: Vec<T>,
}

impl<T: Copy + Default> Grouped<T> {
    /// Items with the numbers of their groups.
    ///
    /// # Panics
    /// When there is no such group.
    pub(crate) fn new(group_count: usize, items: impl Iterator<Item = (usize, T)> + Clone) -> Self {
        let mut starts = vec![0; group_count + 1];
        items.clone().for_each(|(group, _)| starts[group + 1] += 1);
        (0..group_count).for_each(|group| starts[group + 1] += starts[group]);
        let mut next = starts.clone();
        let mut sorted = vec![T::default(); starts[group_count]];
        for (group, item) in items {
            sorted[next[group]] = item;
            next[group] += 1;
        }
        Self { starts, items: sorted }
    }

    /// The items of a group.
    pub(crate) fn of(&self, group: usize) -> &[T] {
        &self.items[self.starts[group]..self.starts[group + 1]]
    }

    /// Number of items in the groups before one.
    pub(crate) fn start(&self, group: usize) -> usize {
        self.starts[group]
    }

    /// Number of groups.
    pub(crate) fn count(&self) -> usize {
        self.starts.len() - 1
    }
}

/// The parts of a list that begin at the given places, of which the last is its end.
pub(crate) fn split<'a, T>(mut list: &'a mut [T], starts: &[usize]) -> Vec<&'a mut [T]> {
    let mut parts = Vec::with_capacity(starts.len() - 1);
    for ends in starts.windows(2) {
        let (part, rest) = list.split_at_mut(ends[1] - ends[0]);
        parts.push(part);
        list = rest;
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_keep_the_order_of_their_items() {
        let groups = Grouped::new(4, [(2, 'a'), (0, 'b'), (2, 'c'), (3, 'd')].into_iter());
        let found: Vec<&[char]> = (0..groups.count()).map(|group| groups.of(group)).collect();
        assert_eq!(found, [&['b'][..], &[], &['a', 'c'], &['d']]);
    }
}
