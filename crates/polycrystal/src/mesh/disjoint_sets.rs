/// Disjoint sets of numbers, each known by its smallest member: the result does not depend on the order of the joins.
#[derive(Debug, Clone)]
pub(crate) struct DisjointSets {
    /// Smaller than the member, or the member itself.
    parents: Vec<u32>,
}

impl DisjointSets {
    /// The numbers below a count, each on its own.
    pub(crate) fn new(count: usize) -> Self {
        Self { parents: (0u32..).take(count).collect() }
    }

    /// The smallest member of a number's set.
    pub(crate) fn root(&mut self, mut member: u32) -> u32 {
        while self.parents[member as usize] != member {
            // Halving the path keeps the forest flat.
            let grandparent = self.parents[self.parents[member as usize] as usize];
            self.parents[member as usize] = grandparent;
            member = grandparent;
        }
        member
    }

    /// Makes the sets of two numbers one.
    pub(crate) fn join(&mut self, a: u32, b: u32) {
        let [a, b] = [a, b].map(|member| self.root(member));
        self.parents[a.max(b) as usize] = a.min(b);
    }

    /// As [`Self::root`], with the forest as it is.
    fn smallest(&self, mut member: u32) -> u32 {
        while self.parents[member as usize] != member {
            member = self.parents[member as usize];
        }
        member
    }

    /// The number of sets that some numbers are in.
    pub(crate) fn set_count(&self, members: &[u32]) -> usize {
        let mut sets: Vec<u32> = members.iter().map(|member| self.smallest(*member)).collect();
        sets.sort_unstable();
        sets.dedup();
        sets.len()
    }

    /// The sets of more than one member, each sorted, in order of the smallest members.
    pub(crate) fn of_several(&self) -> Vec<Vec<u32>> {
        let joined = (0u32..).zip(&self.parents).filter(|(member, parent)| member != *parent);
        let mut joined: Vec<[u32; 2]> =
            joined.map(|(member, parent)| [self.smallest(*parent), member]).collect();
        joined.sort_unstable();
        let sets = joined.chunk_by(|a, b| a[0] == b[0]);
        sets.map(|set| std::iter::once(set[0][0]).chain(set.iter().map(|[_, member]| *member)).collect())
            .collect()
    }

    /// The number of each member's set, counted from 0 in order of the smallest members, and how many sets there are.
    pub(crate) fn numbers(&self) -> (Vec<u32>, u32) {
        let (mut numbers, mut count) = (Vec::with_capacity(self.parents.len()), 0);
        for (member, parent) in (0u32..).zip(&self.parents) {
            // A parent is smaller, and has its number already.
            numbers.push(if *parent == member { count } else { numbers[*parent as usize] });
            count += u32::from(*parent == member);
        }
        (numbers, count)
    }
}
