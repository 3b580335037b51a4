//! A polycrystal's network as a file of any format.

use std::borrow::Cow;
use std::io::{self, Write};
use std::num::NonZeroU32;

use glam::DVec3;
use polycrystal::{Boundary, BoundaryId, Elements, Level, Mesh, Side};
use rayon::prelude::*;
use voronoi::{Dimension, PeriodicPair};

use super::measured_arrays::MeasuredArrays;
use super::surface::Surface;
use crate::mesh::normal::unit_normal;
use crate::names::{
    CONFIG, CRYSTAL_SYMMETRIES, MOBILITY, NUMBER_OF_GRAINS, PERIODS, PHASE_NAMES, SEED_ID, TENSION,
};
use crate::volume_mesh::element_nodes::ElementNodes;
use crate::vtk::write_vtk;
use crate::vtk::{Array, Cells, DataArray, FieldEntry, FieldValue, ItemTuples, PolyData, Values, VtkFormat};
use crate::{
    GrainAttributes, GrainPhases, GrainTexture, LabelGrid, MeasuredAttributes, Names, Parents, Polycrystal,
    Provenance,
};

impl Polycrystal {
    /// Behind what formats without comments hold: who reads them stops before.
    pub(crate) fn write_settings_behind(&self, out: &mut dyn Write) -> io::Result<()> {
        write!(out, "\n{}", self.provenance().text())
    }

    pub(crate) fn surface(&self) -> io::Result<Surface<'_>> {
        Surface::network(self).ok_or_else(|| io::Error::other("boundaries in the plane are no surfaces"))
    }

    /// Whether formats that else hold boundaries are to hold elements that fill grains.
    pub(crate) fn writes_elements(&self) -> bool {
        self.file().volume.volume_mesh && (self.volume_mesh.is_some() || self.plane_mesh.is_some())
    }

    /// The points that are others moved by whole periods: those of a periodic network, or, where it was cut at its box, those on the upper sides.
    pub(crate) fn periodic_points(&self) -> io::Result<Vec<PeriodicPair<u32>>> {
        self.network.periodic_vertices(&self.points, self.axes_cut_at_box()).map_err(io::Error::other)
    }

    /// Elements that fill the grains, of the order that files are to hold, and which of their nodes are others moved by whole periods.
    pub(crate) fn elements(&self) -> io::Result<(ElementNodes<'_>, Vec<PeriodicPair<u32>>)> {
        let (linear, middles) = match (&self.volume_mesh, &self.plane_mesh) {
            (Some(mesh), _) => (ElementNodes::from(mesh), &mesh.middles),
            (None, Some(filled)) => (ElementNodes::from(&filled.mesh), &filled.mesh.middles),
            (None, None) => {
                return Err(io::Error::other(
                    "the grains are not filled; call `Polycrystal::remeshed` and `Polycrystal::filled` first",
                ));
            }
        };
        let mut pairs = self.periodic_points()?;
        if self.file().volume.order != Some(2) {
            return Ok((linear, pairs));
        }
        let elements = linear.quadratic(middles);
        elements.tie_middles(&self.network, &mut pairs);
        Ok((elements, pairs))
    }

    pub(crate) fn texture(&self) -> io::Result<&GrainTexture> {
        self.grains().texture.as_ref().ok_or_else(|| io::Error::other("the grains have no orientations"))
    }

    /// As many voxels as are asked for, else those of the map that the grains come from.
    pub(crate) fn label_grid(&self) -> io::Result<LabelGrid<'_>> {
        let voxels = self.file().voxels.or_else(|| self.voxels_of_map());
        Ok(LabelGrid::new(self, voxels.ok_or_else(|| io::Error::other("no number of voxels is given"))?))
    }

    /// Number of voxels along each axis of the map that the grains come from.
    pub(crate) fn voxels_of_map(&self) -> Option<[NonZeroU32; 3]> {
        let [x, y, z] = self.measurement()?.map.as_ref()?.shape;
        let count = |count: usize| u32::try_from(count).ok().and_then(NonZeroU32::new);
        Some([count(x)?, count(y)?, count(z)?])
    }

    pub(crate) fn write_vtk(&self, format: VtkFormat, out: &mut dyn Write) -> io::Result<()> {
        let level = self.network.finest();
        let (boundaries, names) = (self.network.boundaries(), self.file().names);
        let elements = level.elements();
        let (polylines, boundaries_of_lines) = boundary_polylines(level.held(), boundaries, names);
        let boundary_of = |cell: usize| match boundaries_of_lines.get(cell) {
            Some(boundary) => boundary.index(),
            None => level.boundary(id(cell)).index(),
        };
        let is_reversed: Vec<bool> = boundaries.iter().map(|boundary| names.reverses(boundary)).collect();
        let triangle = |cell: usize| {
            let corners = elements.corners(id(cell));
            let [a, b, c] = [0, 1, 2].map(|k| corners[k]);
            if is_reversed[boundary_of(cell)] { [a, c, b] } else { [a, b, c] }
        };
        let of_arrays: Vec<[u32; 3]> = match elements.dimension() {
            Dimension::Three if self.file().arrays => {
                (0..elements.len()).into_par_iter().map(triangle).collect()
            }
            _ => Vec::new(),
        };
        let cells = match elements {
            Elements::Segments(_) => Cells::Polylines(&polylines),
            _ if self.file().arrays => Cells::Triangles(&of_arrays),
            Elements::Triangles(triangles) if !is_reversed.contains(&true) => Cells::Triangles(triangles),
            _ => Cells::TrianglesOf { count: elements.len(), triangle: &triangle },
        };
        let count = cells.len();
        let labels: Vec<[i32; 2]> = boundaries.iter().map(|boundary| names.labels(boundary)).collect();
        let repeats = self.network.domain().is_periodic();
        let originals = if repeats { self.originals() } else { Vec::new() };
        let boundary_tuples = self.boundary_tuples();
        let normals = unit_normals(&self.points, &of_arrays);
        let measured = self.file().arrays.then(|| {
            let boundary_of_cell: Vec<BoundaryId> =
                (0..count).map(|cell| BoundaryId(id(boundary_of(cell)))).collect();
            let measured = MeasuredArrays::new(self, cells);
            (measured.of_cells(&boundary_of_cell), measured.of_points())
        });
        let (of_cells, of_points) = measured.unwrap_or_default();
        let points = self.points.len();
        // Boundaries and points are far fewer than 2^31: edges have two directions with 32-bit ids. There are fewer than 128 levels.
        let mut point_arrays = vec![
            Array { name: "NodeTypes", values: Values::each(points, |point| level.node_type(point).code()) },
            Array {
                name: "Generation",
                values: Values::each(points, |point| level.generation(point).cast_signed()),
            },
            Array { name: NUMBER_OF_GRAINS, values: Values::each(points, |point| level.grain_count(point)) },
        ];
        let boundary_id = |cell: usize| id(boundary_of(cell)).cast_signed();
        let mut cell_arrays = vec![
            Array { name: names.sides(), values: Values::each(count, |cell| labels[boundary_of(cell)]) },
            Array { name: "BoundaryId", values: Values::each(count, boundary_id) },
        ];
        if repeats {
            let neighbor = |cell: usize| self.periodic_neighbor(&boundaries[boundary_of(cell)]);
            cell_arrays.push(Array { name: "PeriodicNeighbor", values: Values::each(count, neighbor) });
            point_arrays.push(Array { name: "PeriodicOriginal", values: Values::slice(&originals) });
        }
        let boundary = |cell: usize| Some(boundary_of(cell));
        cell_arrays.extend(boundary_tuples.iter().map(|tuples| tuples.of_cells(count, boundary)));
        if !normals.is_empty() {
            cell_arrays.push(Array { name: "Normals", values: Values::slice(&normals) });
        }
        cell_arrays.extend(of_cells.iter().map(DataArray::array));
        point_arrays.extend(of_points.iter().map(DataArray::array));
        // Small changes of the points are seen in these only, which validation has found the grains to have.
        let volumes = FieldValue::Numbers(self.network.cell_volumes().to_vec());
        let mut field = self.field();
        field.push(FieldEntry { name: "Volumes", value: volumes });
        field.push(self.seed_ids());
        field.extend(self.grain_fields());
        let data = PolyData { points: &self.points, cells, point_arrays, cell_arrays, field };
        write_vtk(&data, format, self.file().encoding, out)
    }

    /// What files hold of each grain's parent, phase, measured attributes and orientation, where it has them.
    pub(crate) fn grain_tuples(&self) -> Vec<ItemTuples> {
        let names = self.file().names;
        let GrainAttributes { parents, phases, texture, measured, .. } = self.grains();
        let mut tuples: Vec<ItemTuples> = parents.iter().map(Parents::array).collect();
        tuples.extend(phases.iter().map(GrainPhases::array));
        tuples.extend(measured.iter().flat_map(MeasuredAttributes::arrays));
        if let Some(texture) = texture {
            tuples.extend(texture.orientation_arrays().into_iter().chain(texture.color_arrays(names)));
        }
        tuples
    }

    /// What files hold of each boundary's disorientation, where grains have orientations, and of its tension, where laws are asked for.
    pub(crate) fn boundary_tuples(&self) -> Vec<ItemTuples> {
        let boundaries = self.network.boundaries();
        let sides = || boundaries.iter().map(|boundary| boundary.sides_across(boundaries));
        let texture = self.grains().texture.as_ref();
        let mut tuples = texture.map_or_else(Vec::new, |texture| texture.boundary_arrays(sides()));
        if self.tensions.is_some() {
            tuples.push(ItemTuples::new(TENSION, self.network.tensions().iter().map(|tension| [*tension])));
        }
        if self.mobilities.is_some() {
            let mobilities = self.network.mobilities().iter();
            tuples.push(ItemTuples::new(MOBILITY, mobilities.map(|mobility| [*mobility])));
        }
        tuples
    }

    /// The number of the grain that lies beyond a boundary a period or more away; that of the exterior where there is none.
    fn periodic_neighbor(&self, boundary: &Boundary) -> i32 {
        let twin = boundary.twin.map(|twin| self.network.boundaries()[twin.boundary.index()].sides[0]);
        self.file().names.side_number(twin.unwrap_or(Side::Exterior))
    }

    /// Of each point, the one that it is a copy of, or itself.
    pub(crate) fn originals(&self) -> Vec<i32> {
        self.network.finest().originals().into_iter().map(u32::cast_signed).collect()
    }

    /// The number of each grain's seed.
    pub(crate) fn seed_ids(&self) -> FieldEntry {
        let ids = self.grains().ids.iter().map(|id| id.cast_signed()).collect();
        FieldEntry { name: SEED_ID, value: FieldValue::Ids(ids) }
    }

    /// The parent, the phase, measured attributes and the orientation of each grain, where they have them.
    pub(crate) fn grain_fields(&self) -> impl Iterator<Item = FieldEntry> {
        let GrainAttributes { parents, phases, texture, measured, .. } = self.grains();
        let arrays = texture.as_ref().map(GrainTexture::orientation_arrays);
        let entry = |tuples: ItemTuples| FieldEntry { name: tuples.name, value: FieldValue::Items(tuples) };
        let whole = parents.iter().map(Parents::array).chain(phases.iter().map(GrainPhases::array));
        let measured = measured.iter().flat_map(MeasuredAttributes::arrays);
        whole.chain(measured).chain(arrays.into_iter().flatten()).map(entry)
    }

    /// What every VTK file says about itself.
    pub(crate) fn field(&self) -> Vec<FieldEntry> {
        let provenance = self.provenance();
        let mut field = vec![
            text("Version", format!("grainsmooth {}", env!("CARGO_PKG_VERSION"))),
            text("CommandLine", provenance.command_line().into_owned()),
        ];
        if let Provenance::Config(config) = provenance {
            field.push(text(CONFIG, config.to_toml()));
            field.push(FieldEntry { name: "RandomSeed", value: FieldValue::Integer(config.random_seed) });
        }
        let grains = self.grains();
        if let Some(phases) = &grains.phases {
            field.push(text(PHASE_NAMES, phases.names().collect::<Vec<_>>().join(",")));
        }
        if grains.phases.is_some() || grains.texture.is_some() {
            let symmetries = grains.named_symmetries().into_iter();
            let symmetries: Vec<&str> = symmetries.map(|(_, symmetry)| symmetry.rotation_group()).collect();
            field.push(text(CRYSTAL_SYMMETRIES, symmetries.join(",")));
        }
        let domain = self.network.domain();
        let repeats = domain.periodic() | self.axes_cut_at_box();
        if repeats.any() {
            let periods = DVec3::select(repeats, domain.size(), DVec3::ZERO);
            field.push(FieldEntry { name: PERIODS, value: FieldValue::Numbers(periods.to_array().to_vec()) });
        }
        field
    }
}

/// The triangles, wound as a scheme of names wants them.
pub(crate) fn triangles<'a>(level: &'a Level, boundaries: &[Boundary], names: Names) -> Cow<'a, [[u32; 3]]> {
    let Mesh::Triangles(mesh) = &level.mesh else { return Cow::default() };
    if !boundaries.iter().any(|boundary| names.reverses(boundary)) {
        return Cow::Borrowed(mesh.triangles());
    }
    let numbered = mesh.triangles().iter().zip(&level.boundary_of);
    let wound =
        numbered.map(
            |(&[a, b, c], boundary)| {
                if names.reverses(&boundaries[boundary.index()]) { [a, c, b] } else { [a, b, c] }
            },
        );
    wound.collect()
}

/// The unit normal of each triangle. Points cannot have them: where boundaries meet, each has another one.
fn unit_normals(points: &[DVec3], triangles: &[[u32; 3]]) -> Vec<DVec3> {
    let corners = |triangle: &[u32; 3]| triangle.map(|corner| points[corner as usize]);
    triangles.par_iter().map(|triangle| unit_normal(corners(triangle))).collect()
}

/// The polylines of each boundary, with its first side in a scheme of names on the left, and the boundaries in the same order.
///
/// Each boundary is one, but in a periodic network that was cut at the box.
pub(crate) fn boundary_polylines(
    level: &Level,
    boundaries: &[Boundary],
    names: Names,
) -> (Vec<Vec<u32>>, Vec<BoundaryId>) {
    let Mesh::Segments(mesh) = &level.mesh else { return (Vec::new(), Vec::new()) };
    let segments: Vec<(BoundaryId, [u32; 2])> =
        level.boundary_of.iter().copied().zip(mesh.segments().iter().copied()).collect();
    let connected = segments.chunk_by(|(a, [_, end]), (b, [start, _])| a == b && end == start);
    let polyline = |segments: &[(BoundaryId, [u32; 2])]| {
        let (boundary, [start, _]) = segments[0];
        let mut polyline = vec![start];
        polyline.extend(segments.iter().map(|(_, [_, end])| *end));
        if names.reverses(&boundaries[boundary.index()]) {
            polyline.reverse();
        }
        (polyline, boundary)
    };
    connected.map(polyline).unzip()
}

/// The number of a cell or a boundary as an id.
fn id(number: usize) -> u32 {
    u32::try_from(number).expect("ids fit 32 bits")
}

fn text(name: &'static str, value: String) -> FieldEntry {
    FieldEntry { name, value: FieldValue::Text(value) }
}
