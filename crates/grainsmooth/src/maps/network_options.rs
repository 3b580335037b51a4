//! What the network of a map is to be like.

use clap::Args;
use polycrystal::Relaxation;

use crate::config::settings::parse_relaxation;
use crate::spelling::whole_number;

/// What the network of a map is to be like.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Map")]
pub struct MapNetworkOptions {
    /// Collapse edges of boundaries that are shorter than H voxels, and give grains their volumes again; 0 keeps all edges, and every voxel in its grain [default: 1.68; in the plane 0]
    ///
    /// Around small grains edges stay shorter, at most a quarter of the grain.
    ///
    /// Example: grainsmooth smooth map.vti --decimate 3
    #[arg(long, value_name = "H", value_parser = not_negative, allow_negative_numbers = true)]
    pub decimate: Option<f64>,

    /// Fit a power diagram instead of smooth boundaries: convex cells with the volumes of the grains, and with their centroids as far as that goes
    ///
    /// A synthetic twin of the map. The summary tells how many voxels agree.
    ///
    /// Example: grainsmooth smooth map.vti --fit-cells -o twin.vtp
    #[arg(long, conflicts_with = "decimate")]
    pub fit_cells: bool,

    /// Times that boundaries are subdivided in the end; each time, a triangle becomes four (in the plane, a segment two)
    ///
    /// The points that boundaries had before stay where they are, but for what gives grains their volumes again.
    ///
    /// Example: grainsmooth smooth map.vti --decimate 3 -n 2
    #[arg(short = 'n', long, value_name = "LEVELS", default_value_t = 0, value_parser = whole_number(0..=99_u32), allow_negative_numbers = true)]
    pub levels: u32,

    /// Move boundaries toward the equilibrium of their tension for this time, in units of the mean grain size squared, or to `equilibrium`; grains keep their volumes [default: 0]
    ///
    /// This moves boundaries away from where they were measured. Neighbours stay neighbours.
    ///
    /// Example: grainsmooth smooth map.vti --relax 0.1
    #[arg(long = "relax", value_name = "T", value_parser = parse_relaxation, allow_negative_numbers = true)]
    pub relaxation: Option<Relaxation>,
}

impl MapNetworkOptions {
    /// The relaxation asked for, if boundaries are to move.
    pub fn relaxation(&self) -> Option<Relaxation> {
        self.relaxation.filter(|relaxation| *relaxation != Relaxation::Time(0.0))
    }

    /// The first option that is given and only maps have.
    pub fn first_of_maps(&self) -> Option<&'static str> {
        self.decimate.map(|_| "--decimate").or_else(|| self.fit_cells.then_some("--fit-cells"))
    }

    /// Below how many voxels edges collapse. Lines in the plane are few.
    pub(crate) fn shortest_edge(&self, is_plane: bool) -> f64 {
        self.decimate.unwrap_or(if is_plane { 0.0 } else { DECIMATE })
    }
}

/// In voxels: below this length edges collapse where nothing else is asked. On 100^3 voxels with 204 grains, at equilibrium and flat, it leaves a ninth of the triangles, with boundaries 9 and
/// 8 % farther from the true ones. 1.6 left 1/8.4 of them, 8 and 7 % farther, 1.7 1/9.2, 11 and 8 % farther.
const DECIMATE: f64 = 1.68;

fn not_negative(text: &str) -> Result<f64, String> {
    let length = text.parse().ok().filter(|length: &f64| length.is_finite() && *length >= 0.0);
    length.ok_or_else(|| "give a finite number of voxels, 0 or more".to_owned())
}
