//! VTK's multi-block file: `boundaries`, `grains`, `triple_lines` and `quadruple_points`, each in a file of its own.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use glam::DVec3;
use polycrystal::{BoundaryId, GrainId, Mesh, Side};
use quick_xml::escape::escape;
use rayon::prelude::*;

use super::format::{Beside, Content, Extra, Format, Writer};
use super::grains::GrainMeasure;
use super::lines::{JunctionLine, Junctions};
use super::surface::Surface;
use super::vtk::COMPRESSED;
use crate::files::output::OutputPath;
use crate::formats::measured_arrays::{CURVATURES, MeasuredArrays};
use crate::formats::network::{boundary_polylines, triangles};
use crate::memory::LevelSize;
use crate::names::{NUMBER_OF_GRAINS, SEED_ID};
use crate::vtk::{Array, Cells, DataArray, PolyData, Values, VtkFormat, write_vtk};
use crate::vtk::{PieceData, PieceSize, PieceValues, write_pieces};
use crate::{Error, Polycrystal, StagedFiles};

/// Stands in the arrays `Sides` where fewer sides meet than elsewhere.
const NO_SIDE: i32 = -2;

/// The blocks, in the order of the file.
const BLOCKS: [&str; 4] = ["boundaries", "grains", "triple_lines", "quadruple_points"];

pub(super) const FORMAT: Format = Format {
    extension: "vtm",
    content: Content::Boundaries,
    bytes: |size| {
        let LevelSize { points, triangles, .. } = size.mesh;
        // Boundaries have normals, and every triangle comes at two grains, with five arrays.
        size.encoded(size.of_network() + 27 * points + 2 * (24 * points + 48 * triangles), COMPRESSED)
    },
    write: Writer::Files(Polycrystal::stage_blocks),
    extra: Extra { beside: Some(Beside::Folder), ..Extra::NONE },
};

impl Polycrystal {
    /// Completes the blocks, for the folder of the file's name, and the file itself.
    fn stage_blocks(&self, output: &OutputPath<()>, files: &mut StagedFiles) -> Result<(), Error> {
        let folder = output.target().with_extension("");
        let surface = Surface::network(self);
        let space = surface.as_ref().map(|surface| (surface, Junctions::of(surface)));
        let measured = self.measured_arrays();
        let measured = measured.as_ref();
        let write = |block: &str, directory: &Path| {
            let file = File::create(directory.join(block).with_extension("vtp"))?;
            let out = &mut BufWriter::new(file);
            match (block, &space) {
                ("boundaries", Some((surface, _))) => self.write_boundaries(surface, measured, out)?,
                ("grains", Some((surface, _))) => self.write_grain_block(surface, measured, out)?,
                ("triple_lines", Some((_, junctions))) => {
                    self.write_triple_lines(junctions, measured, out)?;
                }
                (_, Some((_, junctions))) => self.write_quadruple_points(junctions, measured, out)?,
                ("boundaries", None) => self.write_plane_boundaries(measured, out)?,
                ("grains", None) => self.write_plane_grains(out)?,
                ("triple_lines", None) => self.write_plane_junctions(3, out)?,
                (_, None) => self.write_plane_junctions(4, out)?,
            }
            out.flush()
        };
        files.files_in(&folder, output.path(), |directory| {
            BLOCKS.into_iter().try_for_each(|block| write(block, directory))
        })?;
        let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        output.stage(files, |out| {
            writeln!(out, "<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\">\n<vtkMultiBlockDataSet>")?;
            for (index, block) in BLOCKS.iter().enumerate() {
                let path = format!("{name}/{block}.vtp");
                let file = escape(&path);
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
        let names = self.file().names;
        let boundaries = self.network.boundaries();
        let boundary_of = |piece: usize| &boundaries[surface.parts[piece].boundary.index()];
        let ids = |piece: usize| {
            let mut ids: Vec<u32> = surface.triangles_of(&surface.parts[piece]).flatten().collect();
            ids.sort_unstable();
            ids.dedup();
            ids
        };
        let points_of =
            |ids: &[u32]| -> Vec<DVec3> { ids.iter().map(|&id| surface.points[id as usize]).collect() };
        let triangles_of = |piece: usize, ids: &[u32]| -> Vec<[u32; 3]> {
            let is_reversed = names.reverses(boundary_of(piece));
            let renumbered = |id: u32| point_id(ids.partition_point(|other| *other < id));
            let triangles =
                surface.triangles_of(&surface.parts[piece]).map(|corners| corners.map(renumbered));
            triangles.map(|[a, b, c]| if is_reversed { [a, c, b] } else { [a, b, c] }).collect()
        };
        let sizes: Vec<PieceSize> = (0..surface.parts.len())
            .into_par_iter()
            .map(|piece| PieceSize {
                points: ids(piece).len(),
                triangles: surface.triangles_of(&surface.parts[piece]).count(),
            })
            .collect();
        // Points are fewer than 2^31: each has an edge of two directions with a 32-bit id.
        let point_ids = |piece: usize| ids(piece).into_iter().map(u32::cast_signed).collect();
        let normals = |piece: usize| {
            let ids = ids(piece);
            normals(&points_of(&ids), &triangles_of(piece, &ids))
        };
        let boundary_id = |piece: usize| surface.parts[piece].boundary.0.cast_signed();
        let of_parts: Vec<BoundaryId> = surface.parts.iter().map(|part| part.boundary).collect();
        let of_parts = measured.map_or_else(Vec::new, |all| all.of_cells(&of_parts));
        let boundary_tuples = self.boundary_tuples();
        let mut data = PieceData {
            sizes: &sizes,
            points: &|piece| points_of(&ids(piece)),
            triangles: &|piece| triangles_of(piece, &ids(piece)),
            point_arrays: vec![
                PieceValues::at_points("Normals", normals),
                PieceValues::at_points("PointId", point_ids),
                PieceValues::at_points(NUMBER_OF_GRAINS, |piece| self.grain_counts(&ids(piece))),
            ],
            cell_arrays: vec![
                PieceValues::each(names.sides(), |piece| names.labels(boundary_of(piece))),
                PieceValues::each("BoundaryId", boundary_id),
            ],
            field: self.field(),
        };
        let boundary = |piece: usize| Some(surface.parts[piece].boundary.index());
        data.cell_arrays.extend(boundary_tuples.iter().map(|tuples| PieceValues::of_items(tuples, boundary)));
        data.cell_arrays.extend(of_parts.iter().map(PieceValues::of_data));
        for (place, name) in CURVATURES.into_iter().enumerate().filter(|_| measured.is_some()) {
            let at = move |piece: usize| {
                measured.map_or_else(Vec::new, |all| all.curvature_at(place, &ids(piece)))
            };
            data.point_arrays.push(PieceValues::at_points(name, at));
        }
        write_pieces(&data, self.file().encoding, out)
    }

    /// All grains, each a closed surface with points of its own and all normals outward.
    fn write_grain_block(
        &self,
        surface: &Surface<'_>,
        measured: Option<&MeasuredArrays<'_>>,
        out: &mut dyn Write,
    ) -> io::Result<()> {
        let names = self.file().names;
        let parts = surface.parts_of_grains(self.network.grain_count());
        let id = |number: usize| GrainId(point_id(number));
        // What has vanished has no surface.
        let left: Vec<usize> = (0..parts.len()).filter(|number| !parts[*number].is_empty()).collect();
        // Grains are made anew for each array: all at once they take more memory than the network.
        let grain = |piece: usize| surface.grain(id(left[piece]), &parts[left[piece]]);
        let found = (0..left.len()).into_par_iter().map(|piece| {
            let grain = grain(piece);
            let size = PieceSize { points: grain.points.len(), triangles: grain.triangle_count() };
            (size, GrainMeasure::of(&grain))
        });
        let (sizes, measures): (Vec<PieceSize>, Vec<GrainMeasure>) = found.unzip();
        let seed = |piece: usize| self.grains().ids[left[piece]].cast_signed();
        let of_grains = measured.map_or_else(Vec::new, |all| all.of_grains(&left));
        let tuples = self.grain_tuples();
        let mut data = PieceData {
            sizes: &sizes,
            points: &|piece| grain(piece).points.into_owned(),
            triangles: &|piece| grain(piece).triangles().collect(),
            point_arrays: Vec::new(),
            cell_arrays: vec![
                PieceValues::each(names.grain(), |piece| names.number(id(left[piece]))),
                PieceValues::each(SEED_ID, seed),
                PieceValues::each("Volume", |piece| measures[piece].volume),
                PieceValues::each("Area", |piece| measures[piece].area),
                PieceValues::each("Neighbors", |piece| measures[piece].neighbors),
                PieceValues::each("Sphericity", |piece| measures[piece].sphericity),
            ],
            field: self.field(),
        };
        let tuple = |piece: usize| Some(left[piece]);
        data.cell_arrays.extend(tuples.iter().map(|tuples| PieceValues::of_items(tuples, tuple)));
        data.cell_arrays.extend(of_grains.iter().map(PieceValues::of_data));
        write_pieces(&data, self.file().encoding, out)
    }

    /// The lines where at least three sides meet, as polylines.
    fn write_triple_lines(
        &self,
        junctions: &Junctions,
        measured: Option<&MeasuredArrays<'_>>,
        out: &mut dyn Write,
    ) -> io::Result<()> {
        let lines = junctions.lines.iter().map(|line| (line, self.sides_around(line)));
        let lines: Vec<_> = lines.filter(|(_, sides)| sides.len() >= 3).collect();
        let mut ids: Vec<u32> = lines.iter().flat_map(|(line, _)| line.points.iter().copied()).collect();
        ids.sort_unstable();
        ids.dedup();
        let renumbered = |id: &u32| point_id(ids.partition_point(|other| other < id));
        let cells: Vec<Vec<u32>> =
            lines.iter().map(|(line, _)| line.points.iter().map(renumbered).collect()).collect();
        let polylines = lines.iter().map(|(line, _)| &line.points[..]);
        let of_lines = measured.map_or_else(Vec::new, |all| all.of_lines(polylines));
        let sides = lines.iter().map(|(_, sides)| sides);
        let junctions = (Cells::Polylines(&cells), sides, self.most_sides(junctions));
        self.write_junctions(&ids, junctions, &of_lines, out)
    }

    /// Lines or points where sides meet, with these sides and the most that meet anywhere. `ids` are the points.
    pub(super) fn write_junctions<'a>(
        &self,
        ids: &[u32],
        (cells, sides, components): (Cells<'_>, impl Iterator<Item = &'a Vec<Side>>, usize),
        measured: &[DataArray],
        out: &mut dyn Write,
    ) -> io::Result<()> {
        let points: Vec<DVec3> = ids.iter().map(|&id| self.points[id as usize]).collect();
        let grain_counts = self.grain_counts(ids);
        // All blocks of a file have as many components, of which ParaView warns where they differ.
        let names = self.file().names;
        let row = |sides: &Vec<Side>| {
            let numbers = sides.iter().map(|side| names.side_number(*side));
            numbers.chain(std::iter::repeat(NO_SIDE)).take(components).collect::<Vec<i32>>()
        };
        let sides: Vec<i32> = sides.flat_map(row).collect();
        let mut cell_arrays = vec![Array { name: "Sides", values: Values::tuples(components, &sides) }];
        cell_arrays.extend(measured.iter().map(DataArray::array));
        let data = PolyData {
            points: &points,
            cells,
            point_arrays: vec![Array { name: NUMBER_OF_GRAINS, values: Values::slice(&grain_counts) }],
            cell_arrays,
            field: self.field(),
        };
        write_vtk(&data, VtkFormat::Vtp, self.file().encoding, out)
    }

    /// The points where at least four sides meet.
    fn write_quadruple_points(
        &self,
        junctions: &Junctions,
        measured: Option<&MeasuredArrays<'_>>,
        out: &mut dyn Write,
    ) -> io::Result<()> {
        let points = self.quadruple_points(junctions);
        let ids: Vec<u32> = points.iter().map(|(point, _)| *point).collect();
        let of_points = measured.map_or_else(Vec::new, |all| all.of_quadruple_points(&ids));
        let sides = points.iter().map(|(_, sides)| sides);
        let junctions = (Cells::Vertices(ids.len()), sides, self.most_sides(junctions));
        self.write_junctions(&ids, junctions, &of_points, out)
    }

    /// The sides that meet in a line.
    fn sides_around(&self, line: &JunctionLine) -> Vec<Side> {
        let boundaries = line.boundaries.iter().map(|boundary| &self.network.boundaries()[boundary.index()]);
        sides(boundaries.flat_map(|boundary| boundary.sides))
    }

    /// The points where at least four sides meet, and these.
    fn quadruple_points(&self, junctions: &Junctions) -> Vec<(u32, Vec<Side>)> {
        let lines = junctions.lines.iter().map(|line| (&line.points[..], self.sides_around(line)));
        let mut points = sides_at_ends(lines);
        points.retain(|(_, sides)| sides.len() >= 4);
        points
    }

    /// What is measured, wound as the files want it, if they are to have it.
    fn measured_arrays(&self) -> Option<MeasuredArrays<'_>> {
        let (level, boundaries, names) =
            (self.network.finest_level(), self.network.boundaries(), self.file().names);
        let triangles = triangles(&level, boundaries, names);
        let (polylines, _) = boundary_polylines(&level, boundaries, names);
        let cells = match &level.mesh {
            Mesh::Triangles(_) => Cells::Triangles(&triangles),
            Mesh::Segments(_) => Cells::Polylines(&polylines),
        };
        self.file().arrays.then(|| MeasuredArrays::new(self, cells))
    }

    /// The most sides that meet anywhere.
    fn most_sides(&self, junctions: &Junctions) -> usize {
        let of_lines = junctions.lines.iter().map(|line| self.sides_around(line).len());
        let of_points = self.quadruple_points(junctions).into_iter().map(|(_, sides)| sides.len());
        of_lines.chain(of_points).max().unwrap_or(1)
    }

    /// How many grains meet at some of the points.
    pub(super) fn grain_counts(&self, points: &[u32]) -> Vec<u8> {
        let level = self.network.finest();
        points.iter().map(|point| level.grain_count(*point as usize)).collect()
    }
}

/// The points where lines end, each with the sides that meet in these lines.
pub(super) fn sides_at_ends<'a>(
    lines: impl Iterator<Item = (&'a [u32], Vec<Side>)>,
) -> Vec<(u32, Vec<Side>)> {
    let mut at: Vec<(u32, Side)> = Vec::new();
    for (line, sides) in lines {
        let ends = [line[0], line[line.len() - 1]];
        at.extend(sides.into_iter().flat_map(|side| ends.map(|end| (end, side))));
    }
    at.sort_unstable();
    at.dedup();
    let points = at.chunk_by(|a, b| a.0 == b.0);
    points.map(|at| (at[0].0, at.iter().map(|(_, side)| *side).collect())).collect()
}

/// Each side once: grains by number, then the exterior.
fn sides(sides: impl Iterator<Item = Side>) -> Vec<Side> {
    let mut sides: Vec<Side> = sides.collect();
    sides.sort_unstable();
    sides.dedup();
    sides
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

/// A number of points or grains as an id.
pub(super) fn point_id(count: usize) -> u32 {
    u32::try_from(count).expect("no more points than corners of triangles, which have 32-bit ids")
}
