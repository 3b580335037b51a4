//! A job for CalculiX and Abaqus that runs on a file of elements.

use std::io::{self, Write};
use std::path::Path;

use glam::DVec3;
use texture::CrystalSymmetry;
use voronoi::Dimension;

use super::{equations, materials};
use crate::config::spelling::name_of;
use crate::config::volume_mesh::SolverDeck;
use crate::files::output::OutputPath;
use crate::{Error, Polycrystal, StagedFiles};

/// How far a box with walls is stretched: metals stay elastic.
const STRAIN: f64 = 0.001;

/// The mean stress in a periodic box, in MPa: about that of the same strain in copper.
const STRESS: f64 = 100.0;

/// Elastic constants of a crystal with axes 1, 2, 3, in MPa: C1111, C1122, C2222, C1133, C2233, C3333, C1212, C1313, C2323.
type Constants = [f64; 9];

/// Of a cubic crystal, copper: 168.4, 121.4 and 75.4 GPa. Simmons and Wang, "Single crystal elastic constants and calculated aggregate properties", 1971.
const COPPER: Constants =
    [168_400.0, 121_400.0, 168_400.0, 121_400.0, 121_400.0, 168_400.0, 75_400.0, 75_400.0, 75_400.0];

/// Of a hexagonal crystal, titanium: C11 162.4, C12 92.0, C13 69.0, C33 180.7, C44 46.7 GPa, C66 their half difference. The same source.
const TITANIUM: Constants =
    [162_400.0, 92_000.0, 162_400.0, 69_000.0, 69_000.0, 180_700.0, 35_200.0, 46_700.0, 46_700.0];

/// Where a job goes, found writable, and the file of elements that it includes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DeckOutput {
    output: OutputPath<()>,
    included: String,
}

impl DeckOutput {
    /// Checks that a job can be written beside `elements`: of `grains.inp`, to `grains.tension-x.inp`.
    ///
    /// # Errors
    /// As of [`OutputPath::check_as`].
    pub fn check(elements: &Path, deck: SolverDeck) -> Result<Self, Error> {
        let output = OutputPath::check_as(elements.with_extension(format!("{}.inp", name_of(&deck))), ())?;
        let included = elements.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Self { output, included })
    }

    /// The file.
    pub fn output(&self) -> &OutputPath<()> {
        &self.output
    }
}

impl Polycrystal {
    /// Completes a job: the box is pulled along x, its other sides are free.
    ///
    /// # Errors
    /// [`Error::NoSides`] where nothing is left of the box's sides to pull at; [`Error::WriteOutput`]; [`Error::OutputTwice`].
    pub fn stage_solver_deck(&self, deck: &DeckOutput, files: &mut StagedFiles) -> Result<(), Error> {
        let domain = self.network.domain();
        let axis_count = usize::from(self.dimension().axes());
        let is_on_side = |upper: bool, axis: usize| {
            let side = if upper { domain.upper() } else { domain.lower() };
            self.points.iter().any(|point| point[axis] == side[axis])
        };
        let has_sides =
            domain.is_box() && (0..axis_count).all(|axis| is_on_side(false, axis) && is_on_side(true, axis));
        if !domain.is_periodic() && !has_sides {
            return Err(Error::NoSides { path: deck.output.path().to_owned() });
        }
        deck.output.stage(files, |out| write(self, &deck.included, out))
    }
}

fn write(polycrystal: &Polycrystal, included: &str, out: &mut dyn Write) -> io::Result<()> {
    let domain = polycrystal.network.domain();
    writeln!(out, "** The box is pulled along x; its other sides are free.")?;
    writeln!(out, "*INCLUDE, INPUT={included}")?;
    writeln!(out, "** Put the constants of your crystals, in the axes of each: C1111, C1122, C2222, C1133,")?;
    writeln!(out, "** C2233, C3333, C1212, C1313, C2323. Stresses have their unit, here MPa.")?;
    for (name, symmetry) in materials(polycrystal.grains()) {
        let (of, constants) = match symmetry {
            CrystalSymmetry::Hexagonal | CrystalSymmetry::HexagonalLow => ("titanium", TITANIUM),
            _ => ("copper", COPPER),
        };
        let [first @ .., last] = constants.map(|constant| format!("{constant:?}"));
        writeln!(out, "** Those of {of} are an example.\n*MATERIAL, NAME={name}\n*ELASTIC, TYPE=ORTHO")?;
        writeln!(out, "{}\n{last}", first.join(", "))?;
    }
    let DVec3 { x, y, z } = domain.size();
    let is_plane = polycrystal.dimension() == Dimension::Two;
    // Elements in the plane are 1 thick.
    let z = if is_plane { 1.0 } else { z };
    if equations::are_asked(polycrystal) {
        // One node is fixed, and the three rotations, by half of the mean shear. CalculiX tells no reactions of nodes in equations: a force it is.
        let force = STRESS * y * z;
        let held =
            if is_plane { "HELD, 1, 2\nPERIOD_X, 2" } else { "HELD, 1, 3\nPERIOD_X, 2, 3\nPERIOD_Y, 3" };
        writeln!(out, "*BOUNDARY\n{held}\n*STEP\n*STATIC")?;
        writeln!(out, "** A mean stress of {STRESS:?} MPa along x, times the area of the box across it.")?;
        writeln!(out, "*CLOAD\nPERIOD_X, 1, {force:?}\n*NODE FILE\nU\n*EL FILE\nS, E")?;
        writeln!(out, "** Divided by the length of the box, which is {x:?}, it is the mean strain.")?;
        writeln!(out, "*NODE PRINT, NSET=PERIOD_X\nU\n*END STEP")
    } else {
        let held = if is_plane { "X0Y0, 2" } else { "X0Y0Z0, 2, 3\nX0Y1Z0, 3" };
        writeln!(out, "*BOUNDARY\nX0, 1\n{held}\n*STEP\n*STATIC")?;
        writeln!(out, "** A mean strain of {STRAIN:?} along x.")?;
        writeln!(out, "*BOUNDARY\nX1, 1, 1, {:?}\n*NODE FILE\nU\n*EL FILE\nS, E", STRAIN * x)?;
        writeln!(
            out,
            "** Divided by the area of the side, which is {:?}, the force is the mean stress.",
            y * z
        )?;
        writeln!(out, "*NODE PRINT, NSET=X1, TOTALS=YES\nRF\n*END STEP")
    }
}
