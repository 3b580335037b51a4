//! Regularisation that knows where relaxation leads.

use voronoi::{Collapsed, Dimension, Tessellation};

use crate::relax::foreseen_points;
use crate::{Attempt, FaceMesh, Junctions, Network, NetworkError};

/// Factor by which lines that relaxation will have shortened may be longer than others to collapse: what is short by then goes on
/// shrinking, and holds the lines around up.
const FUTURE: f64 = 2.0;

/// The cells without edges that are short, or will be: [`Tessellation::regularized`] with `length`, and once more, with twice
/// that, for the places at which a relaxation of the flat cells puts the vertices.
///
/// Nothing that is left is far from its cells' own places: only what collapses is told by relaxation. In the plane the
/// second step, which costs a tenth of a relaxation, is left out: lines there make no thin triangles.
///
/// Where the flat cells tangle when they are relaxed, the second step is left out too, and the attempt tells why.
///
/// # Errors
/// As of [`Network::new`] and [`relax`](crate::relax), but for geometry that tangles.
pub fn regular_cells(cells: &Tessellation, length: f64) -> Result<RegularCells, NetworkError> {
    let (regular, collapsed) = cells.regularized(length);
    if length == 0.0 || cells.domain().dimension() == Dimension::Two {
        return Ok(RegularCells { cells: regular, collapsed, given_up: None });
    }
    let volumes = cells.cell_measures().iter().map(|cell| cell.volume).collect();
    let relaxed = Network::with_face_mesh(&regular, FaceMesh::SparseFan, Junctions::Crease, 0)
        .and_then(|(network, flat)| foreseen_points(&network.with_cell_volumes(volumes), &flat));
    let points = match relaxed {
        Ok(points) => points,
        Err(error) if error.is_tangle() => {
            let given_up = Some(Attempt::new("foreseeing which edges become short", &error));
            return Ok(RegularCells { cells: regular, collapsed, given_up });
        }
        Err(error) => return Err(error),
    };
    // Control points begin with the vertices.
    let (cells, more) = regular.regularized_for(FUTURE * length, &points[..regular.vertices().len()]);
    let collapsed = Collapsed { edges: collapsed.edges + more.edges, faces: collapsed.faces + more.faces };
    Ok(RegularCells { cells, collapsed, given_up: None })
}

/// Cells without short edges.
#[derive(Debug, Clone)]
pub struct RegularCells {
    /// The cells that are left; of each grain one.
    pub cells: Tessellation,
    /// What was taken out of them.
    pub collapsed: Collapsed,
    /// Why edges that become short were not taken out, where they should have been.
    pub given_up: Option<Attempt>,
}
