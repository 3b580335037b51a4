//! Seeds on lattices.

use std::f64::consts::SQRT_2;
use std::fmt;

use glam::{DVec3, UVec3};
use voronoi::{Dimension, Domain};

use crate::config::lattice::Lattice;
use crate::{Config, SeedSource};

/// The relative difference from the perfect spacing below which an axis gets it: what rounding leaves of a side that is
/// meant to fit, such as 0.3 for three cells of 0.1.
const MEANT_TO_FIT: f64 = 1e-12;

const SQRT_3: f64 = 1.732_050_807_568_877_2;

impl Lattice {
    /// Sides of the conventional cell in units of its first.
    fn cell(self) -> DVec3 {
        match self {
            Self::HexagonalClosePacked => DVec3::new(1.0, SQRT_3, 2.0 * SQRT_2 / SQRT_3),
            Self::Hexagonal => DVec3::new(1.0, SQRT_3, 1.0),
            _ => DVec3::ONE,
        }
    }

    /// Seeds of the conventional cell as fractions of its sides. They lie point-symmetric in the cell and off its sides, so
    /// all walls of a box are alike and hold no seed.
    fn basis(self) -> &'static [[f64; 3]] {
        match self {
            Self::SimpleCubic => &[[0.5, 0.5, 0.5]],
            Self::BodyCentredCubic => &[[0.25, 0.25, 0.25], [0.75, 0.75, 0.75]],
            Self::FaceCentredCubic => {
                &[[0.25, 0.25, 0.25], [0.25, 0.75, 0.75], [0.75, 0.25, 0.75], [0.75, 0.75, 0.25]]
            }
            Self::HexagonalClosePacked => &[
                [0.25, 1.0 / 6.0, 0.25],
                [0.75, 4.0 / 6.0, 0.25],
                [0.75, 2.0 / 6.0, 0.75],
                [0.25, 5.0 / 6.0, 0.75],
            ],
            Self::Square => &[[0.5, 0.5, 0.0]],
            Self::Hexagonal => &[[0.25, 0.25, 0.0], [0.75, 0.75, 0.0]],
        }
    }
}

/// A lattice fitted into a box.
///
/// The side that holds the fewest conventional cells gets the number asked for; each other side gets as many as come closest
/// to the lattice's own spacing, and the lattice is stretched to fit. It is perfect where the sides are whole multiples of the
/// cell's.
///
/// The spacing is rounded to so few bits that every coordinate is exact (but for the thirds and sixths of `hcp`), so that
/// where many cells meet they meet in one point. The box then differs from the one asked for by at most 1e-12 of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LatticeFit {
    /// The lattice.
    pub lattice: Lattice,
    /// Number of conventional cells along each axis; 1 along z in the plane.
    pub cells: UVec3,
    /// Sides of a conventional cell, in the unit of the box; 1 along z in the plane.
    pub spacing: DVec3,
}

impl LatticeFit {
    /// Fits `count` cells along the side of the box that holds the fewest. In the plane the box's z is not looked at.
    ///
    /// # Panics
    /// When `count` is 0 or a side is not positive and finite.
    pub fn new(lattice: Lattice, count: u32, box_size: DVec3) -> Self {
        assert!(count > 0, "a lattice has at least one cell");
        let axes = usize::from(lattice.dimension().axes());
        let cell = lattice.cell();
        let sides = &box_size.to_array()[..axes];
        assert!(sides.iter().all(|side| side.is_finite() && *side > 0.0), "sides are positive and finite");
        let smallest = (0..axes).map(|axis| box_size[axis] / cell[axis]).fold(f64::INFINITY, f64::min);
        let length = smallest / f64::from(count);
        let (mut cells, mut spacing) = (UVec3::ONE, DVec3::ONE);
        for axis in 0..axes {
            let perfect = length * cell[axis];
            // A float becomes an integer by saturation; so many seeds are refused for lack of memory.
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "saturates, and is positive"
            )]
            let fitting = (box_size[axis] / perfect).round().max(1.0) as u32;
            let stretched = box_size[axis] / f64::from(fitting);
            let is_perfect = (stretched - perfect).abs() < MEANT_TO_FIT * perfect;
            let wanted = if is_perfect { perfect } else { stretched };
            cells[axis] = fitting;
            spacing[axis] = wanted;
        }
        let most_quarters = 4 * u64::from(cells.max_element());
        let spacing = spacing.map(|length| with_spare_bits(length, most_quarters));
        Self { lattice, cells, spacing }
    }

    /// The box that holds the lattice exactly.
    pub fn box_size(&self) -> DVec3 {
        self.cells.as_dvec3() * self.spacing
    }

    /// Number of seeds.
    pub fn seed_count(&self) -> usize {
        let cells = self.cells.to_array().map(|count| count as usize);
        cells.into_iter().fold(self.lattice.basis().len(), usize::saturating_mul)
    }

    /// How far each axis is stretched against the first, 1 for a perfect lattice.
    pub fn stretch(&self) -> DVec3 {
        let relative = self.spacing / self.lattice.cell();
        relative / relative.x
    }

    /// The sides of the box nearest to this one that would hold as many cells of the perfect lattice, unless this one does.
    pub fn perfect_box(&self) -> Option<DVec3> {
        let stretch = match self.lattice.dimension() {
            Dimension::Two => self.stretch().with_z(1.0),
            Dimension::Three => self.stretch(),
        };
        let is_perfect = (stretch - 1.0).abs().max_element() < 1e3 * MEANT_TO_FIT;
        (!is_perfect).then(|| self.cells.as_dvec3() * self.lattice.cell() * self.spacing.x)
    }

    /// The seeds, cell by cell along x, then y, then z, from a box with its corner in the origin; z = 0 in the plane.
    pub fn seeds(&self) -> Vec<DVec3> {
        let mut seeds = Vec::with_capacity(self.seed_count());
        for z in 0..self.cells.z {
            for y in 0..self.cells.y {
                for x in 0..self.cells.x {
                    let corner = UVec3::new(x, y, z).as_dvec3();
                    let basis = self.lattice.basis().iter();
                    seeds.extend(basis.map(|fraction| (corner + DVec3::from(*fraction)) * self.spacing));
                }
            }
        }
        seeds
    }
}

impl LatticeFit {
    fn joined(&self, values: &[String; 3], separator: &str) -> String {
        values[..usize::from(self.lattice.dimension().axes())].join(separator)
    }

    /// The lattice's name and the number of its cells, such as `hcp, 3 x 2 x 2 cells`.
    pub(crate) fn name(&self) -> String {
        let cells = self.cells.to_array().map(|count| count.to_string());
        format!("{}, {} cells", self.lattice.name(), self.joined(&cells, " x "))
    }
}

impl fmt::Display for LatticeFit {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}", self.name())?;
        let Some(perfect) = self.perfect_box() else { return Ok(()) };
        let stretch = self.stretch().to_array().map(|factor| format!("{factor:.4}"));
        let sides = perfect.to_array().map(|side| side.to_string());
        let (stretch, sides) = (self.joined(&stretch, " : "), self.joined(&sides, " "));
        write!(out, ", stretched {stretch}; perfect with --box {sides}")
    }
}

/// The value rounded to so many bits that its multiples up to `largest` are exact.
fn with_spare_bits(value: f64, largest: u64) -> f64 {
    let spare = largest.ilog2() + 1;
    let half = 1 << (spare - 1);
    f64::from_bits((value.to_bits() + half) & !(2 * half - 1))
}

impl Config {
    /// The lattice that the seeds form, if they do.
    ///
    /// For a domain from a file only its sides tell.
    pub fn lattice_fit(&self) -> Option<LatticeFit> {
        match self.seeds {
            SeedSource::Lattice { .. } if self.shape.is_from_file() => None,
            SeedSource::Lattice { lattice, cells } => Some(LatticeFit::new(lattice, cells, self.box_size)),
            _ => None,
        }
    }

    /// What to say of the lattice that the seeds form, if they do and so many of them lie in the domain.
    pub fn lattice_report(&self, domain: &Domain, seed_count: usize) -> Option<String> {
        let SeedSource::Lattice { lattice, cells } = self.seeds else { return None };
        let (all, said) = match self.lattice_fit() {
            Some(fit) => (fit.seed_count(), fit.to_string()),
            // No --box would make it perfect.
            None => {
                let fit = LatticeFit::new(lattice, cells, domain.size());
                (fit.seed_count(), fit.name())
            }
        };
        Some(match all.saturating_sub(seed_count) {
            0 => said,
            outside => format!("{said}; {outside} of {all} seeds lie outside the domain and are left out"),
        })
    }

    /// The seeds of a lattice that lie in the domain.
    pub(crate) fn lattice_seeds(&self, lattice: Lattice, cells: u32, domain: &Domain) -> Vec<DVec3> {
        let (fit, corner) = match self.lattice_fit() {
            Some(fit) => (fit, DVec3::ZERO),
            None => (LatticeFit::new(lattice, cells, domain.size()), domain.lower()),
        };
        let seeds = fit.seeds().into_iter().map(|seed| corner + seed);
        seeds.filter(|seed| domain.contains(*seed)).collect()
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_1_SQRT_2;

    use super::*;

    const SOLID: [Lattice; 4] = [
        Lattice::SimpleCubic,
        Lattice::BodyCentredCubic,
        Lattice::FaceCentredCubic,
        Lattice::HexagonalClosePacked,
    ];

    /// Distances to the nearest seeds of a periodic box, and how many there are at each, from the first seed.
    fn nearest(fit: &LatticeFit, shells: usize) -> Vec<(f64, usize)> {
        let (seeds, size) = (fit.seeds(), fit.box_size());
        let wrapped = |seed: &DVec3| {
            let apart = *seed - seeds[0];
            apart - size * (apart / size).round()
        };
        let mut distances: Vec<f64> = seeds[1..].iter().map(|seed| wrapped(seed).length()).collect();
        distances.sort_unstable_by(f64::total_cmp);
        let same = distances.chunk_by(|a, b| b - a < 1e-9);
        same.take(shells).map(|shell| (shell[0], shell.len())).collect()
    }

    /// Coordination numbers of crystallography.
    #[test]
    fn seeds_have_the_neighbours_of_their_lattice() {
        let a = 0.7;
        for (lattice, expected) in [
            (Lattice::SimpleCubic, [(a, 6), (a * SQRT_2, 12)]),
            (Lattice::BodyCentredCubic, [(a * SQRT_3 / 2.0, 8), (a, 6)]),
            (Lattice::FaceCentredCubic, [(a * FRAC_1_SQRT_2, 12), (a, 6)]),
            (Lattice::HexagonalClosePacked, [(a, 12), (a * SQRT_2, 6)]),
            (Lattice::Square, [(a, 4), (a * SQRT_2, 4)]),
            (Lattice::Hexagonal, [(a, 6), (a * SQRT_3, 6)]),
        ] {
            let fit = LatticeFit::new(lattice, 5, 5.0 * a * lattice.cell());
            assert_eq!(fit.perfect_box(), None);
            for ((distance, count), (exact, exact_count)) in nearest(&fit, 2).into_iter().zip(expected) {
                assert!((distance - exact).abs() < 1e-12, "{lattice:?}: {distance}, not {exact}");
                assert_eq!(count, exact_count, "{lattice:?}");
            }
        }
    }

    #[test]
    fn seeds_lie_point_symmetric_and_off_the_walls() {
        for lattice in SOLID {
            let fit = LatticeFit::new(lattice, 3, DVec3::new(1.0, 2.0, 0.7));
            let size = fit.box_size();
            let seeds = fit.seeds();
            assert_eq!(seeds.len(), fit.seed_count());
            let sum = seeds.iter().sum::<DVec3>();
            assert!((sum / seeds.len() as f64 - size / 2.0).abs().max_element() < 1e-12);
            let margin = fit.spacing / 7.0;
            assert!(seeds.iter().all(|seed| seed.cmpgt(margin).all() && seed.cmplt(size - margin).all()));
        }
    }

    #[test]
    fn fewest_cells_are_those_asked_for_and_the_others_fit() {
        let fit = LatticeFit::new(Lattice::FaceCentredCubic, 3, DVec3::new(0.3, 0.1, 0.2));
        assert_eq!(fit.cells, UVec3::new(9, 3, 6));
        // 0.3 is not three times 0.1 in binary, but meant to be.
        assert_eq!(fit.spacing, DVec3::splat(fit.spacing.x));
        assert!((fit.box_size() - DVec3::new(0.3, 0.1, 0.2)).abs().max_element() < 1e-13);
        let fit = LatticeFit::new(Lattice::HexagonalClosePacked, 4, DVec3::ONE);
        assert_eq!(fit.cells, UVec3::new(7, 4, 4));
        let perfect = fit.perfect_box().expect("a cube does not hold the lattice");
        let again = LatticeFit::new(Lattice::HexagonalClosePacked, 4, perfect);
        assert_eq!((again.cells, again.perfect_box()), (fit.cells, None));
    }

    #[test]
    fn coordinates_are_exact_whatever_the_spacing() {
        for side in [1.0, 0.1, 3e-9, 7e8] {
            let fit = LatticeFit::new(Lattice::BodyCentredCubic, 7, DVec3::splat(side));
            assert!((fit.box_size().x / side - 1.0).abs() < 1e-13);
            let quarter = fit.spacing.x / 4.0;
            for seed in fit.seeds() {
                let steps = (seed.x / quarter).round();
                assert_eq!(
                    steps.mul_add(-quarter, seed.x),
                    0.0,
                    "{seed} is a multiple of the quarter spacing"
                );
            }
        }
    }
}
