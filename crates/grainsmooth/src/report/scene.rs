//! A page about a mesh or curves: a view to rotate, how points and angles are spread, and the run's figures.

use std::io;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use glam::DVec3;
use quick_xml::escape::partial_escape;

use super::chart::{Bins, Chart};
use super::view::view_of_scene;
use super::{Html, filled};
use crate::{Error, Output, Scene, ScenePicture, Shading, StagedFiles};

/// Most triangles that the view shows: browsers without a graphics card still turn them.
const MOST_TRIANGLES: usize = 120_000;

/// Width of the bins of angles, in degrees.
const ANGLE_BIN: f64 = 5.0;

/// What a page tells of a run on a mesh or on curves.
#[derive(Debug, Clone, Copy)]
pub struct SceneReport<'a> {
    /// The command line.
    pub command: &'a str,
    /// What the run said, each line a name, blanks and figures.
    pub lines: &'a [String],
    /// What was read.
    pub before: &'a Scene,
    /// What was made, from the coarsest level to the finest.
    pub levels: &'a [Scene],
}

impl SceneReport<'_> {
    /// Completes the page.
    ///
    /// # Errors
    /// [`Error::WriteOutput`]; [`Error::OutputTwice`].
    pub fn stage(&self, output: &Output<Html>, files: &mut StagedFiles) -> Result<(), Error> {
        output.stage(files, |out| out.write_all(self.page()?.as_bytes()))
    }

    fn page(&self) -> io::Result<String> {
        let last = self.levels.last().unwrap_or(self.before);
        // Surfaces of the finest level that is not too fine; curves, and what is too fine for a browser, as a picture.
        let shown =
            self.levels.iter().rev().find(|scene| (1..=MOST_TRIANGLES).contains(&scene.triangles().0.len()));
        let view = match shown {
            Some(scene) => view_of_scene(scene)?,
            None => {
                let shading = if last.faces.is_empty() { Shading::Flat } else { Shading::Smooth };
                let picture = ScenePicture { shading, ..ScenePicture::default() };
                let picture = BASE64.encode(picture.png(std::slice::from_ref(last), self.command)?);
                format!("<img class=\"picture\" alt=\"the result\" src=\"data:image/png;base64,{picture}\">")
            }
        };
        let charts: String = if last.faces.is_empty() {
            String::new()
        } else {
            [self.valences(last), self.angles(last)].iter().map(Chart::figure).collect()
        };
        let row = |line: &String| {
            let (name, value) = line.split_once("  ").unwrap_or((line, ""));
            format!("<tr><th>{}</th><td>{}</td></tr>", partial_escape(name), partial_escape(value.trim()))
        };
        let measured = [("area", area(last)), ("length of lines", length(last))];
        let measured = measured.into_iter().filter(|(_, value)| *value > 0.0);
        let measured = measured.map(|(name, value)| format!("<tr><th>{name}</th><td>{value:.9}</td></tr>"));
        let version =
            concat!("<tr><th>made by</th><td>grainsmooth ", env!("CARGO_PKG_VERSION"), "</td></tr>");
        let rows: String = self.lines.iter().map(row).chain(measured).chain([version.to_owned()]).collect();
        let kind = if last.faces.is_empty() { "lines" } else { "faces" };
        let title =
            format!("{} points, {} {kind}", last.points.len(), last.faces.len().max(last.lines.len()));
        Ok(filled(
            include_str!("../../assets/report.html"),
            &[
                ("title", &title),
                ("style", include_str!("../../assets/report.css")),
                ("command", &partial_escape(self.command)),
                ("settings", ""),
                ("asked", ""),
                ("view", &view),
                ("charts", &charts),
                ("rows", &rows),
            ],
        ))
    }

    fn valences(&self, last: &Scene) -> Chart {
        Chart {
            title: "Faces at a point".to_owned(),
            unit: "number of faces",
            of: "points",
            // Whole numbers in the middle of their bins.
            bins: Bins { start: -0.5, width: 1.0 },
            before: face_counts(self.before),
            names: ["read", "written"],
            after: face_counts(last),
            exact: Vec::new(),
            exact_name: "",
        }
    }

    fn angles(&self, last: &Scene) -> Chart {
        Chart {
            title: "Angles of faces".to_owned(),
            unit: "degrees",
            of: "corners",
            bins: Bins { start: 0.0, width: ANGLE_BIN },
            before: corner_angles(self.before),
            names: ["read", "written"],
            after: corner_angles(last),
            exact: Vec::new(),
            exact_name: "",
        }
    }
}

/// How many faces each point has that has any.
fn face_counts(scene: &Scene) -> Vec<(f64, f64)> {
    let mut counts = vec![0_u32; scene.points.len()];
    scene.faces.iter().flatten().for_each(|point| counts[*point as usize] += 1);
    counts.into_iter().filter(|count| *count > 0).map(|count| (f64::from(count), 1.0)).collect()
}

/// The angles of all faces in degrees.
fn corner_angles(scene: &Scene) -> Vec<(f64, f64)> {
    let at = |face: &[u32], k: usize| scene.points[face[k % face.len()] as usize];
    let angles = |face: &Vec<u32>| -> Vec<(f64, f64)> {
        let angle = |k: usize| {
            let corner = at(face, k);
            let [before, after] = [at(face, k + face.len() - 1), at(face, k + 1)].map(|point| point - corner);
            (before.angle_between(after).to_degrees(), 1.0)
        };
        (0..face.len()).map(angle).filter(|(angle, _)| angle.is_finite()).collect()
    };
    scene.faces.iter().flat_map(angles).collect()
}

fn area(scene: &Scene) -> f64 {
    let area = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|point| scene.points[point as usize]);
        0.5 * (b - a).cross(c - a).length()
    };
    scene.triangles().0.iter().map(area).sum()
}

fn length(scene: &Scene) -> f64 {
    let at = |point: u32| -> DVec3 { scene.points[point as usize] };
    let lengths =
        |line: &Vec<u32>| line.windows(2).map(|ends| at(ends[0]).distance(at(ends[1]))).sum::<f64>();
    scene.lines.iter().map(lengths).sum()
}
