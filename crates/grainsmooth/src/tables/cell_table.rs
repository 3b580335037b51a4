//! A table of the cells: one row for each grain.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::path::Path;

use glam::DVec3;
use serde::Serialize;
use voronoi::{CellId, CellMeasure, Dimension, Side};

use super::table::{Table, Value};
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
    cells: Table,
}

impl CellTable {
    /// Measures all cells. Walls among the `neighbors` are -1 (x0), -2 (x1), -3, -4 (y) and -5, -6 (z), those of a
    /// polyhedron -1 - number.
    pub fn new(config: &Config, cells: &Tessellated) -> Self {
        let tessellation = &cells.tessellation;
        let rows =
            (0u32..).zip(tessellation.cell_measures()).map(|(id, measure)| row(cells, CellId(id), &measure));
        Self { settings: config.settings().into_iter().collect(), cells: Table::of_records(rows) }
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
            TableFormat::Csv => self.cells.write_csv(out),
        })
    }
}

fn row(cells: &Tessellated, cell: CellId, measure: &CellMeasure) -> Vec<(&'static str, Value)> {
    let (tessellation, index) = (&cells.tessellation, cell.index());
    let dimension = tessellation.domain().dimension();
    let count = |number: usize| Value::Integer(i64::try_from(number).unwrap_or(i64::MAX));
    let point = |point: DVec3| Value::Point(point.to_array()[..usize::from(dimension.axes())].to_vec());
    // Of the ball with the cell's volume; in the plane, of the circle with its area.
    let equivalent_diameter = dimension.ball_diameter(measure.volume);
    let mut row = vec![
        ("id", Value::Integer(cell.0.into())),
        ("seed", point(tessellation.seeds()[index])),
        ("weight", Value::Number(cells.weights[index])),
    ];
    let [faces, edges, vertices] = [measure.face_count, measure.edge_count, measure.vertex_count].map(count);
    match dimension {
        Dimension::Three => row.extend([
            ("volume", Value::Number(measure.volume)),
            ("centroid", point(measure.centroid)),
            ("area", Value::Number(measure.area)),
            ("nfaces", faces),
            ("nverts", vertices),
            ("nedges", edges),
            ("equivalent_diameter", Value::Number(equivalent_diameter)),
            ("sphericity", Value::Number(PI * equivalent_diameter.powi(2) / measure.area)),
        ]),
        Dimension::Two => row.extend([
            ("area", Value::Number(measure.volume)),
            ("centroid", point(measure.centroid)),
            ("perimeter", Value::Number(measure.area)),
            ("nedges", edges),
            ("nverts", vertices),
            ("equivalent_diameter", Value::Number(equivalent_diameter)),
            ("circularity", Value::Number(PI * equivalent_diameter / measure.area)),
        ]),
    }
    let number = |side: Side| match side {
        Side::Cell(cell) | Side::Image(cell, _) => i64::from(cell.0),
        Side::Wall(wall) => -1 - i64::from(wall.number()),
    };
    let mut neighbors: Vec<i64> = tessellation.neighbors(cell).into_iter().map(number).collect();
    neighbors.sort_unstable();
    let grains = &cells.grains;
    row.extend([
        ("neighbors", Value::Integers(neighbors)),
        ("SeedId", Value::Integer(grains.ids[index].into())),
    ]);
    row.extend(
        grains.parents.as_ref().map(|parents| ("Parent", Value::Integer(parents.number(index).into()))),
    );
    row.extend(grains.phases.as_ref().map(|phases| ("Phase", Value::Integer(phases.number(index).into()))));
    if let Some(orientation) = grains.texture.as_ref().map(|texture| texture.orientations()[index]) {
        row.extend([
            ("EulerAngles", Value::Numbers(orientation.euler_degrees().to_vec())),
            ("Quaternion", Value::Numbers(orientation.quaternion().to_vec())),
        ]);
    }
    row
}
