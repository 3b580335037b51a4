//! What `grainsmooth check` says about a network from a file.

mod agreement;
mod sizes;
mod statistics;

use std::fmt;
use std::path::Path;

use polycrystal::{Certificate, Elements, Fault, Side, certify};
use serde::Serialize;
use voronoi::Dimension;

use crate::figures::spread::Spread;
use crate::{LabelledFile, MapProblem, MeasuredMap, TriangleAngles};
use statistics::statistics;

pub use agreement::{GrainAgreement, MapAgreement};
pub use sizes::SizesFound;
pub use statistics::{Expectation, Statistic};

/// Faults of one kind that the text names; JSON has all.
const NAMED: usize = 5;

/// The certificate of one file. Its text is for people; serialized it is for programs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CheckReport {
    /// The file as it was named.
    pub file: String,
    /// Whether nothing is wrong.
    pub good: bool,
    /// The cell array that the sides were read from.
    pub labels: &'static str,
    /// Number of grains.
    pub grains: usize,
    /// Number of pairs of sides.
    pub boundaries: usize,
    /// Number of points.
    pub points: usize,
    /// Number of triangles; in the plane, of segments.
    pub elements: usize,
    /// What the elements are.
    pub element: &'static str,
    /// Volume of all grains together (in the plane: area), in the file's unit of length.
    pub volume: f64,
    /// Difference to the volume of the box that the file names, as a share of it, if it names one.
    pub volume_error: Option<f64>,
    /// Angles between boundaries at triple lines inside, in degrees.
    pub dihedral: Option<Spread>,
    /// The smallest angles of triangles, in degrees.
    pub triangle_angles: Option<TriangleAngles>,
    /// What a good network is like, beside exact values where it consists of Poisson-Voronoi cells.
    pub statistics: Vec<Statistic>,
    /// How near the grains are to the sizes that the file's settings ask for.
    pub sizes: Option<SizesFound>,
    /// How the network agrees with a map, where it is compared with one.
    pub map: Option<MapAgreement>,
    /// All that is wrong.
    pub faults: Vec<ReportedFault>,
}

/// A fault with its place.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReportedFault {
    /// Kind in a word or two.
    pub kind: &'static str,
    /// What is wrong, in words.
    pub message: String,
    /// Points named, from 0.
    pub points: Vec<u32>,
    /// Triangles (in the plane: segments) named, from 0.
    pub elements: Vec<u32>,
    /// Grains named.
    pub grains: Vec<u32>,
    /// Coordinates, if it is somewhere.
    pub position: Option<[f64; 3]>,
}

impl CheckReport {
    /// Examines a network.
    pub fn new(path: &Path, file: &LabelledFile) -> Self {
        Self::of_certificate(path, file, &certify(&file.surface(), &file.expected()))
    }

    /// Examines a network, and compares it with the map that it should show.
    ///
    /// # Errors
    /// As of [`MapAgreement::new`].
    pub fn beside_map(path: &Path, file: &LabelledFile, map: &MeasuredMap) -> Result<Self, MapProblem> {
        let certificate = certify(&file.surface(), &file.expected());
        let report = Self::of_certificate(path, file, &certificate);
        let agreement = MapAgreement::new(&report.file, file, &certificate.grain_volumes, map)?;
        Ok(Self { map: Some(agreement), ..report })
    }

    fn of_certificate(path: &Path, file: &LabelledFile, certificate: &Certificate) -> Self {
        let surface = file.surface();
        let expected = file.expected();
        let report = |fault: &Fault| ReportedFault {
            kind: fault.kind(),
            message: in_words(fault),
            points: fault.ids().0,
            elements: fault.ids().1,
            grains: fault.grains().iter().map(|grain| grain.0).collect(),
            position: fault.position(&surface).map(|place| place.to_array()),
        };
        let (element, dimension) = match surface.elements {
            Elements::Triangles(_) | Elements::Refined(_) => ("triangles", Dimension::Three),
            Elements::Segments(_) => ("segments", Dimension::Two),
        };
        let volumes: Vec<f64> = certificate.grain_volumes.iter().map(|(_, volume)| *volume).collect();
        let mut pairs: Vec<[Side; 2]> = surface.sides.to_vec();
        pairs.iter_mut().for_each(|sides| sides.sort_unstable());
        pairs.sort_unstable();
        pairs.dedup();
        Self {
            file: path.display().to_string(),
            good: certificate.is_good(),
            labels: file.label_array,
            grains: surface.grains().len(),
            boundaries: pairs.len(),
            points: surface.points.len(),
            elements: surface.elements.len(),
            element,
            volume: volumes.iter().sum(),
            volume_error: expected.domain_volume.map(|_| certificate.total_volume_error),
            dihedral: certificate.angles.map(Spread::from),
            triangle_angles: certificate.triangles.map(TriangleAngles::from),
            statistics: statistics(file, &surface, certificate),
            sizes: file.settings.as_ref().and_then(|settings| sizes::sizes(settings, &volumes, dimension)),
            map: None,
            faults: certificate.faults.0.iter().map(report).collect(),
        }
    }
}

/// The fault, and how large a grain of another volume should be.
fn in_words(fault: &Fault) -> String {
    match fault {
        Fault::WrongVolume { diameter, .. } => {
            format!("{fault}; its equivalent diameter should be {diameter:.3e}")
        }
        _ => fault.to_string(),
    }
}

impl fmt::Display for CheckReport {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write_verdict(&self.file, &self.faults, out)?;
        writeln!(
            out,
            "  network     {} grains, {} boundaries by {}",
            self.grains, self.boundaries, self.labels
        )?;
        write!(out, "  mesh        {} points, {} {}", self.points, self.elements, self.element)?;
        let volume = if self.element == "segments" { "area" } else { "volume" };
        write!(out, "\n  {volume:12}{}", self.volume)?;
        if let Some(error) = self.volume_error {
            write!(out, ", off the box's by {error:.1e} of it")?;
        }
        if let Some(angles) = self.dihedral {
            write!(out, "\n  angles      {:.2} +- {:.2} degrees", angles.mean, angles.standard_deviation)?;
        }
        if let Some(angles) = self.triangle_angles {
            write!(out, "\n  triangles   {angles}")?;
        }
        if let Some(sizes) = &self.sizes {
            write!(out, "\n  sizes       {sizes}")?;
        }
        for Statistic { name, value, poisson_voronoi } in &self.statistics {
            write!(out, "\n  statistics  {name} {value:.4}")?;
            if let Some(Expectation { exact, standard_error }) = poisson_voronoi {
                write!(out, "; so many Poisson-Voronoi cells have {exact} +- {standard_error:.4}")?;
            }
        }
        if let Some(map) = &self.map {
            write!(out, "\n{map}")?;
        }
        write_faults(&self.faults, out)
    }
}

/// Writes a line for each fault, of each kind the first ones.
pub(super) fn write_faults(faults: &[ReportedFault], out: &mut fmt::Formatter<'_>) -> fmt::Result {
    for faults in faults.chunk_by(|a, b| a.kind == b.kind) {
        for fault in faults.iter().take(NAMED) {
            write!(out, "\n  {:18}{}", fault.kind, fault.message)?;
            if let Some([x, y, z]) = fault.position {
                write!(out, ", at ({x}, {y}, {z})")?;
            }
        }
        if faults.len() > NAMED {
            write!(out, "\n  {:18}and {} more", faults[0].kind, faults.len() - NAMED)?;
        }
    }
    Ok(())
}

/// The first words of a report: the file, and whether something is wrong.
pub(super) fn write_verdict(
    file: &str,
    faults: &[ReportedFault],
    out: &mut fmt::Formatter<'_>,
) -> fmt::Result {
    match faults.len() {
        0 => writeln!(out, "{file}: good"),
        1 => writeln!(out, "{file}: 1 fault"),
        count => writeln!(out, "{file}: {count} faults"),
    }
}
