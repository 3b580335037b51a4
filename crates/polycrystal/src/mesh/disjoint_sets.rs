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
