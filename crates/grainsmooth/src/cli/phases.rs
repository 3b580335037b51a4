//! Options about phases.

use clap::Args;
use grainsmooth::{InsideOptions, PhaseOptions};

/// What the phases are, and what their grains are divided by.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Phases")]
pub struct PhaseArguments {
    /// Make a phase of a name, with a share of the volume that is exact (in 2D of the area); give it again for each phase
    ///
    /// Shares add up to 1. Behind them may stand what the grains of a phase have of their own: diameters= as of --diameters, texture= as of
    /// --texture, symmetry= as of --crystal-symmetry; and place=, where its grains are among the others: interior, boundaries, triple-lines,
    /// quadruple-points, clustered, dispersed.
    ///
    /// Example: --phase ferrite:0.8 --phase 'austenite:0.2,texture=goss(10)'
    #[arg(long, value_name = "NAME:SHARE[,KEY=VALUE]", num_args = 1, conflicts_with_all = ["volumes", "lattice", "misorientations"])]
    phase: Vec<PhaseOptions>,
    /// Divide the grains, or those of one phase, by a second tessellation: layers of a width, or Voronoi cells of a mean diameter, in the
    /// unit of --box; give it again for other phases
    ///
    /// Each part is a grain of its own, with an orientation of its own, and Parent tells whose part it is. Grains keep their volumes. Layers lie in
    /// a random direction in each grain, or across normal=; cells have lognormal diameters of a coefficient of variation cv= (0.35).
    ///
    /// Example: --inside 'lamellae(width=0.05)'; --inside 'beta:voronoi(diameter=0.1)' for one phase
    #[arg(long, value_name = "[PHASE:]PATTERN(LENGTH)", num_args = 1)]
    inside: Vec<InsideOptions>,
}

impl PhaseArguments {
    /// What is asked for.
    pub fn options(&self) -> Vec<PhaseOptions> {
        self.phase.clone()
    }

    /// What divides grains.
    pub fn inside(&self) -> Vec<InsideOptions> {
        self.inside.clone()
    }
}
