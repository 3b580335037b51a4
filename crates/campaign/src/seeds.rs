//! Where the seeds of a run come from: the program's own generators, and files with all that seeds of users have.

use std::collections::BTreeSet;

use crate::domain::Domain;
use crate::draw::Draw;
use crate::options::Options;

/// How the seeds of a run are placed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Arrangement {
    /// `--seeds`.
    Random,
    /// `--seeding poisson-disc`.
    PoissonDisc,
    /// `--lattice`.
    Lattice,
    /// A file with uniform seeds.
    Uniform,
    /// A file with a lattice, each seed moved by a tiny share of the spacing, or by nothing.
    JitteredLattice,
    /// A file with dense groups.
    Clusters,
    /// A file with all seeds near one corner.
    Corner,
    /// A file with seeds that grow denser toward one side.
    Gradient,
    /// A file with seeds in one plane, or along one line.
    Coplanar,
    /// A file with pairs of seeds that nearly coincide.
    Twins,
    /// A file with radii of one order of magnitude.
    Radii,
    /// A file with radii, one of which is many times the others.
    Giant,
    /// A file with seeds on a grid of binary fractions, so that many grains meet in points.
    Grid,
}

impl Arrangement {
    /// All with their weights, in a word or two.
    const ALL: [(f64, Self, &'static str); 13] = [
        (6.0, Self::Random, "random"),
        (1.0, Self::PoissonDisc, "poisson-disc"),
        (1.5, Self::Lattice, "lattice"),
        (1.0, Self::Uniform, "uniform file"),
        (2.0, Self::JitteredLattice, "jittered lattice"),
        (2.0, Self::Clusters, "clusters"),
        (0.5, Self::Corner, "corner"),
        (1.0, Self::Gradient, "gradient"),
        (1.0, Self::Coplanar, "coplanar"),
        (1.5, Self::Twins, "twins"),
        (1.5, Self::Radii, "radii"),
        (0.7, Self::Giant, "one giant"),
        (1.0, Self::Grid, "grid"),
    ];

    /// Draws one.
    pub fn draw(draw: &mut Draw) -> Self {
        draw.weighted(&Self::ALL.map(|(weight, one, _)| (weight, one)))
    }

    /// Whether grains can have given volumes: seeds that nearly coincide leave no room for them.
    pub fn may_be_sized(self) -> bool {
        matches!(self, Self::Random | Self::PoissonDisc | Self::Uniform | Self::Radii)
    }

    /// The arrangement in a word or two.
    pub fn name(self) -> &'static str {
        Self::ALL.into_iter().find(|(_, one, _)| *one == self).map_or("", |(.., name)| name)
    }
}

/// Cells of a lattice along each axis, at most so many seeds in all.
#[derive(Debug, Clone, PartialEq)]
pub struct LatticeCells {
    /// The lattice's name on the command line.
    pub name: &'static str,
    basis: &'static [[f64; 3]],
    /// Cells along each axis.
    pub cells: Vec<u32>,
}

impl LatticeCells {
    /// Draws a lattice.
    pub fn draw(draw: &mut Draw, dimension: usize, largest: u32) -> Self {
        let (name, basis): (_, &[[f64; 3]]) = match dimension {
            2 => draw.one_of::<(&str, &[[f64; 3]])>(&[
                ("square", &[[0.5, 0.5, 0.5]]),
                ("hex", &[[0.25, 0.25, 0.5], [0.75, 0.75, 0.5]]),
            ]),
            _ => draw.one_of::<(&str, &[[f64; 3]])>(&[
                ("sc", &[[0.5; 3]]),
                ("bcc", &[[0.25; 3], [0.75; 3]]),
                ("fcc", &[[0.25, 0.25, 0.25], [0.25, 0.75, 0.75], [0.75, 0.25, 0.75], [0.75, 0.75, 0.25]]),
                (
                    "hcp",
                    &[
                        [0.25, 1.0 / 6.0, 0.25],
                        [0.75, 4.0 / 6.0, 0.25],
                        [0.75, 2.0 / 6.0, 0.75],
                        [0.25, 5.0 / 6.0, 0.75],
                    ],
                ),
            ]),
        };
        let per_cell = u32::try_from(basis.len()).unwrap_or(u32::MAX);
        let seeds_in = |cells: &[u32]| per_cell * cells.iter().product::<u32>();
        let mut cells = vec![1; dimension];
        for _ in 0..draw.whole(0..=12) {
            let axis = draw.one_of(&[0, 1, dimension - 1]);
            cells[axis] += 1;
            if seeds_in(&cells) > largest {
                cells[axis] -= 1;
            }
        }
        Self { name, basis, cells }
    }

    /// Sides of the box that the lattice fills: whole cells, perfect or stretched a little.
    pub fn proportions(&self, draw: &mut Draw) -> Vec<f64> {
        let perfect: &[f64] = match self.name {
            "hex" => &[1.0, 1.732_050_807_568_877_2],
            "hcp" => &[1.0, 1.732_050_807_568_877_2, 1.632_993_161_855_452],
            _ => &[1.0; 3],
        };
        let stretch = if draw.chance(0.3) { 0.1 } else { 0.0 };
        let sides = self.cells.iter().zip(perfect);
        sides.map(|(count, side)| f64::from(*count) * side * (1.0 + stretch * draw.fraction())).collect()
    }

    fn fractions(&self) -> Vec<Vec<f64>> {
        let mut seeds: Vec<Vec<f64>> = vec![Vec::new()];
        for count in &self.cells {
            seeds = seeds
                .iter()
                .flat_map(|seed| (0..*count).map(|cell| [seed.clone(), vec![f64::from(cell)]].concat()))
                .collect();
        }
        let at = |corner: &Vec<f64>, basis: &[f64; 3]| -> Vec<f64> {
            let sums = corner.iter().zip(basis).map(|(corner, part)| corner + part);
            sums.zip(&self.cells).map(|(sum, count)| sum / f64::from(*count)).collect()
        };
        seeds.iter().flat_map(|corner| self.basis.iter().map(|basis| at(corner, basis))).collect()
    }
}

/// Draws the seeds and writes their options, and their file if there is one.
pub fn draw_seeds(
    draw: &mut Draw,
    arrangement: Arrangement,
    count: u32,
    lattice: &LatticeCells,
    domain: &Domain,
    options: &mut Options,
) -> Option<(String, Vec<u8>)> {
    match arrangement {
        Arrangement::Lattice => {
            let least = lattice.cells.iter().copied().min().unwrap_or(1);
            options.set("lattice", [lattice.name.to_owned(), least.to_string()]);
            return None;
        }
        Arrangement::Random | Arrangement::PoissonDisc => {
            options.set("seeds", [count]);
            options.set("rng-seed", [draw.whole(0..=999_999)]);
            if arrangement == Arrangement::PoissonDisc {
                options.set("seeding", ["poisson-disc"]);
            }
            return None;
        }
        _ => {}
    }
    let fractions = fractions(draw, arrangement, count, lattice, domain.sides.len());
    let inside = |fraction: f64| 0.5 + (fraction - 0.5) * domain.inner;
    let position = |seed: &Vec<f64>| -> Vec<f64> {
        seed.iter().zip(&domain.sides).map(|(fraction, side)| inside(*fraction) * side).collect()
    };
    let positions: Vec<Vec<f64>> = fractions.iter().map(position).collect();
    let radii = radii(draw, arrangement, positions.len(), domain.spacing(count) * domain.inner);
    if radii.is_some() && draw.chance(0.7) {
        options.switch("drop-empty");
    }
    let (name, content) = file(draw, &positions, radii.as_deref());
    options.set("seeds-file", [name]);
    Some((name.to_owned(), content.into_bytes()))
}

/// Seeds as fractions of the box's sides.
fn fractions(
    draw: &mut Draw,
    arrangement: Arrangement,
    count: u32,
    lattice: &LatticeCells,
    dimension: usize,
) -> Vec<Vec<f64>> {
    let uniform = |draw: &mut Draw| -> Vec<f64> { (0..dimension).map(|_| draw.fraction()).collect() };
    let near = |draw: &mut Draw, middle: &[f64], distance: f64| -> Vec<f64> {
        middle.iter().map(|part| folded(part + draw.between(-distance, distance))).collect()
    };
    match arrangement {
        Arrangement::JitteredLattice => {
            let jitter = if draw.chance(0.15) { 0.0 } else { draw.magnitude(1e-12, 1e-3) };
            let spacing = 1.0 / f64::from(lattice.cells.iter().copied().max().unwrap_or(1));
            lattice.fractions().iter().map(|seed| near(draw, seed, jitter * spacing)).collect()
        }
        Arrangement::Clusters => {
            let middles: Vec<Vec<f64>> = (0..draw.whole(1..=4)).map(|_| uniform(draw)).collect();
            let (size, share) = (draw.magnitude(1e-6, 0.1), draw.one_of(&[1.0, 0.8, 0.5]));
            let mut seed = || {
                if !draw.chance(share) {
                    return uniform(draw);
                }
                let last = u32::try_from(middles.len() - 1).unwrap_or(0);
                let middle = &middles[draw.whole(0..=last) as usize];
                near(draw, middle, size)
            };
            (0..count).map(|_| seed()).collect()
        }
        Arrangement::Corner => {
            let size = draw.magnitude(1e-5, 1e-1);
            let mut seed = || uniform(draw).iter().map(|part| part * size).collect();
            (0..count).map(|_| seed()).collect()
        }
        Arrangement::Gradient => {
            let power = draw.between(2.0, 6.0);
            let mut seed = || {
                let mut seed = uniform(draw);
                seed[0] = seed[0].powf(power);
                seed
            };
            (0..count).map(|_| seed()).collect()
        }
        Arrangement::Coplanar => {
            let (place, is_line, share) = (uniform(draw), draw.chance(0.3), draw.one_of(&[1.0, 1.0, 0.7]));
            let fixed = if is_line { 1..dimension } else { dimension - 1..dimension };
            let mut seed = || {
                let mut seed = uniform(draw);
                if draw.chance(share) {
                    seed[fixed.clone()].copy_from_slice(&place[fixed.clone()]);
                }
                seed
            };
            (0..count).map(|_| seed()).collect()
        }
        Arrangement::Twins => {
            let distance = draw.magnitude(1e-12, 1e-3);
            let mut seeds: Vec<Vec<f64>> = (0..count.div_ceil(2)).map(|_| uniform(draw)).collect();
            let twins: Vec<Vec<f64>> =
                seeds.iter().take(count as usize / 2).map(|seed| near(draw, seed, distance)).collect();
            seeds.extend(twins);
            seeds
        }
        Arrangement::Grid => {
            let steps = 1 << draw.whole(2..=5);
            let mut seed = || -> Vec<u32> { (0..dimension).map(|_| draw.whole(0..=steps - 1)).collect() };
            let places: BTreeSet<Vec<u32>> = (0..count).map(|_| seed()).collect();
            let fraction = |part: &u32| f64::from(*part) / f64::from(steps);
            places.iter().map(|place| place.iter().map(fraction).collect()).collect()
        }
        _ => (0..count).map(|_| uniform(draw)).collect(),
    }
}

/// A number near [0, 1) mirrored into it.
fn folded(number: f64) -> f64 {
    let mirrored = if number < 0.0 { -number } else { number };
    if mirrored >= 1.0 { (2.0 - mirrored).min(1.0 - f64::EPSILON) } else { mirrored }
}

fn radii(draw: &mut Draw, arrangement: Arrangement, count: usize, spacing: f64) -> Option<Vec<f64>> {
    match arrangement {
        Arrangement::Radii => {
            let least = draw.one_of(&[0.05, 0.2, 0.4]);
            Some((0..count).map(|_| spacing * draw.magnitude(least, 0.8)).collect())
        }
        Arrangement::Giant => {
            let mut radii = vec![0.3 * spacing; count];
            radii[0] = spacing * draw.magnitude(0.7, 6.0);
            Some(radii)
        }
        _ => None,
    }
}

/// The seeds in one of the formats that the program reads.
fn file(draw: &mut Draw, positions: &[Vec<f64>], radii: Option<&[f64]>) -> (&'static str, String) {
    let is_plane = positions.first().is_some_and(|seed| seed.len() == 2);
    let numbers = |separator: &str, ends: &dyn Fn(usize) -> Vec<f64>| -> Vec<String> {
        let numbers = |(index, seed): (usize, &Vec<f64>)| {
            let all = seed.iter().copied().chain(ends(index));
            all.map(|number| format!("{number:?}")).collect::<Vec<_>>().join(separator)
        };
        positions.iter().enumerate().map(numbers).collect()
    };
    let radius = |index: usize| radii.map(|radii| radii[index]).into_iter().collect::<Vec<f64>>();
    // The formats without names of columns take three coordinates, z = 0 in the plane.
    let in_space =
        |index: usize| -> Vec<f64> { is_plane.then_some(0.0).into_iter().chain(radius(index)).collect() };
    match draw.weighted(&[(0.8, "seeds.csv"), (0.1, "seeds.xyz"), (0.1, "seeds.json")]) {
        name @ "seeds.xyz" => {
            let lines: String = numbers(" ", &in_space).iter().map(|line| format!("A {line}\n")).collect();
            (name, format!("{}\nseeds\n{lines}", positions.len()))
        }
        name @ "seeds.json" => (name, format!("[[{}]]\n", numbers(", ", &in_space).join("],\n["))),
        name => {
            let names = if is_plane { "x, y" } else { "x, y, z" };
            let names = if radii.is_some() { format!("{names}, radius") } else { names.to_owned() };
            (name, format!("{names}\n{}\n", numbers(", ", &radius).join("\n")))
        }
    }
}
