//! VTK's multi-block file: `boundaries`, `grains`, `triple_lines` and `quadruple_points`, each in a file of its own.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use glam::DVec3;
use polycrystal::{BoundaryId, GrainId, Side};
use rayon::prelude::*;

use super::grains::GrainMeasure;
use super::lines::Junctions;
use super::surface::Surface;
use crate::measured_arrays::{MeasuredArrays, NumberArrays};
use crate::network_file::triangles;
use crate::output::temporary_directory;
use crate::vtk::{Array, Cells, Each, PolyData, Tuples, Values, VtkFormat, write_vtk};
use crate::{Error, Output, Polycrystal};

/// Stands in the arrays `Sides` where fewer sides meet than elsewhere.
const NO_SIDE: i32 = -2;

/// The blocks, in the order of the file.
const BLOCKS: [&str; 4] = ["boundaries", "grains", "triple_lines", "quadruple_points"];

impl Polycrystal {
    /// Writes the blocks into the folder of the file's name, and then the file itself.
    pub(crate) fn write_blocks(&self, output: &Output) -> Result<(), Error> {
        let failed = |cause| Error::WriteOutput { path: output.path().to_owned(), cause };
        let surface = self.surface().map_err(failed)?;
        let folder = folder(output.path());
        let junctions = Junctions::of(&surface);
        let measured = self.measured_arrays();
        let measured = measured.as_ref();
        // All blocks or none get their names.
        let unfinished = temporary_directory(&folder).map_err(failed)?;
        let write = |block: &str| {
            let file = File::create(unfinished.path().join(block).with_extension("vtp"))?;
            let mut out = BufWriter::new(file);
            match block {
                "boundaries" => self.write_boundaries(&surface, measured, &mut out)?,
                "grains" => self.write_grain_block(&surface, measured, &mut out)?,
                "triple_lines" => self.write_triple_lines(&surface, &junctions, measured, &mut out)?,
                _ => self.write_quadruple_points(&surface, &junctions, measured, &mut out)?,
            }
            out.flush()
        };
        BLOCKS.into_iter().try_for_each(write).map_err(failed)?;
        unfinished.persist_files(&folder).map_err(failed)?;
        let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        output.write(|out| {
            writeln!(out, "<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\">\n<vtkMultiBlockDataSet>")?;
            for (index, block) in BLOCKS.iter().enumerate() {
                let file = escaped(&format!("{name}/{block}.vtp"));
                writeln!(out, "<DataSet index=\"{index}\" name=\"{block}\" file=\"{file}\"/>")?;
            }
            writeln!(out, "</vtkMultiBlockDataSet>\n</VTKFile>")
        })
    }

    /// Each boundary with points of its own, so that each has a normal of its own.
    fn write_boundaries(
        &self,
        surface: &Surface<'_>,
        measured: Option<&MeasuredArrays<'_>>,
        out: &mut dyn Write,
    ) -> io::Result<()> {
        let names = self.config.file.names;
        let boundaries = self.network.boundaries();
        let (mut ids, mut triangles, mut part_of) = (Vec::new(), Vec::new(), Vec::new());
        for (number, part) in surface.parts.iter().enumerate() {
            let first = ids.len();
            ids.extend(surface.triangles_of(part).flatten());
            ids[first..].sort_unstable();
            dedup_from(&mut ids, first);
            let is_reversed = names.reverses(&boundaries[part.boundary.index()]);
            let renumbered = |id: u32| point_id(first + ids[first..].partition_point(|other| *other < id));
            for corners in surface.triangles_of(part) {
                let [a, b, c] = corners.map(renumbered);
                triangles.push(if is_reversed { [a, c, b] } else { [a, b, c] });
                part_of.push(number);
            }
        }
        let points: Vec<DVec3> = ids.iter().map(|&id| surface.points[id as usize]).collect();
        let normals = normals(&points, &triangles);
        let count = triangles.len();
        let boundary = |triangle: usize| surface.parts[part_of[triangle]].boundary;
        let labels = |triangle: usize| names.labels(&boundaries[boundary(triangle).index()]);
        let boundary_id = |triangle: usize| boundary(triangle).0.cast_signed();
        // Points are fewer than 2^31: each has an edge of two directions with a 32-bit id.
        let id = |point: usize| ids[point].cast_signed();
        let of_boundaries: Vec<BoundaryId> = (0..count).map(boundary).collect();
        let of_cells = measured.map_or_else(NumberArrays::default, |all| all.of_cells(&of_boundaries));
        let of_points = measured.map_or_else(NumberArrays::default, |all| all.curvatures_at(&ids));
        let mut data = PolyData {
            points: &points,
            cells: Cells::Triangles(&triangles),
            point_arrays: vec![
                Array { name: "Normals", values: Values::Vectors(&normals) },
                Array { name: "PointId", values: Values::Int32Of(Each { count: points.len(), value: &id }) },
            ],
            cell_arrays: vec![
                Array { name: names.sides(), values: Values::Int32PairsOf(Each { count, value: &labels }) },
                Array { name: "BoundaryId", values: Values::Int32Of(Each { count, value: &boundary_id }) },
            ],
            field: self.field(),
        };
        data.cell_arrays.extend(of_cells.arrays());
        data.point_arrays.extend(of_points.arrays());
        write_vtk(&data, VtkFormat::Vtp, out)
    }

    /// All grains, each a closed surface with points of its own and all normals outward.
    fn write_grain_block(
        &self,
        surface: &Surface<'_>,
        measured: Option<&MeasuredArrays<'_>>,
        out: &mut dyn Write,
    ) -> io::Result<()> {
        let names = self.config.file.names;
        let parts = surface.parts_of_grains(self.network.grain_count());
        let ids = (0u32..).map(GrainId).zip(&parts).collect::<Vec<_>>();
        let grains: Vec<(Surface<'static>, GrainMeasure)> = ids
            .into_par_iter()
            .map(|(id, parts)| {
                let grain = surface.grain(id, parts);
                let measure = GrainMeasure::of(&grain);
                (grain, measure)
            })
            .collect();
        let (mut points, mut triangles, mut grain_of) = (Vec::new(), Vec::new(), Vec::new());
        for (number, (grain, _)) in grains.iter().enumerate() {
            let first = point_id(points.len());
            points.extend_from_slice(&grain.points);
            triangles.extend(grain.triangles().map(|corners| corners.map(|corner| first + corner)));
            grain_of.resize(triangles.len(), number);
        }
        let measures: Vec<GrainMeasure> = grains.into_iter().map(|(_, measure)| measure).collect();
        let count = triangles.len();
        let integers = |value| Values::Int32Of(Each { count, value });
        let doubles = |value| Values::Float64Of(Each { count, value });
        let measure = |triangle: usize| &measures[grain_of[triangle]];
        let number = |triangle: usize| names.number(GrainId(point_id(grain_of[triangle])));
        let volume = |triangle: usize| measure(triangle).volume;
        let area = |triangle: usize| measure(triangle).area;
        let neighbors = |triangle: usize| measure(triangle).neighbors;
        let sphericity = |triangle: usize| measure(triangle).sphericity;
        let of_grains = measured.map_or_else(NumberArrays::default, |all| all.of_grains(&grain_of));
        let mut data = PolyData {
            points: &points,
            cells: Cells::Triangles(&triangles),
            point_arrays: Vec::new(),
            cell_arrays: vec![
                Array { name: names.grain(), values: integers(&number) },
                Array { name: "Volume", values: doubles(&volume) },
                Array { name: "Area", values: doubles(&area) },
                Array { name: "Neighbors", values: integers(&neighbors) },
                Array { name: "Sphericity", values: doubles(&sphericity) },
            ],
            field: self.field(),
        };
        data.cell_arrays.extend(of_grains.arrays());
        write_vtk(&data, VtkFormat::Vtp, out)
    }

    /// The lines where at least three sides meet, as polylines.
    fn write_triple_lines(
        &self,
        surface: &Surface<'_>,
        junctions: &Junctions,
        measured: Option<&MeasuredArrays<'_>>,
        out: &mut dyn Write,
    ) -> io::Result<()> {
        let around = |line: &super::lines::JunctionLine| {
            sides(
                line.boundaries.iter().flat_map(|boundary| self.network.boundaries()[boundary.index()].sides),
            )
        };
        let lines = junctions.lines.iter().map(|line| (line, around(line)));
        let lines: Vec<_> = lines.filter(|(_, sides)| sides.len() >= 3).collect();
        let mut ids: Vec<u32> = lines.iter().flat_map(|(line, _)| line.points.iter().copied()).collect();
        ids.sort_unstable();
        ids.dedup();
        let points: Vec<DVec3> = ids.iter().map(|&id| surface.points[id as usize]).collect();
        let renumbered = |id: &u32| point_id(ids.partition_point(|other| other < id));
        let cells: Vec<Vec<u32>> =
            lines.iter().map(|(line, _)| line.points.iter().map(renumbered).collect()).collect();
        let sides = self.side_table(lines.iter().map(|(_, sides)| sides));
        let polylines = lines.iter().map(|(line, _)| &line.points[..]);
        let of_lines = measured.map_or_else(NumberArrays::default, |all| all.of_lines(polylines));
        let mut data = PolyData {
            points: &points,
            cells: Cells::Polylines(&cells),
            point_arrays: Vec::new(),
            cell_arrays: vec![Array { name: "Sides", values: Values::Int32Tuples(sides.tuples()) }],
            field: self.field(),
        };
        data.cell_arrays.extend(of_lines.arrays());
        write_vtk(&data, VtkFormat::Vtp, out)
    }

    /// The points where at least four sides meet.
    fn write_quadruple_points(
        &self,
        surface: &Surface<'_>,
        junctions: &Junctions,
        measured: Option<&MeasuredArrays<'_>>,
        out: &mut dyn Write,
    ) -> io::Result<()> {
        let mut at: Vec<(u32, Side)> = Vec::new();
        for line in &junctions.lines {
            let of_line =
                line.boundaries.iter().flat_map(|boundary| self.network.boundaries()[boundary.index()].sides);
            let ends = [line.points[0], line.points[line.points.len() - 1]];
            at.extend(of_line.flat_map(|side| ends.map(|end| (end, side))));
        }
        at.sort_unstable();
        at.dedup();
        let points = at.chunk_by(|a, b| a.0 == b.0).filter(|sides| sides.len() >= 4);
        let points: Vec<(u32, Vec<Side>)> =
            points.map(|at| (at[0].0, at.iter().map(|(_, side)| *side).collect())).collect();
        let sides = self.side_table(points.iter().map(|(_, sides)| sides));
        let ids: Vec<u32> = points.iter().map(|(point, _)| *point).collect();
        let points: Vec<DVec3> = ids.iter().map(|point| surface.points[*point as usize]).collect();
        let of_points = measured.map_or_else(NumberArrays::default, |all| all.of_quadruple_points(&ids));
        let mut data = PolyData {
            points: &points,
            cells: Cells::Vertices(points.len()),
            point_arrays: Vec::new(),
            cell_arrays: vec![Array { name: "Sides", values: Values::Int32Tuples(sides.tuples()) }],
            field: self.field(),
        };
        data.cell_arrays.extend(of_points.arrays());
        write_vtk(&data, VtkFormat::Vtp, out)
    }

    /// What is measured, wound as the files want it, if they are to have it.
    fn measured_arrays(&self) -> Option<MeasuredArrays<'_>> {
        let level = self.network.finest();
        let triangles = triangles(level, self.network.boundaries(), self.config.file.names);
        self.config.file.arrays.then(|| MeasuredArrays::new(self, Cells::Triangles(&triangles)))
    }

    /// The numbers of the sides that meet in each of some places.
    fn side_table<'a>(&self, places: impl Iterator<Item = &'a Vec<Side>> + Clone) -> SideTable {
        let names = self.config.file.names;
        let components = places.clone().map(Vec::len).max().unwrap_or(1);
        let row = |sides: &Vec<Side>| {
            let numbers = sides.iter().map(|side| names.side_number(*side));
            numbers.chain(std::iter::repeat(NO_SIDE)).take(components).collect::<Vec<i32>>()
        };
        SideTable { components, numbers: places.flat_map(row).collect() }
    }
}

/// As many sides for each place as meet in the one with the most.
struct SideTable {
    components: usize,
    numbers: Vec<i32>,
}

impl SideTable {
    fn tuples(&self) -> Tuples<'_> {
        Tuples { components: self.components, values: &self.numbers }
    }
}

/// Each side once: grains by number, then the exterior.
fn sides(sides: impl Iterator<Item = Side>) -> Vec<Side> {
    let mut sides: Vec<Side> = sides.collect();
    sides.sort_unstable();
    sides.dedup();
    sides
}

/// The folder of the blocks: the file's path without its extension.
fn folder(path: &Path) -> PathBuf {
    path.with_extension("")
}

/// A text within an XML attribute.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}

/// Unit normals at points: the means over their triangles, by area.
fn normals(points: &[DVec3], triangles: &[[u32; 3]]) -> Vec<DVec3> {
    let mut normals = vec![DVec3::ZERO; points.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|corner| points[corner as usize]);
        for corner in triangle {
            normals[*corner as usize] += (b - a).cross(c - a);
        }
    }
    normals.into_iter().map(DVec3::normalize_or_zero).collect()
}

/// Takes doubles out of what follows `first`, which is sorted.
fn dedup_from(ids: &mut Vec<u32>, first: usize) {
    let mut tail = ids.split_off(first);
    tail.dedup();
    ids.append(&mut tail);
}

/// A number of points or grains as an id.
fn point_id(count: usize) -> u32 {
    u32::try_from(count).expect("no more points than corners of triangles, which have 32-bit ids")
}
