//! A polycrystal as VTK data.

use polycrystal::{Boundary, BoundaryId, Level, Mesh, Side};

use crate::vtk::{Array, Cells, FieldEntry, FieldValue, PolyData, Values, write_vtk};
use crate::{Error, Output, Polycrystal};

impl Polycrystal {
    /// Writes the finest level: every boundary once, every shared point once.
    ///
    /// Cell arrays `FaceLabels` (the two sides: grains from 0, the exterior is -1) and `BoundaryId`; point arrays `NodeTypes`
    /// (DREAM.3D's codes) and `Generation`. Normals point from the first to the second side. In 2D the cells are the boundaries'
    /// polylines, with their first side on the left.
    ///
    /// Grains of a periodic domain are whole. A boundary between grains a period apart comes at both; its second label is -2 - b
    /// with the `BoundaryId` b of the other one. The cell array `PeriodicNeighbor` has the grain there (-1 elsewhere), the
    /// point array `PeriodicOriginal` the point that each is a copy of, its own number where it is none.
    ///
    /// # Errors
    /// [`Error::WriteOutput`]; nothing is left behind then.
    pub fn write(&self, output: &Output) -> Result<(), Error> {
        let level = self.network.finest();
        let node_types: Vec<i8> = level.node_types.iter().map(|node_type| node_type.code()).collect();
        let generations: Vec<i8> = level.generations.iter().map(|g| g.cast_signed()).collect();
        let polylines;
        let (cells, boundary_of) = match &level.mesh {
            Mesh::Triangles(mesh) => (Cells::Triangles(mesh.triangles()), level.boundary_of.clone()),
            Mesh::Segments(_) => {
                let ids;
                (polylines, ids) = boundary_polylines(level);
                (Cells::Polylines(&polylines), ids)
            }
        };
        let boundary_ids: Vec<i32> = boundary_of.iter().map(|boundary| signed(boundary.0)).collect();
        let labels: Vec<[i32; 2]> = self.network.boundaries().iter().map(face_labels).collect();
        let face_labels: Vec<[i32; 2]> =
            boundary_of.iter().map(|boundary| labels[boundary.index()]).collect();
        let mut point_arrays = vec![
            Array { name: "NodeTypes", values: Values::Int8(&node_types) },
            Array { name: "Generation", values: Values::Int8(&generations) },
        ];
        let mut cell_arrays = vec![
            Array { name: "FaceLabels", values: Values::Int32Pairs(&face_labels) },
            Array { name: "BoundaryId", values: Values::Int32(&boundary_ids) },
        ];
        let (neighbors, originals);
        if self.network.domain().is_periodic() {
            (neighbors, originals) = (self.periodic_neighbors(&boundary_of), self.originals());
            cell_arrays.push(Array { name: "PeriodicNeighbor", values: Values::Int32(&neighbors) });
            point_arrays.push(Array { name: "PeriodicOriginal", values: Values::Int32(&originals) });
        }
        let data = PolyData {
            points: &self.points,
            cells,
            point_arrays,
            cell_arrays,
            field: vec![
                text("Version", format!("grainsmooth {}", env!("CARGO_PKG_VERSION"))),
                text("CommandLine", self.config.command_line()),
                FieldEntry { name: "RandomSeed", value: FieldValue::Integer(self.config.random_seed) },
            ],
        };
        output.write(|out| write_vtk(&data, output.format(), out))
    }

    /// Of each cell, the grain that lies beyond it a period or more away; -1 where there is none.
    fn periodic_neighbors(&self, boundary_of: &[BoundaryId]) -> Vec<i32> {
        let boundaries = self.network.boundaries();
        let beyond =
            |boundary: &Boundary| boundary.twin.map(|twin| boundaries[twin.boundary.index()].sides[0]);
        let neighbor = |boundary: &BoundaryId| match beyond(&boundaries[boundary.index()]) {
            Some(Side::Grain(grain)) => signed(grain.0),
            Some(Side::Exterior) | None => -1,
        };
        boundary_of.iter().map(neighbor).collect()
    }

    /// Of each point, the one that it is a copy of, or itself.
    fn originals(&self) -> Vec<i32> {
        let level = self.network.finest();
        let mut originals: Vec<i32> = (0..).take(level.vertex_count()).collect();
        for pair in &level.copies.vertices {
            originals[pair.secondary as usize] = signed(pair.primary);
        }
        originals
    }
}

/// One polyline for each boundary, and the boundaries in the same order.
fn boundary_polylines(level: &Level) -> (Vec<Vec<u32>>, Vec<BoundaryId>) {
    let Mesh::Segments(mesh) = &level.mesh else { return (Vec::new(), Vec::new()) };
    let segments: Vec<(BoundaryId, [u32; 2])> =
        level.boundary_of.iter().copied().zip(mesh.segments().iter().copied()).collect();
    // Refinement keeps a boundary's segments together and in order.
    let boundaries = segments.chunk_by(|a, b| a.0 == b.0);
    let polyline = |segments: &[(BoundaryId, [u32; 2])]| {
        let mut polyline = vec![segments[0].1[0]];
        polyline.extend(segments.iter().map(|(_, [_, end])| *end));
        (polyline, segments[0].0)
    };
    boundaries.map(polyline).unzip()
}

fn face_labels(boundary: &Boundary) -> [i32; 2] {
    boundary.sides.map(|side| match side {
        Side::Grain(grain) => signed(grain.0),
        Side::Exterior => boundary.twin.map_or(-1, |twin| -2 - signed(twin.boundary.0)),
    })
}

/// Grains and boundaries are far fewer than 2^31, for each has many triangles and those have 32-bit ids; so are points.
fn signed(id: u32) -> i32 {
    i32::try_from(id).expect("fewer grains and boundaries than 2^31")
}

fn text(name: &'static str, value: String) -> FieldEntry {
    FieldEntry { name, value: FieldValue::Text(value) }
}
