//! A network of random grains beside exact values of Poisson-Voronoi cells.

use polycrystal::{Certificate, Elements, Side, Surface};
use serde::Serialize;

use crate::LabelledFile;

/// A number that has an exact value for Poisson-Voronoi grains.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Statistic {
    /// What it is.
    pub name: &'static str,
    /// Its value in the file.
    pub value: f64,
    /// The exact value for flat grains without walls.
    pub exact: f64,
    /// By how much as many such grains differ from that by chance: one standard deviation.
    pub standard_error: f64,
}

/// Options that leave random seeds the Poisson process that they are, whatever or with what follows them.
const PLAIN_OPTIONS: [&str; 22] = [
    "--arrays",
    "--seeds",
    "--seeding random",
    "--lloyd 0",
    "--periodic none",
    "--periodic x,y,z",
    "--periodic x,y",
    "--rng-seed",
    "--dim",
    "--box",
    "--faces",
    "--edge-length",
    "--relax",
    "--wall-tension",
    "--free",
    "--regularize",
    "-n",
    "--levels",
    "--junctions",
    "--names",
    "--voxels",
    "--ascii",
];

/// Numbers with exact values, where the file says that its seeds are uniform and random: Meijering 1953 for means; variances of
/// volume and area as integrals, Gilbert 1962; spread of angles from their exact density, see the report. Standard errors
/// of n grains fall with the square root of n; for n = 1 they are what 60 sets of 400 periodic grains (in the plane 150) gave.
pub(super) fn statistics(
    file: &LabelledFile,
    surface: &Surface<'_>,
    certificate: &Certificate,
) -> Vec<Statistic> {
    let Some(command_line) = &file.command_line else { return Vec::new() };
    let mut options = command_line.split(" -").skip(1);
    let is_plain = |option: &str| {
        let option = format!("-{option}");
        let name = option.split(' ').next();
        PLAIN_OPTIONS.iter().any(|plain| option == *plain || name == Some(*plain))
    };
    let (is_plane, all_axes) = match surface.elements {
        Elements::Triangles(_) => (false, "--periodic x,y,z"),
        Elements::Segments(_) => (true, "--periodic x,y"),
    };
    let is_periodic = command_line.contains("--periodic ") && !command_line.contains("--periodic none");
    let count = certificate.grain_volumes.len() as f64;
    // One grain has nothing but walls; and where only some walls are periodic, they cannot be told from the others.
    if !certificate.is_good()
        || certificate.grain_volumes.len() < 2
        || !command_line.contains("--seeds ")
        || is_periodic && !command_line.contains(&format!("{all_axes} "))
        || !options.all(is_plain)
    {
        return Vec::new();
    }
    let volume: f64 = certificate.grain_volumes.iter().map(|(_, volume)| volume).sum();
    let mean = volume / count;
    let variance = certificate.grain_volumes.iter().map(|(_, volume)| (volume / mean - 1.0).powi(2));
    let variance = variance.sum::<f64>() / count;
    let size = boundary_size(surface, is_periodic) / volume;
    let face_count: usize = surface.sides.iter().map(grain_count).sum();
    let angles = certificate.angles.map(|angles| angles.standard_deviation);
    let statistic = |name, value, exact, of_one: f64| Statistic {
        name,
        value,
        exact,
        standard_error: of_one / count.sqrt(),
    };
    let angles = |exact, of_one| {
        angles.map(|value| statistic("standard deviation of angles, in degrees,", value, exact, of_one))
    };
    let (mut statistics, angles) = if is_plane {
        let length = size * mean.sqrt();
        let statistics = vec![
            statistic("boundary length per area, over r^(1/2),", length, 2.0, 0.22),
            statistic("variance of areas, over the mean's square,", variance, 0.280_176, 0.55),
        ];
        (statistics, angles(29.40, 12.0))
    } else {
        let area = size * mean.cbrt();
        let statistics = vec![
            statistic("boundary area per volume, over r^(1/3),", area, 2.91044, 0.23),
            statistic("faces a grain", face_count as f64 / count, 15.53546, 1.94),
            statistic("variance of volumes, over the mean's square,", variance, 0.179_032, 0.39),
        ];
        (statistics, angles(23.85, 6.6))
    };
    statistics.extend(angles);
    statistics
}

/// Area (in the plane: length) of the boundaries between grains; what comes twice in a periodic network counts half each time.
fn boundary_size(surface: &Surface<'_>, is_periodic: bool) -> f64 {
    let at = |point: &u32| surface.points[*point as usize];
    let elements = (0u32..).take(surface.elements.len());
    let share = |element: u32| match (grain_count(&surface.sides_of(element)), is_periodic) {
        (2, _) => 1.0,
        (_, true) => 0.5,
        (_, false) => 0.0,
    };
    let size = elements.map(|element| {
        share(element)
            * match surface.elements.corners(element) {
                [a, b, c] => (at(b) - at(a)).cross(at(c) - at(a)).length() / 2.0,
                [a, b] => at(a).distance(at(b)),
                _ => 0.0,
            }
    });
    size.sum()
}

fn grain_count(sides: &[Side; 2]) -> usize {
    sides.iter().filter(|side| **side != Side::Exterior).count()
}
