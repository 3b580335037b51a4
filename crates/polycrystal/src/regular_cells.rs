//! Regularisation that knows where relaxation leads.

use voronoi::{Collapsed, Dimension, Tessellation};

use crate::relax::foreseen_points;
use crate::{FaceMesh, Junctions, Network};

/// Factor by which lines that relaxation will have shortened may be longer than others to collapse: what is short by then goes on
/// shrinking, and holds the lines around up.
const FUTURE: f64 = 2.0;

/// The cells without edges that are short, or will be: [`Tessellation::regularized`] with `length`, and once more, with twice
/// that, for the places at which a relaxation of the flat cells puts the vertices.
///
/// Nothing that is left is far from its cells' own places: only what collapses is told by relaxation. In the plane the
/// second step, which costs a tenth of a relaxation, is left out: lines there make no thin triangles.
pub fn regular_cells(cells: &Tessellation, length: f64) -> (Tessellation, Collapsed) {
    let (regular, collapsed) = cells.regularized(length);
    if length == 0.0 || cells.domain().dimension() == Dimension::Two {
        return (regular, collapsed);
    }
    let volumes = cells.cell_measures().iter().map(|cell| cell.volume).collect();
    let relaxed = Network::with_face_mesh(&regular, FaceMesh::SparseFan, Junctions::Crease, 0)
        .and_then(|(network, flat)| foreseen_points(&network.with_cell_volumes(volumes), &flat));
    // Where these cells cannot be relaxed, nothing more is known of them; the network itself will tell why.
    let Ok(points) = relaxed else { return (regular, collapsed) };
    // Control points begin with the vertices.
    let (regular, more) = regular.regularized_for(FUTURE * length, &points[..regular.vertices().len()]);
    let collapsed = Collapsed { edges: collapsed.edges + more.edges, faces: collapsed.faces + more.faces };
    (regular, collapsed)
}
