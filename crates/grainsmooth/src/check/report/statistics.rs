//! What a network is like, and where theory says it, what it should be like.

use polycrystal::{Certificate, Elements, Side, Surface};
use serde::Serialize;
use toml::{Table, Value};

use crate::LabelledFile;

/// A figure of a network.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Statistic {
    /// What it is.
    pub name: &'static str,
    /// Its value in the file.
    pub value: f64,
    /// What it is of Poisson-Voronoi cells, where the network consists of them.
    pub poisson_voronoi: Option<Expectation>,
}

/// The exact value of a figure, and how far a network of finite size is from it by chance.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Expectation {
    /// In an unbounded network.
    pub exact: f64,
    /// One standard deviation among networks of as many grains.
    pub standard_error: f64,
}

/// Settings that have nothing to do with what theory says of flat grains, or that flat grains do not heed.
const FREE_SETTINGS: [&str; 16] = [
    "arrays",
    "ascii",
    "box",
    "dim",
    "edge-length",
    "faces",
    "free",
    "junctions",
    "levels",
    "names",
    "regularize",
    "rng-seed",
    "seeds",
    "voxels",
    "vtk-encoding",
    "wall-tension",
];

/// Figures of a good network of at least two grains, beside exact values where [`is_poisson_voronoi`]: Meijering 1953 for means;
/// variances of volume and area as integrals, Gilbert 1962; spread of angles from their exact density, see the report. Standard
/// errors of n grains fall with the square root of n; for n = 1 they are what 60 sets of 400 periodic grains (in the plane 150) gave.
pub(super) fn statistics(
    file: &LabelledFile,
    surface: &Surface<'_>,
    certificate: &Certificate,
) -> Vec<Statistic> {
    let count = certificate.grain_volumes.len() as f64;
    let (is_plane, all_axes) = match surface.elements {
        Elements::Triangles(_) | Elements::Refined(_) => (false, "x,y,z"),
        Elements::Segments(_) => (true, "x,y"),
    };
    let text = |key| file.settings.as_ref().and_then(|settings| settings.get(key)?.as_str());
    let is_periodic = text("periodic") == Some(all_axes);
    // One grain has nothing but walls. Where only some walls are periodic, or grains are cut there, they cannot be told from the
    // others.
    if !certificate.is_good()
        || certificate.grain_volumes.len() < 2
        || !is_periodic && text("periodic").is_some_and(|axes| axes != "none")
        || text("periodic-cut") == Some("box")
    {
        return Vec::new();
    }
    let has_theory = file.settings.as_ref().is_some_and(|settings| is_poisson_voronoi(settings, all_axes));
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
        poisson_voronoi: has_theory.then(|| Expectation { exact, standard_error: of_one / count.sqrt() }),
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

/// Whether settings make the Voronoi cells of a Poisson process, as they are and without walls.
fn is_poisson_voronoi(settings: &Table, all_axes: &str) -> bool {
    let fits = |(key, value): (&String, &Value)| match key.as_str() {
        "seeding" => value.as_str() == Some("random"),
        "lloyd" => value.as_integer() == Some(0),
        "periodic" => value.as_str() == Some(all_axes),
        "relax" => value.as_float() == Some(0.0),
        key => FREE_SETTINGS.contains(&key),
    };
    settings.contains_key("seeds") && settings.iter().all(fits)
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
            * match &*surface.elements.corners(element) {
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
