//! A table of the cells: one row for each grain.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::path::Path;

use glam::DVec3;
use serde::ser::{Serialize, SerializeStruct, Serializer};
use voronoi::{CellId, Dimension, Side, SingleCell};

use super::table::{Row, Value, push_csv_line, write_csv};
use crate::{Config, Error, GrainAttributes, ListedCells, Output, StagedFiles, Tessellated};

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

/// One row for each cell of some seeds: the flat cells, before any relaxation.
pub struct CellTable<'a> {
    settings: BTreeMap<String, toml::Value>,
    dimension: Dimension,
    count: u32,
    weights: Option<&'a [f64]>,
    grains: &'a GrainAttributes,
    cell: Box<dyn Fn(CellId) -> SingleCell + Sync + 'a>,
}

impl<'a> CellTable<'a> {
    /// Measures all cells. Walls among the `neighbors` are -1 (x0), -2 (x1), -3, -4 (y) and -5, -6 (z), those of a
    /// polyhedron -1 - number.
    pub fn new(config: &Config, cells: &'a Tessellated) -> Self {
        let tessellation = &cells.tessellation;
        let measures = tessellation.cell_measures();
        let cell = move |cell: CellId| SingleCell::of(tessellation, cell, measures[cell.index()]);
        Self::of(config, tessellation.cell_count(), Some(&cells.weights), &cells.grains, Box::new(cell))
    }

    /// The same of cells without their complex.
    pub fn of_list(config: &Config, cells: &'a ListedCells) -> Self {
        let cell = |cell: CellId| cells.cells.cell(cell);
        Self::of(config, cells.cells.len(), cells.weights.as_deref(), &cells.grains, Box::new(cell))
    }

    fn of(
        config: &Config,
        count: usize,
        weights: Option<&'a [f64]>,
        grains: &'a GrainAttributes,
        cell: Box<dyn Fn(CellId) -> SingleCell + Sync + 'a>,
    ) -> Self {
        let settings = config.settings().into_iter().collect();
        let count = u32::try_from(count).expect("cell ids fit 32 bits");
        Self { settings, dimension: config.dimension, count, weights, grains, cell }
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
            TableFormat::Csv => {
                let names = |(name, value): &(&str, Value)| value.names_in_csv(name);
                let header: Vec<String> = self.record(0).iter().flat_map(names).collect();
                let push_line = |index: usize, text: &mut String| {
                    push_csv_line(self.record(index).iter().map(|(_, value)| value), text);
                };
                write_csv(&header, self.count as usize, push_line, out)
            }
        })
    }

    fn record(&self, index: usize) -> Vec<(&'static str, Value)> {
        let cell = CellId(u32::try_from(index).expect("cell ids fit 32 bits"));
        record(
            self.dimension,
            (self.cell)(cell),
            self.weights.map_or(0.0, |weights| weights[index]),
            self.grains,
        )
    }
}

impl Serialize for CellTable<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        struct Rows<'a>(&'a CellTable<'a>);
        impl Serialize for Rows<'_> {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.collect_seq((0..self.0.count as usize).map(|index| Row(self.0.record(index))))
            }
        }
        let mut table = serializer.serialize_struct("CellTable", 2)?;
        table.serialize_field("settings", &self.settings)?;
        table.serialize_field("cells", &Rows(self))?;
        table.end()
    }
}

fn record(
    dimension: Dimension,
    cell: SingleCell,
    weight: f64,
    grains: &GrainAttributes,
) -> Vec<(&'static str, Value)> {
    let SingleCell { cell, seed, measure, neighbors } = cell;
    let index = cell.index();
    let count = |number: usize| Value::Integer(i64::try_from(number).unwrap_or(i64::MAX));
    let point = |point: DVec3| Value::Point(point.to_array()[..usize::from(dimension.axes())].to_vec());
    // Of the ball with the cell's volume; in the plane, of the circle with its area.
    let equivalent_diameter = dimension.ball_diameter(measure.volume);
    let mut record =
        vec![("id", Value::Integer(cell.0.into())), ("seed", point(seed)), ("weight", Value::Number(weight))];
    let [faces, edges, vertices] = [measure.face_count, measure.edge_count, measure.vertex_count].map(count);
    match dimension {
        Dimension::Three => record.extend([
            ("volume", Value::Number(measure.volume)),
            ("centroid", point(measure.centroid)),
            ("area", Value::Number(measure.area)),
            ("nfaces", faces),
            ("nverts", vertices),
            ("nedges", edges),
            ("equivalent_diameter", Value::Number(equivalent_diameter)),
            ("sphericity", Value::Number(PI * equivalent_diameter.powi(2) / measure.area)),
        ]),
        Dimension::Two => record.extend([
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
    let mut neighbors: Vec<i64> = neighbors.into_iter().map(number).collect();
    neighbors.sort_unstable();
    record.extend([
        ("neighbors", Value::Integers(neighbors)),
        ("SeedId", Value::Integer(grains.ids[index].into())),
    ]);
    record.extend(
        grains.parents.as_ref().map(|parents| ("Parent", Value::Integer(parents.number(index).into()))),
    );
    record
        .extend(grains.phases.as_ref().map(|phases| ("Phase", Value::Integer(phases.number(index).into()))));
    if let Some(orientation) = grains.texture.as_ref().map(|texture| texture.orientations()[index]) {
        record.extend([
            ("EulerAngles", Value::Numbers(orientation.euler_degrees().to_vec())),
            ("Quaternion", Value::Numbers(orientation.quaternion().to_vec())),
        ]);
    }
    record
}
