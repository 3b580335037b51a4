//! Exact decisions, for when floating point cannot tell.

use glam::DVec3;

use crate::exact::generator::Generator;
use crate::exact::input::ExactInput;
use crate::exact::plane::{Decision, common_exponent};
use crate::exact::{big_integer as big, fixed_width as narrow};

impl ExactInput<'_> {
    /// Whether plane `cutter` cuts off the vertex of `planes` (in positive orientation) from the cell of `seed`.
    pub(crate) fn decide(self, seed: u32, planes: [Generator; 3], cutter: Generator) -> Decision {
        let [a, b, c] = planes;
        let generators = [a, b, c, cutter];
        let exponent = common_exponent(self, seed, &generators);
        match narrow::planes(self, seed, generators, exponent) {
            Some(planes) => narrow::decide(&planes),
            None => big::decide(&big::planes(self, seed, generators, exponent)),
        }
    }

    /// Whether three planes are in positive orientation: the determinant of their normals is positive.
    pub(crate) fn is_positive(self, seed: u32, planes: [Generator; 3]) -> bool {
        let exponent = common_exponent(self, seed, &planes);
        match narrow::planes(self, seed, planes, exponent) {
            Some(planes) => narrow::is_positive(&planes),
            None => big::is_positive(&big::planes(self, seed, planes, exponent)),
        }
    }

    /// The vertex of three planes relative to the seed, each coordinate rounded to nearest but for one or two last places.
    pub(crate) fn vertex(self, seed: u32, planes: [Generator; 3]) -> DVec3 {
        let exponent = common_exponent(self, seed, &planes);
        match narrow::planes(self, seed, planes, exponent) {
            Some(planes) => narrow::vertex(&planes, exponent),
            None => big::vertex(&big::planes(self, seed, planes, exponent), exponent),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Wall;
    use crate::exact::frame::Frame;
    use crate::exact::image::ImageTable;

    fn seeds() -> Vec<DVec3> {
        vec![
            DVec3::ZERO,
            DVec3::new(1.0, 0.0, 0.0),
            DVec3::new(0.0, 1.0, 0.0),
            DVec3::new(0.0, 0.0, 1.0),
            DVec3::new(1.0, 1.0, 1.0),
        ]
    }

    fn decide(seeds: &[DVec3], seed: u32, planes: [u32; 3], cutter: u32) -> Decision {
        let frame = Frame::new(DVec3::ZERO, DVec3::ONE, 3, None);
        let images = ImageTable::default();
        let input = ExactInput { frame: &frame, seeds, weights: None, images: &images };
        input.decide(seed, planes.map(Generator::site), Generator::site(cutter))
    }

    #[test]
    fn sign_is_exact_one_unit_in_the_last_place_from_a_tie() {
        let mut seeds = seeds();
        assert!(decide(&seeds, 0, [1, 2, 3], 4).tie);
        seeds[4].x = 1.0f64.next_down();
        assert_eq!(decide(&seeds, 0, [1, 2, 3], 4), Decision { beyond: true, tie: false });
        seeds[4].x = 1.0f64.next_up();
        assert_eq!(decide(&seeds, 0, [1, 2, 3], 4), Decision { beyond: false, tie: false });
    }

    #[test]
    fn a_broken_tie_is_the_same_from_every_cell() {
        // Vertex {0, 1, 2, 3} against seed 4, asked by each of the four cells; the odd permutations swap two planes.
        let seeds = seeds();
        let answers = [
            decide(&seeds, 0, [1, 2, 3], 4),
            decide(&seeds, 1, [0, 3, 2], 4),
            decide(&seeds, 2, [0, 1, 3], 4),
            decide(&seeds, 3, [0, 2, 1], 4),
        ];
        assert!(answers.iter().all(|answer| *answer == answers[0] && answer.tie), "{answers:?}");
    }

    #[test]
    fn exact_vertex_is_the_circumcentre() {
        let frame = Frame::new(DVec3::ZERO, DVec3::ONE, 3, None);
        let images = ImageTable::default();
        let seeds = seeds();
        let input = ExactInput { frame: &frame, seeds: &seeds, weights: None, images: &images };
        let vertex = input.vertex(0, [1, 2, 3].map(Generator::site));
        assert_eq!(vertex, DVec3::splat(0.5));
        let tiny: Vec<DVec3> = seeds.iter().map(|seed| *seed * 1e-200).collect();
        let input = ExactInput { frame: &frame, seeds: &tiny, weights: None, images: &images };
        assert_eq!(input.vertex(0, [1, 2, 3].map(Generator::site)), DVec3::splat(0.5e-200));
    }

    #[test]
    fn walls_take_part_in_decisions() {
        let frame = Frame::new(DVec3::ZERO, DVec3::ONE, 3, None);
        let images = ImageTable::default();
        let seeds = [DVec3::new(0.25, 0.5, 0.5), DVec3::new(0.75, 0.5, 0.5)];
        let input = ExactInput { frame: &frame, seeds: &seeds, weights: None, images: &images };
        let walls = [Wall::ALL[1], Wall::ALL[3], Wall::ALL[5]].map(Generator::side);
        assert!(input.decide(0, walls, Generator::site(1)).beyond);
        assert_eq!(input.vertex(0, walls), DVec3::new(0.75, 0.5, 0.5));
    }
}
