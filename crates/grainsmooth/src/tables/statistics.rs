//! Measures of a finished polycrystal as files of numbers.

mod plane;
mod space;

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::Path;

use polycrystal::{GrainId, Measures, Side};
use serde::Serialize;
use voronoi::Dimension;

use crate::figures::spread::Spread;
use crate::formats::surface::label;
use crate::names::{MOBILITY, PARENT, PHASE, SPREAD, TENSION, VOXEL_COUNT};
use crate::tables::table::{Table, Value};
use crate::{Error, GrainTexture, Output, Polycrystal, StagedFiles, TableFormat, Topology};

/// The tables beside that of the grains, by dimension.
const OTHERS_IN_SPACE: [&str; 3] = ["boundaries", "triple_lines", "quadruple_points"];
const OTHERS_IN_PLANE: [&str; 2] = ["boundaries", "triple_points"];

/// Where statistics go, all files found writable: one of JSON, or a CSV file for each table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StatisticsOutput {
    /// The file as it was given; of CSV the table of the grains.
    main: Output<TableFormat>,
    /// The other tables of CSV.
    others: Vec<(&'static str, Output<TableFormat>)>,
}

impl StatisticsOutput {
    /// Checks that statistics can be written at `path`; next to `a.csv` stand `a.boundaries.csv` and so on.
    ///
    /// # Errors
    /// As of [`Output::check_as`].
    pub fn check(path: &Path, format: TableFormat, dimension: Dimension) -> Result<Self, Error> {
        let main = Output::check_as(path, format)?;
        let names: &[&str] = match (format, dimension) {
            (TableFormat::Json, _) => &[],
            (TableFormat::Csv, Dimension::Three) => &OTHERS_IN_SPACE,
            (TableFormat::Csv, Dimension::Two) => &OTHERS_IN_PLANE,
        };
        let beside = |name: &&'static str| {
            Ok((*name, Output::check_as(path.with_extension(format!("{name}.csv")), format)?))
        };
        Ok(Self { main, others: names.iter().map(beside).collect::<Result<_, Error>>()? })
    }

    /// All files.
    pub fn files(&self) -> impl Iterator<Item = &Output<TableFormat>> {
        std::iter::once(&self.main).chain(self.others.iter().map(|(_, output)| output))
    }
}

/// What a polycrystal is like: a table each of its grains, boundaries, and the places where these meet.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NetworkStatistics {
    version: &'static str,
    command_line: String,
    random_seed: Option<u64>,
    settings: BTreeMap<String, toml::Value>,
    /// Mean and spread of what the tables hold.
    distributions: BTreeMap<&'static str, Distribution>,
    topology: Topology,
    grains: Table,
    #[serde(flatten)]
    others: BTreeMap<&'static str, Table>,
}

/// How a quantity is distributed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
struct Distribution {
    count: usize,
    #[serde(flatten)]
    spread: Spread,
    minimum: f64,
    maximum: f64,
}

impl Polycrystal {
    /// Measures the smoothed network.
    pub fn statistics(&self) -> NetworkStatistics {
        let (mut grains, mut others, distributions) = match self.measures() {
            Measures::Space(measures) => {
                space::tables(&measures, &self.grains().ids, &self.network.finest_level().grain_counts)
            }
            Measures::Plane(measures) => plane::tables(&measures, &self.grains().ids),
        };
        if let Some(parents) = &self.grains().parents {
            let parent = |grain: GrainId| i64::from(parents.number(grain.index()));
            grains.add_column(PARENT, |row| Value::Integer(row[0].grain().map_or(-1, parent)));
        }
        if let Some(phases) = &self.grains().phases {
            let phase = |grain: GrainId| i64::from(phases.number(grain.index()));
            grains.add_column(PHASE, |row| Value::Integer(row[0].grain().map_or(0, phase)));
        }
        if let Some(measured) = &self.grains().measured {
            let count = |grain: GrainId| i64::try_from(measured.voxel_counts[grain.index()]).ok();
            let value = |row: &[Value]| row[0].grain().and_then(count).unwrap_or(0);
            grains.add_column(VOXEL_COUNT, |row| Value::Integer(value(row)));
            if let Some(spreads) = &measured.spreads {
                let value = |row: &[Value]| row[0].grain().map_or(f64::NAN, |grain| spreads[grain.index()]);
                grains.add_column(SPREAD, |row| Value::Number(value(row)));
            }
        }
        let laws = [
            (TENSION, self.tensions.is_some(), self.network.tensions()),
            (MOBILITY, self.mobilities.is_some(), self.network.mobilities()),
        ];
        for (name, _, values) in laws.into_iter().filter(|(_, is_asked, _)| *is_asked) {
            if let Some(boundaries) = others.get_mut("boundaries") {
                let value = |number: &Value| Some(values[number.grain()?.index()]);
                boundaries.add_column(name, |row| Value::Number(value(&row[0]).unwrap_or(f64::NAN)));
            }
        }
        if let Some(texture) = &self.grains().texture {
            add_orientations(texture, &mut grains);
            if let Some(boundaries) = others.get_mut("boundaries") {
                add_disorientations(texture, boundaries);
            }
        }
        NetworkStatistics {
            version: env!("CARGO_PKG_VERSION"),
            command_line: self.provenance().command_line().into_owned(),
            random_seed: self.provenance().random_seed(),
            settings: self.provenance().settings().into_iter().collect(),
            distributions,
            topology: self.topology.clone(),
            grains,
            others,
        }
    }
}

impl NetworkStatistics {
    /// Completes the tables.
    ///
    /// # Errors
    /// [`Error::WriteOutput`]; [`Error::OutputTwice`].
    pub fn stage(&self, output: &StatisticsOutput, files: &mut StagedFiles) -> Result<(), Error> {
        output.main.stage(files, |out| match output.main.format() {
            TableFormat::Json => self.write_json(out),
            TableFormat::Csv => self.grains.write_csv(out),
        })?;
        let tables = output.others.iter().filter_map(|(name, output)| Some((self.others.get(name)?, output)));
        tables.into_iter().try_for_each(|(table, output)| output.stage(files, |out| table.write_csv(out)))
    }

    fn write_json(&self, out: &mut dyn Write) -> io::Result<()> {
        serde_json::to_writer(&mut *out, self)?;
        writeln!(out)
    }
}

type Tables = (Table, BTreeMap<&'static str, Table>, BTreeMap<&'static str, Distribution>);

/// Adds what orientation each grain has; the first column is its number.
fn add_orientations(texture: &GrainTexture, grains: &mut Table) {
    let orientation = |row: &[Value]| row[0].grain().map(|grain| texture.orientations()[grain.index()]);
    grains.add_column("EulerAngles", |row| {
        Value::Numbers(orientation(row).map_or_else(Vec::new, |one| one.euler_degrees().to_vec()))
    });
    grains.add_column("Quaternion", |row| {
        Value::Numbers(orientation(row).map_or_else(Vec::new, |one| one.quaternion().to_vec()))
    });
}

/// Adds the least rotation between the sides of each boundary; their numbers are the second and the third column.
fn add_disorientations(texture: &GrainTexture, boundaries: &mut Table) {
    let found = |row: &[Value]| {
        let [first, second] = [row[1].grain()?, row[2].grain()?];
        texture.disorientation([Side::Grain(first), Side::Grain(second)])
    };
    boundaries
        .add_column("Disorientation", |row| Value::Number(found(row).map_or(f64::NAN, |found| found.angle)));
    boundaries.add_column("DisorientationAxis", |row| {
        Value::Numbers(found(row).map_or_else(Vec::new, |found| found.axis.to_array().to_vec()))
    });
}

fn is_inside(sides: &[Side]) -> bool {
    !sides.contains(&Side::Exterior)
}

fn distributions<const N: usize>(
    quantities: [(&'static str, Vec<f64>); N],
) -> BTreeMap<&'static str, Distribution> {
    let of = |(name, values): (_, Vec<f64>)| Some((name, Distribution::of(&values)?));
    quantities.into_iter().filter_map(of).collect()
}

/// Adds dihedral angles, whose mean and spread are known; `add_range` widens a range by all angles and counts them.
fn add_angles(
    distributions: &mut BTreeMap<&'static str, Distribution>,
    angles: Option<polycrystal::AngleStatistics>,
    add_range: impl FnOnce(&mut [f64; 2]) -> usize,
) {
    let Some(angles) = angles else { return };
    let mut range = [f64::INFINITY, f64::NEG_INFINITY];
    let count = add_range(&mut range);
    let [minimum, maximum] = range;
    let distribution = Distribution { count, spread: angles.into(), minimum, maximum };
    distributions.insert("dihedral_angle", distribution);
}

impl Distribution {
    /// That of some values; nothing of nothing.
    fn of(values: &[f64]) -> Option<Self> {
        Some(Self {
            count: values.len(),
            spread: Spread::of(values)?,
            minimum: values.iter().copied().fold(f64::INFINITY, f64::min),
            maximum: values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        })
    }
}

/// A grain by number, the exterior as -1.
fn side(side: Side) -> Value {
    Value::Integer(label(side))
}

fn sides(sides: &[Side]) -> Value {
    Value::Integers(sides.iter().copied().map(label).collect())
}

/// How many grains are among the sides that meet somewhere.
fn grain_count(sides: &[Side]) -> Value {
    count(sides.iter().filter(|side| side.grain().is_some()).count())
}

fn count(count: usize) -> Value {
    Value::Integer(i64::try_from(count).unwrap_or(i64::MAX))
}

fn id(id: u32) -> Value {
    Value::Integer(id.into())
}

fn ids(ids: impl IntoIterator<Item = u32>) -> Value {
    Value::Integers(ids.into_iter().map(i64::from).collect())
}
