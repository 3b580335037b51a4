//! What `grainsmooth check` says about elements from a file: tetrahedra, or triangles in a plane.

mod conforming;
mod elements;
mod sets;
mod ties;

use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

use glam::DVec3;
use polycrystal::{GrainId, PlaneMesh};
use serde::Serialize;
use toml::Table;

use super::report::{ReportedFault, write_faults, write_verdict};
use crate::volume_mesh::VolumeMesh;
use crate::volume_mesh::element_shape::ElementShape;
use crate::{FilledPlane, PlaneQuality, TetrahedronQuality, VolumeFile, embedded_config};
use conforming::Faces;

/// Largest difference of a volume from what it should be, as a share of that. Files for Nastran have thirteen digits.
const VOLUME_TOLERANCE: f64 = 1e-9;

/// What was found about the elements of a file, tetrahedra or triangles in a plane. Its text is for people; serialized it is for programs. Nodes and elements have the numbers that the file gives them.
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
    /// Number of axes of the space that they fill: 3, or 2 for triangles.
    pub dimension: usize,
    /// Number of tetrahedra, in the plane of triangles.
    pub elements: usize,
    /// Their order: 1, or 2 where edges have nodes in their middle.
    pub order: u8,
    /// Number of cohesive elements.
    pub cohesive_elements: usize,
    /// Names of the sets of nodes, as .inp has them.
    pub node_sets: Vec<String>,
    /// Names of the sets of faces, in the plane of edges.
    pub surfaces: Vec<String>,
    /// Number of nodes that are tied to others, whole periods away.
    pub tied_nodes: usize,
    /// Volume of each grain, in the plane its area, by its number.
    pub volumes: Vec<(u32, f64)>,
    /// Difference of all volumes together to that of the box that the file names, as a share of it, if it names one.
    pub volume_error: Option<f64>,
    /// How good the elements are.
    pub quality: Option<ElementQuality>,
    /// All that is wrong.
    pub faults: Vec<ReportedFault>,
}

/// How good the elements of a file are.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum ElementQuality {
    /// Tetrahedra.
    Tetrahedra(Box<TetrahedronQuality>),
    /// Triangles in a plane.
    Triangles(PlaneQuality),
}

impl fmt::Display for ElementQuality {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Tetrahedra(quality) => quality.fmt(out),
            Self::Triangles(quality) => quality.fmt(out),
        }
    }
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

    /// The corners of the box around all elements: without the nodes that only control others.
    fn bounds(&self) -> [DVec3; 2] {
        let points = || self.elements().flatten().map(|corner| self.place(*corner));
        [points().fold(DVec3::INFINITY, DVec3::min), points().fold(DVec3::NEG_INFINITY, DVec3::max)]
    }

    fn places(&self, nodes: &[u32]) -> Vec<DVec3> {
        nodes.iter().map(|node| self.place(*node)).collect()
    }

    /// The corners of elements with their first grain; those of none are left out.
    fn in_grains<const CORNERS: usize>(&self) -> (Vec<[u32; CORNERS]>, Vec<GrainId>) {
        let with_grain = |(corners, grains): (&[u32], &Vec<GrainId>)| {
            Some((<[u32; CORNERS]>::try_from(corners).ok()?, *grains.first()?))
        };
        self.elements().zip(&self.grains).filter_map(with_grain).unzip()
    }

    /// How good the elements are.
    fn quality(&self) -> Option<ElementQuality> {
        let points = self.points.clone();
        match self.shape {
            ElementShape::Tetrahedron => {
                let (tetrahedra, grains) = self.in_grains::<4>();
                let surface_points = points.len();
                let mesh = VolumeMesh { points, surface_points, tetrahedra, grains, ..VolumeMesh::default() };
                mesh.quality().map(|quality| ElementQuality::Tetrahedra(Box::new(quality)))
            }
            ElementShape::Triangle => {
                let (triangles, grains) = self.in_grains::<3>();
                let (line_points, middles) = (points.len(), BTreeMap::new());
                let mesh = PlaneMesh { points, line_points, triangles, grains, middles };
                FilledPlane { mesh, curved: None }.quality().map(ElementQuality::Triangles)
            }
        }
    }
}

impl VolumeReport {
    /// Examines the elements of a file.
    pub fn new(path: &Path, file: &VolumeFile) -> Self {
        let settings: Option<Table> = embedded_config(path).ok().flatten().and_then(|text| text.parse().ok());
        let mut found = Found::default();
        let volumes = elements::check(file, &mut found);
        let faces = Faces::new(file);
        conforming::check(file, &faces, &mut found);
        sets::check(file, &faces, settings.as_ref(), &mut found);
        ties::check(file, &faces, &mut found);
        elements::check_volumes(file, &volumes, &mut found);
        let volume: f64 = volumes.values().sum();
        let of_box = settings.as_ref().and_then(box_volume);
        if let Some(of_box) = of_box.filter(|of_box| (volume / of_box - 1.0).abs() > VOLUME_TOLERANCE) {
            let what = if file.shape == ElementShape::Triangle { "area" } else { "volume" };
            let message = format!("all grains have the {what} {volume}, the box {of_box}");
            found.push("wrong volume", message, None);
        }
        Self {
            file: path.display().to_string(),
            good: found.faults.is_empty(),
            grains: volumes.len(),
            nodes: file.points.len(),
            dimension: file.shape.axes(),
            elements: file.element_numbers.len(),
            order: if file.is_quadratic() { 2 } else { 1 },
            cohesive_elements: file.joints.len(),
            node_sets: file.node_sets.keys().cloned().collect(),
            surfaces: file.surfaces.keys().cloned().collect(),
            tied_nodes: file.ties.len(),
            volumes: volumes.into_iter().collect(),
            volume_error: of_box.map(|of_box| volume / of_box - 1.0),
            quality: file.quality(),
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
        let [kind, faces, volume] = match self.dimension {
            2 => ["triangles", "edges", "area  "],
            _ => ["tetrahedra", "faces", "volume"],
        };
        write_verdict(file, &self.faults, out)?;
        write!(out, "  mesh        {grains} grains, {nodes} nodes, {elements} {kind} of order {order}")?;
        if *cohesive_elements > 0 {
            write!(out, ", {cohesive_elements} cohesive elements")?;
        }
        if !self.node_sets.is_empty() || !self.surfaces.is_empty() {
            let (sets, surfaces) = (self.node_sets.len(), self.surfaces.len());
            write!(out, "\n  sets        {sets} of nodes, {surfaces} of {faces}")?;
        }
        if *tied_nodes > 0 {
            write!(out, "\n  periods     {tied_nodes} nodes tied to others, whole periods away")?;
        }
        let sum: f64 = self.volumes.iter().map(|(_, volume)| volume).sum();
        write!(out, "\n  {volume}      {sum}")?;
        if let Some(error) = self.volume_error {
            write!(out, ", off the box's by {error:.1e} of it")?;
        }
        if let Some(quality) = &self.quality {
            write!(out, "\n  quality     {quality}")?;
        }
        write_faults(&self.faults, out)
    }
}
