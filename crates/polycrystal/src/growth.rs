//! Grain growth, whatever vanishes on the way.
//!
//! Between events boundaries move by their curvature, in steps as long as their error allows. After each step grains that are nearly gone
//! vanish (T2), and edges that are nearly gone make neighbours switch (T1).

mod curves;
mod events;
mod front;
mod sheets;
mod step;
pub(crate) mod tuning;

use voronoi::{Dimension, Tessellation};

use crate::energy::unit::Unit;
use crate::flow::recipe::{NetworkRecipe, RelaxedCells};
use crate::flow::relaxation::{Relaxation, RelaxationStep, Relaxed, TIME_OF_KEPT_TOPOLOGY};
use crate::flow::settling::Settled;
use crate::network::tension::{checked_mobility, checked_tension};
use crate::relax::cells::{smoothed, still};
use crate::{Boundary, FaceMesh, GrainId, NetworkError, Tuning};
use curves::Curves;
use front::{Front, History, advance};
use sheets::Sheets;
use tuning::GrowthTuning;

/// How a network is made of grains that grow.
#[derive(Clone, Copy)]
pub struct GrowthRecipe<'a> {
    /// How it is made in the end. In the plane its control points are those that the boundaries have moved by.
    pub network: NetworkRecipe<'a>,
    /// The mobility of each boundary, in any unit.
    pub mobility: &'a (dyn Fn(&Boundary) -> f64 + Sync),
}

/// A grain that has shrunk to nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vanished {
    /// The grain.
    pub grain: GrainId,
    /// When, in units of the mean grain size squared at the start.
    pub time: f64,
}

/// What growth gives.
#[derive(Debug, Clone)]
pub struct GrownCells {
    /// The network of the grains that are left. Grains keep their numbers; those that have vanished have no boundaries, and the volume 0.
    pub cells: RelaxedCells,
    /// The grains that vanished, the first one first.
    pub vanished: Vec<Vanished>,
}

/// Lets the grains of cells grow for a time under curvature flow, in units of the mean grain size squared at the start; means of tension and
/// mobility at the start are 1.
///
/// Grains vanish and switch neighbours on the way, and keep their numbers. The network is valid.
///
/// In space boundaries are coarse while they move, fans of triangles. In the end they become as smooth as of [`relax_cells`](crate::relax_cells),
/// and grains keep the volumes that they have come to.
///
/// ```
/// use glam::DVec3;
/// use polycrystal::{FaceMesh, GrowthRecipe, Junctions, NetworkRecipe, grow_cells};
/// use voronoi::{Domain, Tessellation};
///
/// let seeds: Vec<DVec3> = (0..30).map(|k| DVec3::new(f64::from(k * 7 % 30) + 0.5, f64::from(k) + 0.5, 0.0) / 30.0).collect();
/// let cells = Tessellation::new(&Domain::unit_square(), &seeds)?;
/// let network =
///     NetworkRecipe { face_mesh: FaceMesh::Fan, junctions: Junctions::Crease, levels: 1, tension: &|_| 1.0 };
/// let grown = grow_cells(&cells, &GrowthRecipe { network, mobility: &|_| 1.0 }, 3.0, |_| ())?;
/// assert_eq!(grown.cells.network.grains_left() + grown.vanished.len(), 30);
/// assert!(grown.cells.network.grains_left() < 20);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`NetworkError::BadRelaxationTime`], [`NetworkError::BadTension`], [`NetworkError::BadMobility`]; [`NetworkError::GrowthNotFollowed`];
/// [`NetworkError::Invalid`]; in space also as of [`relax_cells`](crate::relax_cells).
pub fn grow_cells(
    cells: &Tessellation,
    recipe: &GrowthRecipe<'_>,
    time: f64,
    watch: impl FnMut(RelaxationStep<'_>),
) -> Result<GrownCells, NetworkError> {
    grow_cells_tuned(cells, recipe, time, &GrowthTuning::default(), watch)
}

/// As [`grow_cells`], with other numbers than the tuned ones.
///
/// # Errors
/// As of [`grow_cells`].
#[doc(hidden)]
pub fn grow_cells_tuned(
    cells: &Tessellation,
    recipe: &GrowthRecipe<'_>,
    time: f64,
    tuning: &GrowthTuning,
    mut watch: impl FnMut(RelaxationStep<'_>),
) -> Result<GrownCells, NetworkError> {
    Relaxation::Time(time).check()?;
    let tensions = Unit::of(cells, recipe.network.tension, checked_tension)?;
    let mobilities = Unit::of(cells, recipe.mobility, checked_mobility)?;
    let tension = |boundary: &Boundary| tensions.measure((recipe.network.tension)(boundary));
    let mobility = |boundary: &Boundary| mobilities.measure((recipe.mobility)(boundary));
    let network = NetworkRecipe { tension: &tension, ..recipe.network };
    let in_units = GrowthRecipe { network, mobility: &mobility };
    let time = if tensions.is_of_grains { time } else { 0.0 };
    let (mut cells, vanished) = match cells.domain().dimension() {
        Dimension::Two => grow_in_plane(cells, &in_units, time, tuning, &mut watch),
        Dimension::Three => grow_in_space(cells, &in_units, time, tuning, &mut watch),
    }?;
    cells.network = cells.network.with_tensions(recipe.network.tension)?.with_mobilities(recipe.mobility)?;
    Ok(GrownCells { cells, vanished })
}

/// As [`grow_cells`] in the plane, with tensions and mobilities whose means are 1.
fn grow_in_plane(
    cells: &Tessellation,
    recipe: &GrowthRecipe<'_>,
    time: f64,
    tuning: &GrowthTuning,
    watch: &mut impl FnMut(RelaxationStep<'_>),
) -> Result<(RelaxedCells, Vec<Vanished>), NetworkError> {
    let mut curves = Curves::new(cells, recipe, tuning);
    let is_flat = time == 0.0;
    let History { steps, reconnections, vanished } =
        if is_flat { History::default() } else { advance(&mut curves, cells, time, tuning, watch)? };
    let (network, points) = curves.network()?;
    let relaxed = Relaxed { level: 0, points, steps, time, given_up: Vec::new(), is_flat };
    let finest = relaxed.finest_points(&network);
    let volumes = network.grain_volumes(network.finest(), &finest);
    let cells = RelaxedCells::validated(network.with_cell_volumes(volumes), relaxed, &finest)?;
    Ok((RelaxedCells { reconnections, ..cells }, vanished))
}

/// As [`grow_cells`] in space, with tensions and mobilities whose means are 1.
fn grow_in_space(
    cells: &Tessellation,
    recipe: &GrowthRecipe<'_>,
    time: f64,
    tuning: &GrowthTuning,
    watch: &mut impl FnMut(RelaxationStep<'_>),
) -> Result<(RelaxedCells, Vec<Vanished>), NetworkError> {
    let of_relaxation = Tuning::default();
    if time == 0.0 {
        return Ok((still(cells, &recipe.network, &of_relaxation)?, Vec::new()));
    }
    let mut sheets = Sheets::new(cells, recipe, tuning, &of_relaxation);
    let History { steps, reconnections, vanished } = advance(&mut sheets, cells, time, tuning, &mut *watch)?;
    let volumes = sheets.volumes_now();
    let Sheets { complex, shape, .. } = sheets;
    let settled = Settled { complex, shape, reconnections, steps, time };
    // Time does not pass any more: what is left to do is for points that have not moved yet.
    let smoothing = match recipe.network.face_mesh {
        FaceMesh::Fan | FaceMesh::SparseFan => tuning.smoothing,
        FaceMesh::Plain | FaceMesh::Refined { .. } => TIME_OF_KEPT_TOPOLOGY,
    };
    let smoothing = Relaxation::Time(smoothing);
    let cells = smoothed(&settled, &volumes, &recipe.network, smoothing, &of_relaxation, &mut |_| ())?;
    let relaxed = Relaxed { steps, time, ..cells.relaxed };
    Ok((RelaxedCells { relaxed, ..cells }, vanished))
}
