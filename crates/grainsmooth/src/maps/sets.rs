//! Places that hang together.

use super::cleaning::NO_GRAIN;

/// Numbers in sets, each known by its smallest.
pub(crate) struct Sets(Vec<usize>);

impl Sets {
    pub(crate) fn new(count: usize) -> Self {
        Self((0..count).collect())
    }

    /// The smallest of a number's set.
    pub(crate) fn first(&mut self, mut number: usize) -> usize {
        while self.0[number] != number {
            self.0[number] = self.0[self.0[number]];
            number = self.0[number];
        }
        number
    }

    /// Numbers sets from 0 by their first members; those without a grain have none.
    pub(super) fn numbers(&mut self, has_grain: impl Fn(usize) -> bool) -> Vec<i32> {
        let mut next = 0;
        let mut numbers = vec![NO_GRAIN; self.0.len()];
        for member in (0..self.0.len()).filter(|member| has_grain(*member)) {
            let first = self.first(member);
            if first == member {
                numbers[member] = next;
                next += 1;
            } else {
                numbers[member] = numbers[first];
            }
        }
        numbers
    }

    pub(crate) fn join(&mut self, first: usize, second: usize) {
        let (first, second) = (self.first(first), self.first(second));
        self.0[first.max(second)] = first.min(second);
    }
}
