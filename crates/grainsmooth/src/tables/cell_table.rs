//! A table of the cells: one row for each grain.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::io::{self, Write};
use std::path::Path;

use glam::DVec3;
use serde::Serialize;
use texture::Orientation;
use voronoi::{CellId, CellMeasure, Dimension, Side};

use crate::{Config, Error, Output, StagedFiles, Tessellated};

/// A format of tables.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TableFormat {
    /// An object with the `settings` of the run and the list `cells`.
    Json,
    /// A header line, then one line a cell; lists have blanks between their numbers.
    Csv,
}

impl TableFormat {
    /// The format that the path's extension names, in upper or lower case.
    pub fn of_path(path: &Path) -> Option<Self> {
        let extension = path.extension()?;
        let formats = [("json", Self::Json), ("csv", Self::Csv)];
        let named = formats.into_iter().find(|(name, _)| extension.eq_ignore_ascii_case(name));
        named.map(|(_, format)| format)
    }
}

/// One row for each cell of a tessellation: the flat cells, before any relaxation.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CellTable {
    settings: BTreeMap<String, toml::Value>,
    cells: Vec<Cell>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct Cell {
    #[serde(flatten)]
    row: Row,
    /// The number of the seed of the grain that it is a part of, where grains are divided.
    #[serde(rename = "Parent", skip_serializing_if = "Option::is_none")]
    parent: Option<u32>,
    /// The number of its phase, where there are phases.
    #[serde(rename = "Phase", skip_serializing_if = "Option::is_none")]
    phase: Option<i32>,
    #[serde(flatten)]
    orientation: Option<CellOrientation>,
}

/// The orientation of a cell, where it has one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "PascalCase")]
struct CellOrientation {
    /// Bunge's, in degrees.
    euler_angles: [f64; 3],
    /// Scalar first.
    quaternion: [f64; 4],
}

impl CellOrientation {
    fn new(orientation: Orientation) -> Self {
        Self { euler_angles: orientation.euler_degrees(), quaternion: orientation.quaternion() }
    }

    fn in_csv(&self) -> String {
        let [angles, quaternion] = [&self.euler_angles[..], &self.quaternion]
            .map(|numbers| numbers.iter().map(|number| format!("{number:?}")).collect::<Vec<_>>().join(" "));
        format!(",{angles},{quaternion}")
    }
}

/// A cell in space or in the plane, with the names that each has there.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
enum Row {
    Space {
        id: u32,
        seed: [f64; 3],
        weight: f64,
        volume: f64,
        centroid: [f64; 3],
        area: f64,
        nfaces: usize,
        nverts: usize,
        nedges: usize,
        neighbors: Vec<i64>,
        equivalent_diameter: f64,
        sphericity: f64,
        #[serde(rename = "SeedId")]
        seed_id: u32,
    },
    Plane {
        id: u32,
        seed: [f64; 2],
        weight: f64,
        area: f64,
        centroid: [f64; 2],
        perimeter: f64,
        nedges: usize,
        nverts: usize,
        neighbors: Vec<i64>,
        equivalent_diameter: f64,
        circularity: f64,
        #[serde(rename = "SeedId")]
        seed_id: u32,
    },
}

impl CellTable {
    /// Measures all cells. Walls among the `neighbors` are -1 (x0), -2 (x1), -3, -4 (y) and -5, -6 (z), those of a
    /// polyhedron -1 - number.
    pub fn new(config: &Config, cells: &Tessellated) -> Self {
        let tessellation = &cells.tessellation;
        let rows = (0u32..).zip(tessellation.cell_measures()).map(|(id, measure)| {
            let number = |side: Side| match side {
                Side::Cell(cell) | Side::Image(cell, _) => i64::from(cell.0),
                Side::Wall(wall) => -1 - i64::from(wall.number()),
            };
            let mut neighbors: Vec<i64> =
                tessellation.neighbors(CellId(id)).into_iter().map(number).collect();
            neighbors.sort_unstable();
            let seed = tessellation.seeds()[id as usize];
            let ids = [id, cells.grains.ids[id as usize]];
            let weight = cells.weights[id as usize];
            let row = match tessellation.domain().dimension() {
                Dimension::Three => row_in_space(ids, seed, weight, &measure, neighbors),
                Dimension::Two => row_in_plane(ids, seed, weight, &measure, neighbors),
            };
            let orientation =
                cells.grains.texture.as_ref().map(|texture| texture.orientations()[id as usize]);
            let phase = cells.grains.phases.as_ref().map(|phases| phases.number(id as usize));
            let parent = cells.grains.parents.as_ref().map(|parents| parents.number(id as usize));
            Cell { row, parent, phase, orientation: orientation.map(CellOrientation::new) }
        });
        Self { settings: config.settings().into_iter().collect(), cells: rows.collect() }
    }

    /// Completes the table.
    ///
    /// # Errors
    /// [`Error::WriteOutput`]; [`Error::OutputTwice`].
    pub fn stage(&self, output: &Output<TableFormat>, files: &mut StagedFiles) -> Result<(), Error> {
        output.stage(files, |out| match output.format() {
            TableFormat::Json => {
                serde_json::to_writer(&mut *out, self)?;
                writeln!(out)
            }
            TableFormat::Csv => self.write_csv(out),
        })
    }

    fn write_csv(&self, out: &mut dyn Write) -> io::Result<()> {
        let first = self.cells.first();
        match first.map(|cell| &cell.row) {
            Some(Row::Plane { .. }) => write!(
                out,
                "id,x,y,weight,area,centroid_x,centroid_y,perimeter,nedges,nverts,equivalent_diameter,circularity,neighbors,SeedId"
            )?,
            _ => write!(
                out,
                "id,x,y,z,weight,volume,centroid_x,centroid_y,centroid_z,area,nfaces,nverts,nedges,equivalent_diameter,sphericity,neighbors,SeedId"
            )?,
        }
        let has_orientations = first.is_some_and(|cell| cell.orientation.is_some());
        let has_phases = first.is_some_and(|cell| cell.phase.is_some());
        write!(out, "{}", if first.is_some_and(|cell| cell.parent.is_some()) { ",Parent" } else { "" })?;
        write!(out, "{}", if has_phases { ",Phase" } else { "" })?;
        writeln!(out, "{}", if has_orientations { ",EulerAngles,Quaternion" } else { "" })?;
        for Cell { row, parent, phase, orientation } in &self.cells {
            row.write_csv(out)?;
            write!(out, "{}", parent.map_or_else(String::new, |parent| format!(",{parent}")))?;
            write!(out, "{}", phase.map_or_else(String::new, |phase| format!(",{phase}")))?;
            writeln!(out, "{}", orientation.as_ref().map_or_else(String::new, CellOrientation::in_csv))?;
        }
        Ok(())
    }
}

impl Row {
    fn write_csv(&self, out: &mut dyn Write) -> io::Result<()> {
        let (neighbors, seed_id) = match self {
            Self::Space {
                id,
                seed_id,
                seed: [x, y, z],
                weight,
                volume,
                centroid: [cx, cy, cz],
                area,
                nfaces,
                nverts,
                nedges,
                neighbors,
                equivalent_diameter,
                sphericity,
            } => {
                write!(out, "{id},{x:?},{y:?},{z:?},{weight:?},{volume:?},{cx:?},{cy:?},{cz:?},{area:?},")?;
                write!(out, "{nfaces},{nverts},{nedges},{equivalent_diameter:?},{sphericity:?},")?;
                (neighbors, seed_id)
            }
            Self::Plane {
                id,
                seed_id,
                seed: [x, y],
                weight,
                area,
                centroid: [cx, cy],
                perimeter,
                nedges,
                nverts,
                neighbors,
                equivalent_diameter,
                circularity,
            } => {
                write!(out, "{id},{x:?},{y:?},{weight:?},{area:?},{cx:?},{cy:?},{perimeter:?},")?;
                write!(out, "{nedges},{nverts},{equivalent_diameter:?},{circularity:?},")?;
                (neighbors, seed_id)
            }
        };
        let neighbors: Vec<String> = neighbors.iter().map(i64::to_string).collect();
        write!(out, "{},{seed_id}", neighbors.join(" "))
    }
}

fn row_in_space(
    [id, seed_id]: [u32; 2],
    seed: DVec3,
    weight: f64,
    measure: &CellMeasure,
    neighbors: Vec<i64>,
) -> Row {
    let volume = measure.volume;
    // Diameter and surface of the ball with the cell's volume.
    let equivalent_diameter = Dimension::Three.ball_diameter(volume);
    Row::Space {
        id,
        seed_id,
        seed: seed.to_array(),
        weight,
        volume,
        centroid: measure.centroid.to_array(),
        area: measure.area,
        nfaces: measure.face_count,
        nverts: measure.vertex_count,
        nedges: measure.edge_count,
        neighbors,
        equivalent_diameter,
        sphericity: PI * equivalent_diameter.powi(2) / measure.area,
    }
}

fn row_in_plane(
    [id, seed_id]: [u32; 2],
    seed: DVec3,
    weight: f64,
    measure: &CellMeasure,
    neighbors: Vec<i64>,
) -> Row {
    let area = measure.volume;
    // Diameter and perimeter of the circle with the cell's area.
    let equivalent_diameter = Dimension::Two.ball_diameter(area);
    Row::Plane {
        id,
        seed_id,
        seed: seed.truncate().to_array(),
        weight,
        area,
        centroid: measure.centroid.truncate().to_array(),
        perimeter: measure.area,
        nedges: measure.edge_count,
        nverts: measure.vertex_count,
        neighbors,
        equivalent_diameter,
        circularity: PI * equivalent_diameter / measure.area,
    }
}
