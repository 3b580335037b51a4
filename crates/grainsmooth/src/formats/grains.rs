//! Every grain as a closed surface of its own.

use std::f64::consts::PI;
use std::io::{self, Write};

use polycrystal::Side;
use voronoi::Dimension;

use super::format::GrainSurface;
use super::surface::Surface;
use crate::FileOptions;
use crate::names::SEED_ID;
use crate::vtk::{Array, Cells, PolyData, Values, VtkFormat, write_vtk};

/// What is measured of a grain's surface, its parts on walls included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct GrainMeasure {
    pub(crate) volume: f64,
    pub(crate) area: f64,
    /// Number of other grains that it touches.
    pub(crate) neighbors: i32,
    /// Area of the ball of the same volume, as a share of the grain's area.
    pub(crate) sphericity: f64,
}

impl GrainMeasure {
    /// Measures the closed surface of a grain.
    pub(crate) fn of(surface: &Surface<'_>) -> Self {
        let origin = surface.points[0];
        let (mut volume, mut area) = (0.0, 0.0);
        for [a, b, c] in
            surface.triangles().map(|triangle| surface.corners(triangle).map(|corner| corner - origin))
        {
            volume += a.dot(b.cross(c)) / 6.0;
            area += (b - a).cross(c - a).length() / 2.0;
        }
        let mut beyond: Vec<Side> = surface.parts.iter().map(|part| part.sides[1]).collect();
        beyond.retain(|side| matches!(side, Side::Grain(_)));
        beyond.sort_unstable();
        beyond.dedup();
        let neighbors = i32::try_from(beyond.len()).expect("fewer grains than 2^31");
        let sphericity = PI * Dimension::Three.ball_diameter(volume).powi(2) / area;
        Self { volume, area, neighbors, sphericity }
    }
}

/// A grain with the arrays of the `grains` block, and what lies beyond each triangle.
pub(super) fn write_vtk_grain(file: &GrainSurface<'_>, out: &mut dyn Write) -> io::Result<()> {
    let &GrainSurface { polycrystal, surface, grain, tuples } = file;
    let FileOptions { names, encoding, .. } = polycrystal.file();
    let seed = polycrystal.grains().ids[grain.index()].cast_signed();
    let triangles: Vec<[u32; 3]> = surface.triangles().collect();
    let of_triangle = surface.parts.iter().flat_map(|part| surface.triangles_of(part).map(move |_| part));
    let parts: Vec<_> = of_triangle.collect();
    let GrainMeasure { volume, area, neighbors, sphericity } = GrainMeasure::of(surface);
    let count = triangles.len();
    let side = |index: usize, side: usize| names.side_number(parts[index].sides[side]);
    let boundary_id = |index: usize| parts[index].boundary.0.cast_signed();
    let mut cell_arrays = vec![
        Array { name: names.grain(), values: Values::each(count, |index| side(index, 0)) },
        Array { name: SEED_ID, values: Values::each(count, |_| seed) },
        Array { name: "Beyond", values: Values::each(count, |index| side(index, 1)) },
        Array { name: "BoundaryId", values: Values::each(count, boundary_id) },
        Array { name: "Volume", values: Values::each(count, |_| volume) },
        Array { name: "Area", values: Values::each(count, |_| area) },
        Array { name: "Neighbors", values: Values::each(count, |_| neighbors) },
        Array { name: "Sphericity", values: Values::each(count, |_| sphericity) },
    ];
    let of_grain =
        |_| surface.parts.first().and_then(|part| part.sides[0].grain()).map(|grain| grain.index());
    cell_arrays.extend(tuples.iter().map(|tuples| tuples.of_cells(count, of_grain)));
    let data = PolyData {
        points: &surface.points,
        cells: Cells::Triangles(&triangles),
        point_arrays: Vec::new(),
        cell_arrays,
        field: polycrystal.field(),
    };
    write_vtk(&data, VtkFormat::Vtp, encoding, out)
}
