//! What `grainsmooth check` says about tetrahedra from a file.

mod conforming;
mod elements;
mod sets;
mod ties;

use std::fmt;
use std::path::Path;

use glam::DVec3;
use serde::Serialize;
use toml::Table;

use super::report::{ReportedFault, write_faults, write_verdict};
use crate::volume_mesh::VolumeMesh;
use crate::{TetrahedronQuality, VolumeFile, embedded_config};
use conforming::Faces;

/// Largest difference of a volume from what it should be, as a share of that. Files for Nastran have thirteen digits.
const VOLUME_TOLERANCE: f64 = 1e-9;

/// What was found about the tetrahedra of a file. Its text is for people; serialized it is for programs. Nodes and elements have the numbers that the file gives them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct VolumeReport {
    /// The file as it was named.
    pub file: String,
    /// Whether nothing is wrong.
    pub good: bool,
    /// Number of grains.
    pub grains: usize,
    /// Number of nodes.
    pub nodes: usize,
    /// Number of tetrahedra.
    pub elements: usize,
    /// Their order: 1, or 2 where edges have nodes in their middle.
    pub order: u8,
    /// Number of cohesive elements.
    pub cohesive_elements: usize,
    /// Names of the sets of nodes, as .inp has them.
    pub node_sets: Vec<String>,
    /// Names of the sets of faces.
    pub surfaces: Vec<String>,
    /// Number of nodes that are tied to others, whole periods away.
    pub tied_nodes: usize,
    /// Volume of each grain, by its number.
    pub volumes: Vec<(u32, f64)>,
    /// Difference of all volumes together to that of the box that the file names, as a share of it, if it names one.
    pub volume_error: Option<f64>,
    /// How good the tetrahedra are.
    pub quality: Option<TetrahedronQuality>,
    /// All that is wrong.
    pub faults: Vec<ReportedFault>,
}

/// All that is wrong, as it is found.
#[derive(Default)]
struct Found {
    faults: Vec<ReportedFault>,
}

impl Found {
    fn push(&mut self, kind: &'static str, message: String, place: Option<DVec3>) -> &mut ReportedFault {
        let position = place.map(|place| place.to_array());
        let (points, elements, grains) = (Vec::new(), Vec::new(), Vec::new());
        self.faults.push(ReportedFault { kind, message, points, elements, grains, position });
        self.faults.last_mut().expect("one was added")
    }
}

impl VolumeFile {
    /// What the file calls a node.
    fn node(&self, node: u32) -> u64 {
        self.node_numbers[node as usize]
    }

    fn place(&self, node: u32) -> DVec3 {
        self.points[node as usize]
    }

    /// The corners of the box around all tetrahedra: without the nodes that only control others.
    fn bounds(&self) -> [DVec3; 2] {
        let points = || self.tetrahedra.iter().flatten().map(|corner| self.place(*corner));
        [points().fold(DVec3::INFINITY, DVec3::min), points().fold(DVec3::NEG_INFINITY, DVec3::max)]
    }

    fn corners(&self, element: usize) -> [DVec3; 4] {
        self.tetrahedra[element].map(|corner| self.place(corner))
    }

    /// The tetrahedra with the first grain of each; elements of none are left out.
    fn mesh(&self) -> VolumeMesh {
        let known = self.tetrahedra.iter().zip(&self.grains);
        let (tetrahedra, grains) = known.filter_map(|(corners, of)| Some((*corners, *of.first()?))).unzip();
        let points = self.points.clone();
        VolumeMesh { surface_points: points.len(), points, tetrahedra, grains, ..VolumeMesh::default() }
    }
}

impl VolumeReport {
    /// Examines the tetrahedra of a file.
    pub fn new(path: &Path, file: &VolumeFile) -> Self {
        let settings: Option<Table> = embedded_config(path).ok().flatten().and_then(|text| text.parse().ok());
        let mut found = Found::default();
        elements::check(file, &mut found);
        let faces = Faces::new(file);
        conforming::check(file, &faces, &mut found);
        sets::check(file, &faces, settings.as_ref(), &mut found);
        ties::check(file, &faces, &mut found);
        let mesh = file.mesh();
        let volumes = elements::check_volumes(file, &mesh, &mut found);
        let volume: f64 = volumes.iter().map(|(_, volume)| volume).sum();
        let of_box = settings.as_ref().and_then(box_volume);
        if let Some(of_box) = of_box.filter(|of_box| (volume / of_box - 1.0).abs() > VOLUME_TOLERANCE) {
            let message = format!("all grains have the volume {volume}, the box {of_box}");
            found.push("wrong volume", message, None);
        }
        Self {
            file: path.display().to_string(),
            good: found.faults.is_empty(),
            grains: volumes.len(),
            nodes: file.points.len(),
            elements: file.tetrahedra.len(),
            order: if file.middles.is_empty() { 1 } else { 2 },
            cohesive_elements: file.prisms.len(),
            node_sets: file.node_sets.keys().cloned().collect(),
            surfaces: file.surfaces.keys().cloned().collect(),
            tied_nodes: file.ties.len(),
            volumes,
            volume_error: of_box.map(|of_box| volume / of_box - 1.0),
            quality: mesh.quality(),
            faults: found.faults,
        }
    }
}

/// The volume of the box of some settings, where grains fill that.
fn box_volume(settings: &Table) -> Option<f64> {
    if settings.contains_key("domain") || settings.contains_key("half-spaces") {
        return None;
    }
    settings.get("box")?.as_array()?.iter().map(toml::Value::as_float).product()
}

impl fmt::Display for VolumeReport {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { file, grains, nodes, elements, order, cohesive_elements, tied_nodes, .. } = self;
        write_verdict(file, &self.faults, out)?;
        write!(out, "  mesh        {grains} grains, {nodes} nodes, {elements} tetrahedra of order {order}")?;
        if *cohesive_elements > 0 {
            write!(out, ", {cohesive_elements} cohesive elements")?;
        }
        if !self.node_sets.is_empty() || !self.surfaces.is_empty() {
            let (sets, surfaces) = (self.node_sets.len(), self.surfaces.len());
            write!(out, "\n  sets        {sets} of nodes, {surfaces} of faces")?;
        }
        if *tied_nodes > 0 {
            write!(out, "\n  periods     {tied_nodes} nodes tied to others, whole periods away")?;
        }
        let volume: f64 = self.volumes.iter().map(|(_, volume)| volume).sum();
        write!(out, "\n  volume      {volume}")?;
        if let Some(error) = self.volume_error {
            write!(out, ", off the box's by {error:.1e} of it")?;
        }
        if let Some(quality) = &self.quality {
            write!(out, "\n  quality     {quality}")?;
        }
        write_faults(&self.faults, out)
    }
}
