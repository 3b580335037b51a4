//! Grains to look at.

mod columns;
mod plane;
mod shown;
mod steps;

use std::path::PathBuf;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::answer::Answer;
use super::packed::Packed;
use super::refusal::{Refusal, words};
use crate::error::Error;
use crate::mesh::file::{MeshFile, read_mesh, read_polylines};
use crate::vtk::DataArray;
use crate::{FileElements, LabelledFile};
pub(crate) use columns::{Column, Values, columns_of_shape};
use columns::{columns, components};
use plane::PlaneLines;
pub(crate) use shown::{Frame, ShownNetwork};
use steps::{Step, has_extension, network_of, steps};

/// Networks, of which one is shown.
#[derive(Debug)]
pub(super) struct Grains {
    steps: Vec<Step>,
    loaded: Loaded,
}

/// What is read of a step.
#[derive(Debug)]
struct Loaded {
    step: usize,
    /// The points, and the arrays of points and of triangles or polylines.
    mesh: MeshFile,
    /// Of grains in the plane.
    lines: Option<PlaneLines>,
    network: ShownNetwork,
    columns: Vec<Column>,
}

/// A network by itself, for a page that asks nothing.
pub(crate) fn network_alone(
    network: &ShownNetwork,
    points: &[DVec3],
    columns: &[Column],
) -> serde_json::Result<Vec<u8>> {
    let (kind, fields) = ("grains", Vec::new());
    network.packed(points, &Head { kind, is_plane: false, step: 0, steps: &[], columns, fields })
}

/// A step to show.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Shown {
    step: usize,
}

/// An array to show.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Wanted {
    step: usize,
    /// As the head of the step numbers them.
    array: usize,
}

/// What the page hears of a step beside the network.
#[derive(Serialize)]
struct Head<'a> {
    kind: &'static str,
    is_plane: bool,
    step: usize,
    steps: &'a [Step],
    columns: &'a [Column],
    /// Names of the arrays of points and triangles, component by component.
    fields: Vec<String>,
}

impl Grains {
    pub(super) fn open(paths: &[PathBuf]) -> Result<Self, Error> {
        let steps = steps(paths)?;
        Ok(Self { loaded: Loaded::read(&steps, 0)?, steps })
    }

    pub(super) fn answer(&mut self, path: &str, body: &[u8]) -> Result<Answer, Refusal> {
        match path {
            "/open" => self.show(self.loaded.step),
            "/step" => {
                let Shown { step } = words(body)?;
                self.show(step)
            }
            "/array" => {
                let Wanted { step, array } = words(body)?;
                self.load(step)?;
                let values =
                    self.loaded.field(array).ok_or_else(|| Refusal::impossible(&"there is no such array"))?;
                let mut packed = Packed::default();
                #[expect(clippy::cast_possible_truncation, reason = "colours need no more digits")]
                packed.floats("values", values.into_iter().map(|value| value as f32));
                Ok(Answer::packed(packed.bytes(&())?))
            }
            _ => Err(Refusal::no_such_command(path)),
        }
    }

    fn load(&mut self, step: usize) -> Result<(), Refusal> {
        if step >= self.steps.len() {
            return Err(Refusal::impossible(&format!(
                "there are {} steps, counted from 0",
                self.steps.len()
            )));
        }
        if step != self.loaded.step {
            self.loaded = Loaded::read(&self.steps, step).map_err(|error| Refusal::impossible(&error))?;
        }
        Ok(())
    }

    fn show(&mut self, step: usize) -> Result<Answer, Refusal> {
        self.load(step)?;
        let Loaded { step, mesh, lines, network, columns } = &self.loaded;
        let head = Head {
            kind: "grains",
            is_plane: lines.is_some(),
            step: *step,
            steps: &self.steps,
            columns,
            fields: self.loaded.field_names(),
        };
        Ok(Answer::packed(network.packed(&mesh.points, &head)?))
    }
}

impl Loaded {
    fn read(steps: &[Step], step: usize) -> Result<Self, Error> {
        let path = network_of(&steps[step].path)?;
        let file = LabelledFile::read(&path)?;
        let sides: Vec<[Option<u32>; 2]> =
            file.sides.iter().map(|sides| sides.map(|side| side.grain().map(|grain| grain.0))).collect();
        let points: Vec<_> = file.points.iter().map(|point| *point * file.stretch).collect();
        // What other programs' formats hold of arrays is in the network already.
        let has_arrays = ["vtp", "vtu", "vtk"].into_iter().any(|extension| has_extension(&path, extension));
        let (lines, network) = match &file.elements {
            FileElements::Triangles(triangles) => {
                let boundary_of: Vec<u32> = file.boundary_of.iter().map(|boundary| boundary.0).collect();
                (None, ShownNetwork::new(&points, triangles, &boundary_of, &sides))
            }
            FileElements::Segments(segments) => {
                let sides = file.boundary_of.iter().map(|boundary| sides[boundary.index()]).collect();
                let lines = PlaneLines::new(segments, sides);
                let network = lines.network(&points);
                (Some(lines), network)
            }
        };
        let mesh = match (has_arrays, &lines) {
            (false, _) => MeshFile::default(),
            (true, None) => read_mesh(&path)?,
            (true, Some(_)) => read_polylines(&path)?,
        };
        let columns = columns(&file, &network);
        // The arrays; what else there is was looked at already.
        Ok(Self { step, mesh: MeshFile { points, faces: Vec::new(), ..mesh }, lines, network, columns })
    }

    /// The arrays of triangles, in the plane of polylines.
    fn cell_data(&self) -> &[DataArray] {
        if self.lines.is_some() { &self.mesh.line_data } else { &self.mesh.face_data }
    }

    fn field_names(&self) -> Vec<String> {
        let arrays = self.mesh.point_data.iter().chain(self.cell_data());
        arrays.flat_map(components).collect()
    }

    /// The numbers of a component of an array at each vertex.
    fn field(&self, number: usize) -> Option<Vec<f64>> {
        let of_points = self.mesh.point_data.iter().map(|array| (array, true));
        let of_cells = self.cell_data().iter().map(|array| (array, false));
        let mut parts = of_points.chain(of_cells).flat_map(|(array, is_of_points)| {
            (0..array.components).map(move |part| (array, is_of_points, part))
        });
        let (array, is_of_points, part) = parts.nth(number)?;
        let numbers = array.to_f64();
        Some(match (is_of_points, &self.lines) {
            (true, _) => self.network.of_points(&numbers, array.components, part),
            (false, None) => self.network.of_triangles(&numbers, array.components, part),
            (false, Some(lines)) => {
                // Polylines were cut into their segments in order.
                let counts = self.mesh.lines.iter().map(|line| line.len() - 1);
                let cells: Vec<usize> =
                    counts.enumerate().flat_map(|(cell, count)| std::iter::repeat_n(cell, count)).collect();
                let number = |segment: u32| numbers[array.components * cells[segment as usize] + part];
                lines.at_vertices(&self.network, number)
            }
        })
    }
}
