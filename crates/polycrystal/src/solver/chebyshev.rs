//! Chebyshev's semi-iteration: steps that go on a little where the last one went.

/// The factors of its steps (Golub and Varga, Chebyshev semi-iterative methods, 1961), where the matrix of plain steps has eigenvalues between a least one and 1.
pub(crate) struct Chebyshev {
    least: f32,
    /// Nothing before the first step.
    last: Option<f32>,
}

impl Chebyshev {
    pub(crate) fn new(least: f32) -> Self {
        Self { least, last: None }
    }

    /// How much of the last motion, and of the plain one, a step takes.
    pub(crate) fn next(&mut self) -> [f32; 2] {
        let (middle, half) = ((1.0 + self.least) / 2.0, (1.0 - self.least) / 2.0);
        let Some(last) = self.last else {
            self.last = Some(half / middle);
            return [0.0, 1.0 / middle];
        };
        let next = 1.0 / (2.0 * middle / half - last);
        self.last = Some(next);
        [next * last, 2.0 * next / half]
    }
}
