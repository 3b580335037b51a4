//! Neper's tessellation file, version 3.5: the flat cells, before any relaxation.
//!
//! <https://neper.info/doc/fileformat.html>. Neper counts from 1; here everything counts from 0.

use std::collections::BTreeMap;
use std::io;

use glam::DVec3;
use voronoi::{CellId, Dimension, Side, Translation};

use super::format::{Content, Extra, Format, TEXT_CORNERS, TEXT_POINT, Writer};
use crate::input::tess::{
    Oriented, POLYHEDRON, Tess, TessCopy, TessDomain, TessFace, TessPeriodicity, TessSeed,
};
use crate::run::tessellated::Tessellated;

mod write;

use write::write;

/// The flat cells. Of a Poisson-Voronoi cell's share there are 7 vertices, 14 edges and 8 faces of three lines.
pub(super) const FORMAT: Format = Format {
    extension: "tess",
    content: Content::Cells,
    bytes: |size| size.grains * (7 * TEXT_POINT + 14 * TEXT_CORNERS + 8 * 150),
    write: Writer::File(|polycrystal, out| {
        let synthesis =
            polycrystal.synthesis().ok_or_else(|| io::Error::other("the grains come from no cells"))?;
        write(&Tess::new(&synthesis.cells), polycrystal.grains().texture.as_ref(), out)?;
        polycrystal.write_settings_behind(out)
    }),
    extra: Extra { programs: "Neper", ..Extra::NONE },
};

impl Tess {
    /// The flat cells of a run.
    pub fn new(cells: &Tessellated) -> Self {
        let tessellation = &cells.tessellation;
        let domain = tessellation.domain();
        let (kind, wall_count) = match domain.dimension() {
            _ if !domain.is_box() => (POLYHEDRON, domain.walls().count()),
            Dimension::Two => ("square", 4),
            Dimension::Three => ("cube", 6),
        };
        let mut walls = vec![Vec::new(); wall_count];
        for face in tessellation.faces() {
            if let Side::Wall(wall) = tessellation.face_sides(face)[1] {
                walls[wall.index()].push(face.0);
            }
        }
        if !domain.is_box() {
            // A file ends with the last wall that bounds something.
            while walls.pop_if(|faces| faces.is_empty()).is_some() {}
        }
        // The same number added to all weights leaves the cells as they are, and radii need weights that are not negative.
        let least = cells.weights.iter().copied().fold(0.0, f64::min);
        let seed = |position, weight: &f64| TessSeed { position, radius: (weight - least).sqrt() };
        let seeds = tessellation.seeds().iter().zip(&cells.weights);
        let mut tess = Self {
            dimension: domain.dimension(),
            ids: cells.grains.renumbered().to_vec(),
            groups: match &cells.grains.phases {
                Some(phases) => {
                    (0..tessellation.cell_count()).map(|cell| phases.number(cell).cast_unsigned()).collect()
                }
                None => Vec::new(),
            },
            has_orientations: false,
            orientations: Vec::new(),
            crystal_symmetry: None,
            seeds: seeds.map(|(&position, weight)| seed(position, weight)).collect(),
            vertices: tessellation.vertices().to_vec(),
            edges: Vec::new(),
            faces: Vec::new(),
            polyhedra: Vec::new(),
            domain: TessDomain { kind: kind.to_owned(), lower: domain.lower(), upper: domain.upper(), walls },
            periodicity: None,
        };
        match tess.dimension {
            Dimension::Three => tess.fill_space(cells),
            Dimension::Two => tess.fill_plane(cells),
        }
        if domain.is_periodic() {
            tess.periodicity = Some(TessPeriodicity::new(cells, &tess));
        }
        tess
    }

    fn fill_space(&mut self, cells: &Tessellated) {
        let tessellation = &cells.tessellation;
        let edges = tessellation.edges();
        self.edges = edges.ends.iter().map(|ends| ends.map(|vertex| vertex.0)).collect();
        let mut next_edge = edges.of_corner.iter();
        for face in tessellation.faces() {
            let vertices: Vec<u32> = tessellation.face_corners(face).iter().map(|corner| corner.0).collect();
            let of_face = vertices.iter().zip(&mut next_edge);
            let edges = of_face.map(|(&corner, &index)| Oriented {
                index,
                is_reversed: self.edges[index as usize][0] != corner,
            });
            let edges = edges.collect();
            let plane = plane(vertices.iter().map(|&corner| self.vertices[corner as usize]));
            self.faces.push(TessFace { vertices, edges, plane });
        }
        let cells = (0u32..).take(tessellation.cell_count()).map(CellId);
        self.polyhedra = cells
            .map(|cell| {
                let is_reversed = |face| tessellation.face_sides(face)[0] != Side::Cell(cell);
                let faces = tessellation.cell_faces(cell).iter();
                faces.map(|&face| Oriented { index: face.0, is_reversed: is_reversed(face) }).collect()
            })
            .collect();
    }

    fn fill_plane(&mut self, cells: &Tessellated) {
        let tessellation = &cells.tessellation;
        let ends = |face| {
            let corners = tessellation.face_corners(face);
            [corners[0].0, corners[1].0]
        };
        self.edges = tessellation.faces().map(ends).collect();
        for cell in (0u32..).take(tessellation.cell_count()).map(CellId) {
            // Around the cell counter-clockwise: from each corner, the edge to the next and that corner.
            let mut next = BTreeMap::new();
            for &face in tessellation.cell_faces(cell) {
                let is_reversed = tessellation.face_sides(face)[0] != Side::Cell(cell);
                let [start, end] = ends(face);
                let (start, end) = if is_reversed { (end, start) } else { (start, end) };
                next.insert(start, (end, Oriented { index: face.0, is_reversed }));
            }
            let mut face = TessFace { vertices: Vec::new(), edges: Vec::new(), plane: [0.0, 0.0, 0.0, 1.0] };
            let mut corner = next.keys().next().copied();
            while let Some(start) = corner
                && let Some((end, edge)) = next.remove(&start)
            {
                face.vertices.push(start);
                face.edges.push(edge);
                corner = Some(end);
            }
            self.faces.push(face);
        }
    }
}

impl TessPeriodicity {
    fn new(cells: &Tessellated, tess: &Tess) -> Self {
        let tessellation = &cells.tessellation;
        let domain = tessellation.domain();
        let axes: [bool; 3] = domain.periodic().into();
        let range = |axis: usize| if axes[axis] { -1..=1 } else { 0..=0 };
        let mut seeds = Vec::new();
        for z in range(2) {
            for y in range(1) {
                for x in range(0).filter(|x| [*x, y, z] != [0; 3]) {
                    seeds.extend((0u32..).take(tessellation.cell_count()).map(|cell| (cell, [x, y, z])));
                }
            }
        }
        let copy = |secondary, index, is_reversed, translation: Translation| TessCopy {
            secondary,
            primary: Oriented { index, is_reversed },
            translation: translation.0.map(i32::from),
        };
        let pairs = tessellation.periodic_vertices();
        let vertices: Vec<TessCopy> = pairs
            .iter()
            .map(|pair| copy(pair.secondary.0, pair.primary.0, false, pair.translation))
            .collect();
        let primary_of = |vertex: u32| {
            let place = vertices.binary_search_by_key(&vertex, |copy| copy.secondary);
            place.map_or(vertex, |place| vertices[place].primary.index)
        };
        // Copies of an edge may run the other way, as both begin at the vertex with the smaller number.
        let runs_back = |secondary: u32, primary: u32| {
            let [secondary, primary] =
                [secondary, primary].map(|edge| tess.edges[edge as usize].map(primary_of));
            secondary != primary
        };
        let edges = tessellation.periodic_edges(&tessellation.edges());
        let faces = tessellation.periodic_faces();
        let (edges, faces) = match tess.dimension {
            Dimension::Three => (
                edges
                    .iter()
                    .map(|pair| {
                        let is_reversed = runs_back(pair.secondary, pair.primary);
                        copy(pair.secondary, pair.primary, is_reversed, pair.translation)
                    })
                    .collect(),
                faces
                    .iter()
                    .map(|pair| copy(pair.secondary.0, pair.primary.0, true, pair.translation))
                    .collect(),
            ),
            // The edges of the plane are its boundaries, whose copies are reversed.
            Dimension::Two => (
                faces
                    .iter()
                    .map(|pair| copy(pair.secondary.0, pair.primary.0, true, pair.translation))
                    .collect(),
                Vec::new(),
            ),
        };
        Self { axes, lengths: domain.size(), seeds, vertices, edges, faces }
    }
}

/// The plane of a polygon by Newell's formula, about its first corner so that none of its digits cancel.
fn plane(corners: impl Iterator<Item = DVec3>) -> [f64; 4] {
    let corners: Vec<DVec3> = corners.collect();
    let at = |k: usize| corners[k % corners.len()] - corners[0];
    let normal: DVec3 = (0..corners.len()).map(|k| at(k).cross(at(k + 1))).sum();
    let normal = normal.normalize_or_zero();
    [normal.dot(corners[0]), normal.x, normal.y, normal.z]
}
