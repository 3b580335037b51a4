use crate::exact::generator::Generator;
use crate::exact::input::ExactInput;

/// A cell that is being cut: polyhedron or polygon.
pub(crate) trait Clipping {
    /// A radius around the seed that holds the cell; negative for an empty cell.
    fn radius(&self) -> f64;

    /// Cuts off what lies beyond a plane.
    fn cut(&mut self, generator: Generator, input: ExactInput);

    /// The planes of each vertex, in positive orientation.
    fn vertices(&self) -> Vec<[Generator; 3]>;

    /// The planes of the vertex nearest to the seed.
    fn nearest_vertex(&self) -> Option<[Generator; 3]>;
}
