//! What is asked of the elements that fill grains, and of what solvers need beside them.

use clap::{Args, ValueEnum};
use serde::Serialize;

use super::spelling::{is_usual, whole_number};

/// What is asked of the elements that fill grains, and of what solvers need beside them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Args, Serialize)]
#[command(next_help_heading = "Finite elements")]
#[serde(rename_all = "kebab-case")]
pub struct VolumeMeshOptions {
    /// Write tetrahedra (in 2D triangles) that fill the grains to .msh and .vtu, which otherwise hold boundaries; .inp and .bdf
    /// always hold such elements; with --voxels .vtu holds hexahedra (squares)
    ///
    /// Example: --elements-per-grain 5 --volume-mesh -o grains.vtu
    #[arg(long)]
    #[serde(skip_serializing_if = "is_usual")]
    pub volume_mesh: bool,

    /// Order of the tetrahedra or triangles: 1, or 2 for a node in the middle of each edge, on the smooth surface where boundaries are
    /// remeshed [default: 1]
    ///
    /// Example: --elements-per-grain 3 --order 2 -o grains.inp
    #[arg(long, value_name = "P", value_parser = whole_number(1..=2_u8), allow_negative_numbers = true)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub order: Option<u8>,

    /// Tie nodes of .inp that are one period apart by equations, with a node for each axis that controls the mean strain
    ///
    /// Example: --periodic x,y,z --elements-per-grain 4 --periodic-equations -o grains.inp
    #[arg(long)]
    #[serde(skip_serializing_if = "is_usual")]
    pub periodic_equations: bool,

    /// Give each grain of .inp its own nodes, and put cohesive elements (COH3D6 of Abaqus, in 2D COH2D4) between the grains
    ///
    /// Example: --elements-per-grain 4 --cohesive -o grains.inp
    #[arg(long)]
    #[serde(skip_serializing_if = "is_usual")]
    pub cohesive: bool,

    /// What holds across the plane of 2D elements: no stress (CPS3, CPS6 and CPS4 of .inp), or no strain (CPE3, CPE6, CPE4)
    /// [default: stress]
    ///
    /// Example: --dim 2 --elements-per-grain 5 --plane-state strain -o grains.inp
    #[arg(long, value_name = "STATE", value_enum)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plane_state: Option<PlaneState>,

    /// Write a job for CalculiX and Abaqus next to .inp: the box is stretched along x, with the elastic constants of a crystal for each phase
    ///
    /// Example: --texture random --elements-per-grain 4 --solver-deck tension-x -o grains.inp
    #[arg(long, value_name = "JOB", value_enum)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub solver_deck: Option<SolverDeck>,
}

/// What holds across the plane of elements.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum PlaneState {
    /// No stress, as in a thin sheet.
    #[default]
    Stress,
    /// No strain, as in the middle of a thick body.
    Strain,
}

/// A job for a solver.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum SolverDeck {
    /// The box is pulled along x; its other sides are free.
    TensionX,
}
