//! Grains to look at.

mod columns;
mod shown;
mod steps;

use std::path::PathBuf;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::answer::Answer;
use super::packed::Packed;
use super::refusal::{Refusal, words};
use crate::error::Error;
use crate::error::mesh_file::MeshFileProblem;
use crate::mesh::file::{MeshFile, read_mesh};
use crate::{FileElements, LabelledFile};
pub(crate) use columns::{Column, Values, columns_of_shape};
use columns::{columns, components};
pub(crate) use shown::{Frame, ShownNetwork};
use steps::{Step, network_of, steps};

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
    /// The points, and the arrays of points and triangles.
    mesh: MeshFile,
    network: ShownNetwork,
    columns: Vec<Column>,
}

/// A network by itself, for a page that asks nothing.
pub(crate) fn network_alone(
    network: &ShownNetwork,
    points: &[DVec3],
    columns: &[Column],
) -> serde_json::Result<Vec<u8>> {
    network.packed(points, &Head { kind: "grains", step: 0, steps: &[], columns, fields: Vec::new() })
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
                Ok(Answer::packed(packed.finish(&())?))
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
        let Loaded { step, mesh, network, columns } = &self.loaded;
        let head = Head {
            kind: "grains",
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
        let FileElements::Triangles(triangles) = &file.elements else {
            return Err(Error::MeshFile { path, problem: MeshFileProblem::PlaneNetwork });
        };
        let boundary_of: Vec<u32> = file.boundary_of.iter().map(|boundary| boundary.0).collect();
        let sides: Vec<[Option<u32>; 2]> =
            file.sides.iter().map(|sides| sides.map(|side| side.grain().map(|grain| grain.0))).collect();
        let points: Vec<_> = file.points.iter().map(|point| *point * file.stretch).collect();
        let network = ShownNetwork::new(&points, triangles, &boundary_of, &sides);
        let columns = columns(&file, &network);
        // The arrays; what else there is was looked at already.
        let mesh = MeshFile { points, faces: Vec::new(), ..read_mesh(&path)? };
        Ok(Self { step, mesh, network, columns })
    }

    fn field_names(&self) -> Vec<String> {
        let arrays = self.mesh.point_data.iter().chain(&self.mesh.face_data);
        arrays.flat_map(components).collect()
    }

    /// The numbers of a component of an array at each vertex.
    fn field(&self, number: usize) -> Option<Vec<f64>> {
        let of_points = self.mesh.point_data.iter().map(|array| (array, true));
        let of_triangles = self.mesh.face_data.iter().map(|array| (array, false));
        let mut parts = of_points.chain(of_triangles).flat_map(|(array, is_of_points)| {
            (0..array.components).map(move |part| (array, is_of_points, part))
        });
        let (array, is_of_points, part) = parts.nth(number)?;
        let numbers = columns::numbers(array);
        Some(match is_of_points {
            true => self.network.of_points(&numbers, array.components, part),
            false => self.network.of_triangles(&numbers, array.components, part),
        })
    }
}
