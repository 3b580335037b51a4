//! Regularisation that knows where relaxation leads.

use voronoi::{Dimension, Tessellation};

use crate::relax::predicted_points;
use crate::{
    Attempt, Collapsed, FaceMesh, Junctions, Network, NetworkError, Tuning, remove_edges_that_shorten,
    remove_short_edges,
};

/// The cells without edges that are short, or will be: [`remove_short_edges`] with `length`, and once more, with twice
/// that, for the places at which a relaxation of the flat cells puts the vertices.
///
/// Nothing that is left is far from its cells' own places: only what collapses is told by relaxation. In the plane the
/// second step, which costs a tenth of a relaxation, is left out: lines there make no thin triangles.
///
/// Where the flat cells tangle when they are relaxed, the second step is left out too, and the attempt tells why.
///
/// ```
/// use glam::DVec3;
/// use polycrystal::regular_cells;
/// use voronoi::{Domain, Tessellation};
///
/// let seeds: Vec<DVec3> = (1..=20).map(|k| (DVec3::new(0.819, 0.671, 0.550) * f64::from(k)).fract()).collect();
/// let cells = Tessellation::new(&Domain::unit_cube(), &seeds)?;
/// let regular = regular_cells(&cells, 0.1)?;
/// assert!(regular.collapsed.edges > 0);
/// assert!(regular.cells.vertices().len() < cells.vertices().len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As of [`Network::new`] and [`relax`](crate::relax), but for geometry that tangles.
pub fn regular_cells(cells: &Tessellation, length: f64) -> Result<RegularCells, NetworkError> {
    regular_cells_tuned(cells, length, &Tuning::default())
}

/// As [`regular_cells`], with other numbers than the tuned ones.
///
/// # Errors
/// As of [`regular_cells`].
#[doc(hidden)]
pub fn regular_cells_tuned(
    cells: &Tessellation,
    length: f64,
    tuning: &Tuning,
) -> Result<RegularCells, NetworkError> {
    let (regular, collapsed) = remove_short_edges(cells, length);
    if length == 0.0 || tuning.forecast_steps == 0 || cells.domain().dimension() == Dimension::Two {
        return Ok(RegularCells { cells: regular, collapsed, given_up: Vec::new() });
    }
    let volumes = cells.cell_measures().iter().map(|cell| cell.volume).collect();
    let relaxed = Network::with_face_mesh(&regular, FaceMesh::SparseFan, Junctions::Crease, 0)
        .and_then(|(network, flat)| predicted_points(&network.with_cell_volumes(volumes), &flat, tuning));
    let points = match relaxed {
        Ok(points) => points,
        Err(error) if error.is_tangle() => {
            let mut given_up = Vec::new();
            error.give_up("predicting which edges become short", &mut given_up);
            return Ok(RegularCells { cells: regular, collapsed, given_up });
        }
        Err(error) => return Err(error),
    };
    // Control points begin with the vertices.
    let length = tuning.forecast_factor * length;
    let (cells, more) = remove_edges_that_shorten(&regular, length, &points[..regular.vertices().len()]);
    let collapsed = Collapsed { edges: collapsed.edges + more.edges, faces: collapsed.faces + more.faces };
    Ok(RegularCells { cells, collapsed, given_up: Vec::new() })
}

/// Cells without short edges.
#[derive(Debug, Clone)]
pub struct RegularCells {
    /// The cells that are left; of each grain one.
    pub cells: Tessellation,
    /// What was taken out of them.
    pub collapsed: Collapsed,
    /// Why edges that become short were not taken out, where they should have been.
    pub given_up: Vec<Attempt>,
}
