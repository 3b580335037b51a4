//! How the control mesh divides triple lines and boundaries.

use cancellation::check_cancelled;
use glam::DVec3;
use rayon::prelude::*;
use voronoi::{
    Dimension, Edges, FaceId, PeriodicPair, Tessellation, Translation, VertexId, triangulate_polygon,
};

use crate::mesh::id::id;
use crate::network::fan::{Fan, outline_center};

/// Fewest segments of a triple line: one middle, so that every line can curve.
pub(crate) const FEWEST_SEGMENTS: u32 = 2;

/// Length, in units of the mean size of cells, below which a sparse fan leaves a triple line whole: halves would make needles of
/// the triangles from there to the centres of its boundaries. Levels of subdivision divide and curve it all the same.
const SHORT_LINE: f64 = 0.25;

/// One in so many sparse fans of random cells gets one more centre.
const FANS_PER_CENTER: u32 = 2;

/// Triangles of a refined boundary, in units of equilateral triangles of the edge length; about 2 is usual.
const REFINED_TRIANGLES: f64 = 3.0;

/// The control points of a boundary, beside the vertices at its corners.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum FaceMesh {
    /// The middles of its triple lines, and a fan of triangles from its centre: VirMat's control points.
    #[default]
    Fan,
    /// The same with better triangles, for cells that are regularised: in space, lines shorter than a quarter of the mean size of
    /// cells have no middle, and a boundary in which a fan has angles below 20 degrees gets up to two more centres.
    SparseFan,
    /// The middles of its triple lines alone; no point inside (constrained Delaunay triangulation), unless an edge would be that
    /// of another boundary too.
    Plain,
    /// Points on triple lines and inside, so that no edge is longer than `edge_length` and, where the outline allows, no angle
    /// is below 25 degrees.
    ///
    /// Lines are divided first, into equal parts and at least in two, for all their boundaries at once. A boundary
    /// that needs no point inside gets the fan, unless it is a sliver in which the fan has longer edges. So does one in which
    /// rounding leaves triangles no area, as beside a line of 1e-8 of its size: there edges from the centre may be longer.
    Refined {
        /// In the unit of the domain.
        edge_length: f64,
    },
}

/// A number of points, edges and triangles (in the plane: 0 triangles).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MeshSize {
    /// Number of points.
    pub points: u128,
    /// Number of edges; in the plane, of segments.
    pub edges: u128,
    /// Number of triangles.
    pub triangles: u128,
}

impl FaceMesh {
    /// The size of a tessellation's control mesh; estimated for boundaries that are refined, and for more centres than one.
    pub fn control_mesh_size(self, tessellation: &Tessellation) -> MeshSize {
        let vertices = tessellation.vertices();
        let short = self.short_line(tessellation);
        let count = |ends: [VertexId; 2]| {
            u128::from(self.segment_count(ends.map(|end| vertices[end.index()]), short))
        };
        let vertex_count = vertices.len() as u128;
        if tessellation.domain().dimension() == Dimension::Two {
            let ends = |face| <[VertexId; 2]>::try_from(tessellation.face_corners(face)).expect("two ends");
            let edges: u128 = tessellation.faces().map(|face| count(ends(face))).sum();
            return MeshSize {
                points: vertex_count + edges - tessellation.face_count() as u128,
                edges,
                triangles: 0,
            };
        }
        let lines = tessellation.edges();
        let segments: u128 = lines.ends.iter().map(|ends| count(*ends)).sum();
        let mut corner_edges = lines.of_corner.iter();
        let (mut inner, mut inner_edges, mut triangles) = (0, 0, 0);
        for face in tessellation.faces() {
            let corners = tessellation.face_corners(face);
            let of_face = corner_edges.by_ref().take(corners.len());
            let outline: u128 = of_face.map(|edge| count(lines.ends[*edge as usize])).sum();
            let (more_points, more_triangles) = match self {
                Self::Fan => (1, outline),
                Self::SparseFan => {
                    let centers = 1 + u128::from(face.0 % FANS_PER_CENTER == 0);
                    (centers, outline + 2 * (centers - 1))
                }
                Self::Plain => (0, outline - 2),
                Self::Refined { edge_length } => {
                    let equilateral = 3f64.sqrt() / 4.0 * edge_length * edge_length;
                    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates")]
                    let inner =
                        1 + (REFINED_TRIANGLES / 2.0 * area(tessellation, face) / equilateral) as u128;
                    (inner, outline + 2 * inner - 2)
                }
            };
            inner += more_points;
            // Each has a triangle on either side, and each of the outline one within the face.
            inner_edges += (3 * more_triangles - outline) / 2;
            triangles += more_triangles;
        }
        let points = vertex_count + segments - lines.ends.len() as u128 + inner;
        MeshSize { points, edges: segments + inner_edges, triangles }
    }

    /// The length below which lines stay whole.
    fn short_line(self, tessellation: &Tessellation) -> f64 {
        match (self, tessellation.domain().dimension()) {
            (Self::SparseFan, dimension @ Dimension::Three) => {
                let mean_volume = tessellation.domain().measure() / tessellation.cell_count() as f64;
                SHORT_LINE * dimension.cube_edge(mean_volume)
            }
            _ => 0.0,
        }
    }

    fn segment_count(self, [start, end]: [DVec3; 2], short: f64) -> u32 {
        match self {
            Self::SparseFan if start.distance(end) < short => 1,
            Self::Fan | Self::SparseFan | Self::Plain => FEWEST_SEGMENTS,
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates")]
            Self::Refined { edge_length } => {
                ((start.distance(end) / edge_length).ceil() as u32).max(FEWEST_SEGMENTS)
            }
        }
    }
}

/// The points between two ends that divide the line into so many equal segments.
fn divide([start, end]: [DVec3; 2], count: u32) -> impl Iterator<Item = DVec3> {
    (1..count).map(move |k| {
        if 2 * k == count { start.midpoint(end) } else { start.lerp(end, f64::from(k) / f64::from(count)) }
    })
}

/// The area of a planar face.
fn area(tessellation: &Tessellation, face: FaceId) -> f64 {
    let corners = tessellation.face_corners(face);
    let at =
        |k: usize| tessellation.vertices()[corners[k].index()] - tessellation.vertices()[corners[0].index()];
    let doubled: DVec3 = (2..corners.len()).map(|k| at(k - 1).cross(at(k))).sum();
    doubled.length() / 2.0
}

/// The inner points of all triple lines, numbered after the tessellation's vertices.
pub(crate) struct LinePoints {
    /// Of line e, inner points `starts[e]..starts[e + 1]`, from the first of its ends.
    starts: Vec<u32>,
    pub(crate) positions: Vec<DVec3>,
}

impl LinePoints {
    /// Divides all lines, copied ones as their originals.
    pub(crate) fn new(
        tessellation: &Tessellation,
        lines: &[[VertexId; 2]],
        copied_lines: &[PeriodicPair<u32>],
        face_mesh: FaceMesh,
    ) -> Self {
        let ends_at = |line: usize| lines[line].map(|end| tessellation.vertices()[end.index()]);
        let short = face_mesh.short_line(tessellation);
        let mut counts: Vec<u32> =
            (0..lines.len()).map(|line| face_mesh.segment_count(ends_at(line), short)).collect();
        for pair in copied_lines {
            counts[pair.secondary as usize] = counts[pair.primary as usize];
        }
        Self::of_counts(tessellation, lines, &counts)
    }

    /// Divides each line into so many equal parts.
    pub(crate) fn of_counts(tessellation: &Tessellation, lines: &[[VertexId; 2]], counts: &[u32]) -> Self {
        let ends_at = |line: usize| lines[line].map(|end| tessellation.vertices()[end.index()]);
        let first = id(tessellation.vertices().len());
        let mut points = Self { starts: vec![first], positions: Vec::with_capacity(lines.len()) };
        for (line, count) in counts.iter().enumerate() {
            points.positions.extend(divide(ends_at(line), *count));
            points.starts.push(first + id(points.positions.len()));
        }
        points
    }

    /// The inner points of copied lines as copies.
    pub(crate) fn copies(
        &self,
        tessellation: &Tessellation,
        lines: &[[VertexId; 2]],
        copied_lines: &[PeriodicPair<u32>],
    ) -> Vec<PeriodicPair<u32>> {
        let place = |vertex: VertexId| {
            let pairs = tessellation.periodic_vertices();
            match pairs.binary_search_by_key(&vertex, |pair| pair.secondary) {
                Ok(found) => (pairs[found].primary, pairs[found].translation),
                Err(_) => (vertex, Translation::ZERO),
            }
        };
        let of_pair = |&PeriodicPair { secondary, primary, translation }: &PeriodicPair<u32>| {
            let [(vertex, at), (original, original_at)] =
                [secondary, primary].map(|line| place(lines[line as usize][0]));
            let is_along = (vertex, at) == (original, original_at + translation);
            let (own, other) = (self.of_line(secondary), self.of_line(primary));
            let count = other.end - other.start;
            (0..count).map(move |k| {
                let matching = if is_along { k } else { count - 1 - k };
                PeriodicPair { secondary: own.start + k, primary: other.start + matching, translation }
            })
        };
        copied_lines.iter().flat_map(of_pair).collect()
    }

    /// The inner points of a line.
    pub(crate) fn of_line(&self, line: u32) -> std::ops::Range<u32> {
        self.starts[line as usize]..self.starts[line as usize + 1]
    }

    /// The line of each point.
    pub(crate) fn lines(&self) -> impl Iterator<Item = usize> {
        let counts = self.starts.windows(2).map(|ends| (ends[1] - ends[0]) as usize);
        counts.enumerate().flat_map(|(line, count)| std::iter::repeat_n(line, count))
    }

    /// All points of a line, ends included.
    pub(crate) fn whole_line(&self, line: u32, ends: [VertexId; 2]) -> Vec<u32> {
        [ends[0].0].into_iter().chain(self.of_line(line)).chain([ends[1].0]).collect()
    }
}

/// One boundary's triangles.
pub(crate) struct FaceTriangles {
    /// Numbers of the points round the face.
    pub(crate) outline: Vec<u32>,
    /// The line that the segment from each point of the outline to the next is part of.
    pub(crate) lines: Vec<u32>,
    pub(crate) inner_points: Vec<DVec3>,
    /// Corners by their place in the outline and, after that, among the inner points.
    pub(crate) triangles: Vec<[u32; 3]>,
}

impl FaceTriangles {
    /// The triangles of a copy of the face, which winds the other way round, beginning at this one's last corner.
    fn turned_round(&self, last_corner: u32) -> Vec<[u32; 3]> {
        let count = id(self.outline.len());
        let start = self.outline.iter().position(|point| *point == last_corner);
        let start = id(start.expect("a corner is part of the outline"));
        let place = |old: u32| if old < count { (start + count - old) % count } else { old };
        self.triangles.iter().map(|&[a, b, c]| [a, c, b].map(place)).collect()
    }
}

/// Triangulates all faces, in parallel; copied ones as their originals. `points` are the tessellation's vertices and those on lines; `centers` are
/// places inside the faces from which their outlines are seen.
pub(crate) fn triangulate_faces(
    tessellation: &Tessellation,
    edges: &Edges,
    lines: &LinePoints,
    points: &[DVec3],
    face_mesh: FaceMesh,
    centers: Option<&[DVec3]>,
) -> Vec<FaceTriangles> {
    let mut first_corners = Vec::with_capacity(tessellation.face_count());
    let mut corner_count = 0;
    for face in tessellation.faces() {
        first_corners.push((face, corner_count));
        corner_count += tessellation.face_corners(face).len();
    }
    let triangulate = |(face, first): &(FaceId, usize)| {
        check_cancelled();
        let corners = tessellation.face_corners(*face);
        let (mut outline, mut lines_of) = (Vec::new(), Vec::new());
        for (corner, &line) in corners.iter().zip(&edges.of_corner[*first..]) {
            outline.push(corner.0);
            let inner = lines.of_line(line);
            if edges.ends[line as usize][0] == *corner {
                outline.extend(inner);
            } else {
                outline.extend(inner.rev());
            }
            lines_of.resize(outline.len(), line);
        }
        let center = centers.map(|centers| centers[face.index()]);
        let (inner_points, triangles) = fill(&outline, points, face_mesh, center);
        FaceTriangles { outline, lines: lines_of, inner_points, triangles }
    };
    let mut faces: Vec<FaceTriangles> = first_corners.par_iter().map(triangulate).collect();
    copy_faces(tessellation, &mut faces);
    let shared = faces_of_shared_chords(&faces);
    if !shared.is_empty() {
        let pairs = tessellation.periodic_faces().iter();
        let originals = pairs.filter(|pair| shared.binary_search(&pair.secondary.index()).is_ok());
        let originals: Vec<usize> = originals.map(|pair| pair.primary.index()).collect();
        for face in shared.into_iter().chain(originals) {
            let FaceTriangles { outline, inner_points, triangles, .. } = &mut faces[face];
            let center = centers.map(|centers| centers[face]);
            (*inner_points, *triangles) = fill(outline, points, FaceMesh::Fan, center);
        }
        copy_faces(tessellation, &mut faces);
    }
    faces
}

/// The faces in which two points of the outline are joined that another face joins too: as faces of regularised cells, which are not
/// flat, they may have several lines in common.
fn faces_of_shared_chords(faces: &[FaceTriangles]) -> Vec<usize> {
    let chords = |(number, face): (usize, &FaceTriangles)| {
        let count = id(face.outline.len());
        let is_chord = move |&[from, to]: &[u32; 2]| {
            from < to && to < count && to - from != 1 && !(from == 0 && to == count - 1)
        };
        let edges =
            face.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, a], [b, c], [c, b], [c, a], [a, c]]);
        let point = |place: u32| face.outline[place as usize];
        let ends = |[from, to]: [u32; 2]| [point(from).min(point(to)), point(from).max(point(to))];
        edges.filter(is_chord).map(|chord| (ends(chord), number)).collect::<Vec<_>>()
    };
    let mut chords: Vec<([u32; 2], usize)> = faces.par_iter().enumerate().flat_map_iter(chords).collect();
    chords.par_sort_unstable();
    chords.dedup();
    let shared = chords.chunk_by(|a, b| a.0 == b.0).filter(|at| at.len() > 1);
    let mut faces: Vec<usize> = shared.flatten().map(|(_, face)| *face).collect();
    faces.sort_unstable();
    faces.dedup();
    faces
}

/// Gives copied faces the triangles of their originals.
fn copy_faces(tessellation: &Tessellation, faces: &mut [FaceTriangles]) {
    for pair in tessellation.periodic_faces() {
        let (secondary, primary) = (pair.secondary.index(), pair.primary.index());
        let last_corner = tessellation.face_corners(pair.primary).last().expect("a face has corners").0;
        let translation = pair.translation.vector(tessellation.domain());
        let inner_points = faces[primary].inner_points.iter().map(|point| *point + translation).collect();
        faces[secondary].triangles = faces[primary].turned_round(last_corner);
        faces[secondary].inner_points = inner_points;
    }
}

fn fill(
    outline: &[u32],
    points: &[DVec3],
    face_mesh: FaceMesh,
    center: Option<DVec3>,
) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let positions: Vec<DVec3> = outline.iter().map(|point| points[*point as usize]).collect();
    let mesh = match face_mesh {
        FaceMesh::Fan | FaceMesh::SparseFan => None,
        FaceMesh::Plain => triangulate_polygon(&positions, None),
        FaceMesh::Refined { edge_length } => {
            let center = outline_center(&positions);
            let is_small = || positions.iter().all(|point| point.distance(center) <= edge_length);
            triangulate_polygon(&positions, Some(edge_length))
                .filter(|mesh| !(mesh.inner_points.is_empty() && is_small()))
        }
    };
    match mesh {
        Some(mesh) => (mesh.inner_points, mesh.triangles),
        // Also what rounding leaves no triangulation of: the centre of a sliver still sees all of its outline.
        None => {
            let mut fan = Fan::new(&positions);
            if let Some(center) = center {
                fan = fan.or_around(center);
            }
            if face_mesh == FaceMesh::SparseFan {
                fan.with_more_centers().into_mesh()
            } else {
                fan.into_mesh()
            }
        }
    }
}
