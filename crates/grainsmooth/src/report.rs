//! A page about a run: its grains to rotate, its statistics, its figures.

mod chart;
mod map_slices;
mod orientation_figures;
mod poisson_voronoi;
mod scene;
mod view;

use std::io;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use polycrystal::{WeightedAngle, angles_between_boundaries};
use quick_xml::escape::partial_escape;
use sizes::Distribution;
use texture::{AngleHistogram, Pair, RandomDisorientations};
use voronoi::Dimension;

use crate::figures::significant::significant;
use crate::volume_mesh::quality::TetrahedronShape;
use crate::{
    AskedAndReached, Error, GrainSizes, GrainTexture, Output, Picture, Polycrystal, StagedFiles, Summary,
    Synthesis, VolumeMesh,
};
use chart::Chart;
use poisson_voronoi::{SIZE_BIN, angle_density, face_shares, size_shares};
pub use scene::SceneReport;

/// The format of reports: one page that needs nothing else.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Html;

/// What curves of geometry belong to.
const RANDOM_CELLS: &str = "random cells in unbounded space";

/// What histograms are that show what relaxation changes.
const BEFORE_AND_AFTER: [&str; 2] = ["before", "after"];

/// Width of the bins of angles, in degrees: a run of 200 grains fills each between 90 and 150.
const ANGLE_BIN: f64 = 5.0;

/// Bins of diameters, from 0 to the largest.
const DIAMETER_BINS: f64 = 20.0;

impl Polycrystal {
    /// Completes a page with a view of the grains, their statistics beside those of random cells, and the run's summary.
    ///
    /// The view shows the surfaces at the finest level that a browser turns fluently; in the plane it is a picture.
    ///
    /// # Errors
    /// [`Error::WriteOutput`]; [`Error::OutputTwice`].
    pub fn stage_report(&self, output: &Output<Html>, files: &mut StagedFiles) -> Result<(), Error> {
        output.stage(files, |out| out.write_all(self.page()?.as_bytes()))
    }

    fn page(&self) -> io::Result<String> {
        let view = match self.dimension() {
            Dimension::Two => {
                let picture = BASE64.encode(self.png(&Picture::default())?);
                format!("<img class=\"picture\" alt=\"the grains\" src=\"data:image/png;base64,{picture}\">")
            }
            Dimension::Three => view::view(self)?,
        };
        let mut of_sizes = self
            .synthesis()
            .and_then(|made| made.cells.sizes.as_ref())
            .map_or_else(Vec::new, |sizes| self.all_diameter_charts(sizes));
        if of_sizes.is_empty() {
            of_sizes.push(self.size_chart());
        }
        of_sizes.extend([self.face_chart(), self.angle_chart()]);
        let mut charts = map_slices::figures(self)?;
        charts.extend(of_sizes.iter().map(Chart::figure));
        if let Some(texture) = &self.grains().texture {
            charts += &self.disorientation_chart(texture).figure();
            for number in 0..texture.texture_count() {
                let (symmetry, grains) = texture.members(number);
                let volumes = self.network.cell_volumes();
                let weighted = grains.iter().map(|grain| (texture.orientations()[*grain], volumes[*grain]));
                let weighted: Vec<_> = weighted.collect();
                charts += &orientation_figures::figures(&weighted, symmetry, &self.of_phase(number))?;
            }
        }
        if let Some(mesh) = &self.volume_mesh {
            charts.extend(tetrahedron_charts(mesh).iter().map(Chart::figure));
        }
        let title = format!("{} grains", self.network.grain_count());
        Ok(filled(
            include_str!("../assets/report.html"),
            &[
                ("title", &title),
                ("style", include_str!("../assets/report.css")),
                ("command", &partial_escape(&self.provenance().command_line())),
                (
                    "settings",
                    &format!(
                        "<details><summary>All settings</summary><pre>{}</pre></details>",
                        partial_escape(&self.provenance().text())
                    ),
                ),
                ("view", &view),
                ("charts", &charts),
                ("asked", &self.asked_table()),
                ("rows", &self.rows()),
            ],
        ))
    }

    /// What was asked for beside what was reached; nothing where nothing was.
    fn asked_table(&self) -> String {
        let row = |AskedAndReached { what, asked, reached }: &AskedAndReached| {
            let [asked, reached] = [asked, reached].map(|value| significant(*value, 6));
            format!("<tr><th>{}</th><td>{asked}</td><td>{reached}</td></tr>", partial_escape(what))
        };
        let rows: String = self.asked_and_reached().iter().map(row).collect();
        if rows.is_empty() {
            return rows;
        }
        format!(
            "<h2>Asked and reached</h2>\n<table><tr><th></th><td>asked</td><td>reached</td></tr>{rows}</table>"
        )
    }

    /// The summary as rows of a table.
    fn rows(&self) -> String {
        let version = concat!("made by     grainsmooth ", env!("CARGO_PKG_VERSION"));
        let summary = Summary(self).to_string();
        let lines = summary.lines().chain([version]);
        let row = |line: &str| {
            let (name, value) = line.split_once("  ").unwrap_or((line, ""));
            format!("<tr><th>{}</th><td>{}</td></tr>", partial_escape(name), partial_escape(value.trim()))
        };
        lines.map(row).collect()
    }

    /// Behind the title of what shows a phase alone; nothing without phases.
    fn of_phase(&self, number: usize) -> String {
        let name = self.grains().phases.as_ref().and_then(|phases| phases.names().nth(number));
        name.map_or_else(String::new, |name| format!(", {name}"))
    }

    fn size_chart(&self) -> Chart {
        let volumes = self.network.cell_volumes();
        let mean = volumes.iter().sum::<f64>() / volumes.len() as f64;
        let sizes = volumes.iter().map(|volume| (volume / mean, 1.0));
        let exact = (0..)
            .zip(size_shares(self.dimension()))
            .map(|(bin, share)| ((f64::from(bin) + 0.5) * SIZE_BIN, 2.0 * share));
        let (title, unit) = match self.dimension() {
            Dimension::Two => ("Areas", "area / mean area"),
            Dimension::Three => ("Volumes", "volume / mean volume"),
        };
        Chart {
            title: title.to_owned(),
            unit,
            of: "grains",
            // Twice the width of the curve's bins, hence twice its shares.
            bins: chart::Bins { start: 0.0, width: 2.0 * SIZE_BIN },
            before: Vec::new(),
            names: BEFORE_AND_AFTER,
            after: sizes.collect(),
            exact: exact.collect(),
            exact_name: RANDOM_CELLS,
        }
    }

    /// Diameters of all grains, or of each phase where these have diameters of their own, beside what was asked for.
    fn all_diameter_charts(&self, sizes: &GrainSizes) -> Vec<Chart> {
        let volumes = &self.grains().by_parents(self.network.cell_volumes())[..];
        let has_one = sizes.groups().count() == 1;
        let mut charts = Vec::new();
        for (number, (group, grains)) in sizes.groups().enumerate() {
            let Some(distribution) = group.distribution() else { continue };
            let diameters = sizes.unscaled_diameters(group, &grains, volumes);
            let volumes: Vec<f64> = grains.iter().map(|grain| volumes[*grain]).collect();
            let whose = if has_one { String::new() } else { self.of_phase(number) };
            charts.extend(self.diameter_charts(&diameters, &volumes, distribution, &whose));
        }
        charts
    }

    /// Diameters of some grains by number and by volume, beside those that were asked for.
    fn diameter_charts(
        &self,
        diameters: &[f64],
        volumes: &[f64],
        distribution: &Distribution,
        whose: &str,
    ) -> [Chart; 2] {
        let axes = u32::from(self.dimension().axes());
        let largest = diameters.iter().copied().fold(0.0, f64::max);
        let width = largest / DIAMETER_BINS;
        // The share of a bin around each place.
        let curve = |power: u32| -> Vec<(f64, f64)> {
            let share = |step: i32| {
                let middle = 0.25 * width * f64::from(step);
                let below = |end: f64| distribution.share_below(end, power);
                (middle, below(middle + 0.5 * width) - below(middle - 0.5 * width))
            };
            (0..).map(share).take_while(|(middle, _)| *middle <= 1.1 * largest).collect()
        };
        let chart = |title: &str, of, weights: Vec<f64>, power| Chart {
            title: format!("{title}{whose}"),
            unit: "equivalent diameter asked for",
            of,
            bins: chart::Bins { start: 0.0, width },
            before: Vec::new(),
            names: BEFORE_AND_AFTER,
            after: diameters.iter().copied().zip(weights).collect(),
            exact: curve(power),
            exact_name: "asked for",
        };
        let of_volume = if axes == 2 { "the area" } else { "the volume" };
        [
            chart("Diameters by number", "grains", vec![1.0; diameters.len()], 0),
            chart(
                if axes == 2 { "Diameters by area" } else { "Diameters by volume" },
                of_volume,
                volumes.to_vec(),
                axes,
            ),
        ]
    }

    fn disorientation_chart(&self, texture: &GrainTexture) -> Chart {
        let pairs = self.neighbor_pairs();
        let angle =
            |(first, second, area): &Pair| texture.between(*first, *second).map(|found| (found.angle, *area));
        // Neighbours of different symmetries have none, and no curve is that of several.
        let exact = texture.symmetry().map_or_else(Vec::new, |symmetry| {
            let random = RandomDisorientations::new(symmetry);
            let curve = (0..=180).map(f64::from).take_while(|angle| *angle <= random.largest() + 1.0);
            curve.map(|angle| (angle, ANGLE_BIN * random.density(angle))).collect()
        });
        Chart {
            title: "Disorientations of neighbours".to_owned(),
            unit: "degrees",
            of: match self.dimension() {
                Dimension::Two => "the length of boundaries",
                Dimension::Three => "the area of boundaries",
            },
            bins: chart::Bins { start: 0.0, width: ANGLE_BIN },
            before: texture.target().map_or_else(Vec::new, in_degrees),
            names: ["asked for", "this run"],
            after: pairs.iter().filter_map(angle).collect(),
            exact,
            exact_name: "random orientations (Mackenzie)",
        }
    }

    fn face_chart(&self) -> Chart {
        let cells = self.synthesis().map(|Synthesis { cells, .. }| cells.face_counts(&cells.tessellation));
        let count = |count: usize| (count as f64, 1.0);
        let (least, shares) = face_shares(self.dimension());
        let (title, unit) = match self.dimension() {
            Dimension::Two => ("Sides of a grain", "number of sides"),
            Dimension::Three => ("Faces of a grain", "number of faces"),
        };
        Chart {
            title: title.to_owned(),
            unit,
            of: "grains",
            // Whole numbers in the middle of their bins.
            bins: chart::Bins { start: -0.5, width: 1.0 },
            before: cells.into_iter().flatten().map(count).collect(),
            names: BEFORE_AND_AFTER,
            after: self.boundary_counts().into_iter().map(count).collect(),
            exact: (least..).zip(shares).map(|(count, share)| (count as f64, *share)).collect(),
            exact_name: RANDOM_CELLS,
        }
    }

    fn angle_chart(&self) -> Chart {
        let network = &self.network;
        let weighted = |angles: Vec<WeightedAngle>| {
            angles.into_iter().map(|angle| (angle.degrees, angle.weight)).collect()
        };
        let width = ANGLE_BIN.to_radians();
        let exact = (0..=90)
            .map(|step| 2.0 * f64::from(step))
            .map(|degrees| (degrees, width * angle_density(self.dimension(), degrees.to_radians())));
        Chart {
            title: "Angles between boundaries".to_owned(),
            unit: "degrees",
            of: match self.dimension() {
                Dimension::Two => "triple points",
                Dimension::Three => "the length of triple lines",
            },
            bins: chart::Bins { start: 0.0, width: ANGLE_BIN },
            before: self.synthesis().map_or_else(Vec::new, |made| weighted(made.flat_angles.clone())),
            names: BEFORE_AND_AFTER,
            after: weighted(angles_between_boundaries(network, network.finest(), &self.unstretched_points())),
            exact: exact.collect(),
            exact_name: RANDOM_CELLS,
        }
    }
}

/// How good tetrahedra are. What is beyond ten times a regular one's aspect ratio counts as that.
fn tetrahedron_charts(mesh: &VolumeMesh) -> [Chart; 4] {
    let shapes = mesh.shapes();
    let chart = |title: &str, unit, width, of: fn(&TetrahedronShape) -> f64| Chart {
        title: title.to_owned(),
        unit,
        of: "tetrahedra",
        bins: chart::Bins { start: 0.0, width },
        before: Vec::new(),
        names: BEFORE_AND_AFTER,
        after: shapes.iter().map(|shape| (of(shape), 1.0)).collect(),
        exact: Vec::new(),
        exact_name: RANDOM_CELLS,
    };
    [
        chart("Gamma of tetrahedra", "gamma", 0.05, |shape| shape.gamma),
        chart("Least angle between faces of a tetrahedron", "degrees", ANGLE_BIN, |shape| shape.least_angle),
        chart("Aspect ratios of tetrahedra", "aspect ratio", 0.5, |shape| {
            shape.aspect_ratio.clamp(0.0, 10.0)
        }),
        chart("Volumes of tetrahedra", "volume in units of the mean", 0.25, |shape| shape.volume),
    ]
}

/// A histogram as weighted angles, some each degree, for bins of another width.
fn in_degrees(histogram: &AngleHistogram) -> Vec<(f64, f64)> {
    let starts = std::iter::once(0.0).chain(histogram.bins().map(|(end, _)| end));
    let bins = histogram.bins().zip(starts);
    let parts = bins.flat_map(|((end, share), start)| {
        let count = (end - start).ceil().max(1.0);
        let part = move |part: i32| (start + (end - start) * (f64::from(part) + 0.5) / count, share / count);
        (0..).map(part).take_while(move |(angle, _)| *angle < end)
    });
    parts.collect()
}

/// A template with each `{{name}}` replaced by its value, once: values may hold braces.
fn filled(template: &str, values: &[(&str, &str)]) -> String {
    let mut pieces = template.split("{{");
    let mut text = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        let (name, rest) = piece.split_once("}}").expect("templates close their braces");
        let value = values.iter().find(|(known, _)| *known == name).expect("templates name known values");
        text.push_str(value.1);
        text.push_str(rest);
    }
    text
}
