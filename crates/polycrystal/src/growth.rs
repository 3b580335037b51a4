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
use crate::flow::relaxation::{Relaxation, RelaxationStep};
use crate::network::tension::{checked_mobility, checked_tension};
use crate::relax::cells::still;
use crate::{Boundary, GrainId, NetworkError, Tuning};
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
    mut watch: impl FnMut(RelaxationStep<'_>),
) -> Result<GrownCells, NetworkError> {
    grow_cells_tuned(cells, recipe, time, &GrowthTuning::default(), &mut watch)
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
    watch: &mut dyn FnMut(RelaxationStep<'_>),
) -> Result<GrownCells, NetworkError> {
    Relaxation::Time(time).check()?;
    let tensions = Unit::of(cells, recipe.network.tension, checked_tension)?;
    let mobilities = Unit::of(cells, recipe.mobility, checked_mobility)?;
    let tension = |boundary: &Boundary| tensions.measure((recipe.network.tension)(boundary));
    let mobility = |boundary: &Boundary| mobilities.measure((recipe.mobility)(boundary));
    let network = NetworkRecipe { tension: &tension, ..recipe.network };
    let in_units = GrowthRecipe { network, mobility: &mobility };
    let time = if tensions.is_of_grains { time } else { 0.0 };
    let of_relaxation = Tuning::default();
    let (mut cells, vanished) = match cells.domain().dimension() {
        Dimension::Two => {
            let front = Curves::new(cells, &in_units, tuning);
            grow(front, cells, time, tuning.largest_error_in_plane, watch)
        }
        Dimension::Three if time == 0.0 => Ok((still(cells, &network, &of_relaxation)?, Vec::new())),
        Dimension::Three => {
            let front = Sheets::new(cells, &in_units, tuning, &of_relaxation);
            grow(front, cells, time, tuning.largest_error_in_space, watch)
        }
    }?;
    cells.network = cells.network.with_tensions(recipe.network.tension)?.with_mobilities(recipe.mobility)?;
    Ok(GrownCells { cells, vanished })
}

/// Lets boundaries move for a time; gives the grains in the end, and those that have vanished.
fn grow(
    mut front: impl Front,
    cells: &Tessellation,
    time: f64,
    largest_error: f64,
    watch: &mut dyn FnMut(RelaxationStep<'_>),
) -> Result<(RelaxedCells, Vec<Vanished>), NetworkError> {
    let History { steps, reconnections, vanished } =
        if time > 0.0 { advance(&mut front, cells, time, largest_error, watch)? } else { History::default() };
    Ok((front.finish(steps, reconnections, time)?, vanished))
}
