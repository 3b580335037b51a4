//! Options about phases.

use clap::Args;
use grainsmooth::PhaseOptions;

/// What the phases are.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Phases")]
pub struct PhaseArguments {
    /// Make a phase of a name, with a share of the volume that is exact (in 2D of the area); give it again for each phase
    ///
    /// Shares add up to 1. Behind them may stand what the grains of a phase have of their own: diameters= as of --diameters, texture= as of
    /// --texture, symmetry= as of --crystal-symmetry.
    ///
    /// Example: --phase ferrite:0.8 --phase 'austenite:0.2,texture=goss(10)'
    #[arg(long, value_name = "NAME:SHARE[,KEY=VALUE]", num_args = 1, conflicts_with_all = ["volumes", "lattice", "misorientations"])]
    phase: Vec<PhaseOptions>,
}

impl PhaseArguments {
    /// What is asked for.
    pub fn options(&self) -> Vec<PhaseOptions> {
        self.phase.clone()
    }
}
