//! Networks of polylines, subdivided to cubic B-splines or by the four-point scheme.

use rayon::prelude::*;

use crate::ids::id;
use crate::mesh_checks::{check_size, check_vertex};
use crate::{EdgeId, MeshError, Point, Refinement, StencilTable, VertexRule};

/// A network of polylines that subdivision turns into smooth curves: cubic B-splines, or curves through the points; positions live
/// beside it as slices.
///
/// Curves run through vertices with exactly two segments. Every other vertex (an open end, a triple point, an unused
/// vertex) is a corner and stays where it is, as do the vertices marked as corners.
///
/// [`refine`](Self::refine) numbers by arithmetic. With V vertices, the vertex v stays v and the segment s gets the
/// vertex V + s; its halves are the segments 2 s (at its start) and 2 s + 1, both in the direction of s. So vertex
/// `v >= V` lies on segment `v - V`, and segment `s` is part of segment `s / 2`.
#[derive(Clone, Debug, PartialEq)]
pub struct CurveMesh {
    segments: Vec<[u32; 2]>,
    /// Per vertex: the two segments of a smooth vertex, nothing for a corner.
    curves: Vec<Option<[EdgeId; 2]>>,
}

impl CurveMesh {
    /// Connectivity of `segments` over `vertex_count` vertices.
    ///
    /// # Errors
    /// [`MeshError`] names the place: a vertex id out of range, a segment that starts where it ends, or more elements
    /// than 32-bit ids can count.
    pub fn new(vertex_count: usize, segments: Vec<[u32; 2]>, corners: &[u32]) -> Result<Self, MeshError> {
        check_size("vertices", vertex_count)?;
        check_size("segments", segments.len())?;
        let mut around: Vec<Vec<EdgeId>> = vec![Vec::new(); vertex_count];
        for (index, &[start, end]) in segments.iter().enumerate() {
            for vertex in [start, end] {
                check_vertex("segment", index, vertex, vertex_count)?;
                around[vertex as usize].push(EdgeId(id(index)));
            }
            if start == end {
                return Err(MeshError::Degenerate { what: "segment", index, vertex: start });
            }
        }
        let mut curves: Vec<Option<[EdgeId; 2]>> =
            around.into_iter().map(|segments| <[EdgeId; 2]>::try_from(segments).ok()).collect();
        for (index, &corner) in corners.iter().enumerate() {
            check_vertex("corner", index, corner, vertex_count)?;
            curves[corner as usize] = None;
        }
        Ok(Self { segments, curves })
    }

    /// Number of vertices, counting those that no segment uses.
    pub fn vertex_count(&self) -> usize {
        self.curves.len()
    }

    /// The two ends of each segment.
    pub fn segments(&self) -> &[[u32; 2]] {
        &self.segments
    }

    /// [`VertexRule::Smooth`] where a curve passes through, else [`VertexRule::Corner`].
    ///
    /// # Panics
    /// If there is no such vertex.
    pub fn vertex_rule(&self, v: u32) -> VertexRule {
        if self.curves[v as usize].is_some() { VertexRule::Smooth } else { VertexRule::Corner }
    }

    /// The two segments that meet in a smooth vertex; nothing at a corner.
    ///
    /// # Panics
    /// If there is no such vertex.
    pub fn vertex_segments(&self, v: u32) -> Option<[EdgeId; 2]> {
        self.curves[v as usize]
    }

    /// The two neighbours of a smooth vertex along its curve; nothing at a corner.
    ///
    /// # Panics
    /// If there is no such vertex.
    pub fn neighbours(&self, v: u32) -> Option<[u32; 2]> {
        self.curves[v as usize].map(|segments| segments.map(|segment| self.other_end(segment, v)))
    }

    /// One step of cubic B-spline subdivision: (1, 6, 1)/8 at smooth vertices, (1, 1)/2 on segments.
    ///
    /// ```
    /// use glam::DVec2;
    /// use subzero::CurveMesh;
    ///
    /// let square = CurveMesh::new(4, vec![[0, 1], [1, 2], [2, 3], [3, 0]], &[])?;
    /// let points = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
    /// let finer = square.refine()?.stencils.apply(&points);
    /// assert_eq!(finer[0], DVec2::splat(0.125), "(1, 6, 1)/8 of three points");
    /// assert_eq!(finer[4], DVec2::new(0.5, 0.), "the middle of the first segment");
    /// # Ok::<(), subzero::MeshError>(())
    /// ```
    ///
    /// # Errors
    /// [`MeshError::TooLarge`] if the finer network outgrows 32-bit ids.
    pub fn refine(&self) -> Result<Refinement<Self>, MeshError> {
        Ok(Refinement { mesh: self.refine_connectivity()?, stencils: self.stencils() })
    }

    /// One step of the interpolating four-point scheme (Dyn, Levin and Gregory 1987): vertices stay, and a segment gets 9/16 of its ends
    /// less 1/16 of the next vertices along the curve. Where it does not go on, the next vertex is the other end's reflection in
    /// the corner.
    ///
    /// ```
    /// use glam::DVec2;
    /// use subzero::CurveMesh;
    ///
    /// let square = CurveMesh::new(4, vec![[0, 1], [1, 2], [2, 3], [3, 0]], &[])?;
    /// let points = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
    /// let finer = square.four_point_refine()?.stencils.apply(&points);
    /// assert_eq!(finer[..4], points, "the old points stay");
    /// assert_eq!(finer[4], DVec2::new(0.5, -0.125), "(-1, 9, 9, -1)/16 of four points");
    /// # Ok::<(), subzero::MeshError>(())
    /// ```
    ///
    /// # Errors
    /// [`MeshError::TooLarge`] if the finer network outgrows 32-bit ids.
    pub fn four_point_refine(&self) -> Result<Refinement<Self>, MeshError> {
        let vertices = self.vertex_count();
        let stencils = StencilTable::from_stencils(vertices + self.segments.len(), |i, stencil| {
            let Some(segment) = (i as usize).checked_sub(vertices) else {
                stencil.add(i, 1.0);
                return;
            };
            let [a, b] = self.segments[segment];
            for (end, other) in [(a, b), (b, a)] {
                stencil.add(end, 9.0 / 16.0);
                match self.curves[end as usize] {
                    Some(segments) => {
                        let [first, second] = segments;
                        let beyond = if first.index() == segment { second } else { first };
                        stencil.add(self.other_end(beyond, end), -1.0 / 16.0);
                    }
                    None => {
                        stencil.add(end, -2.0 / 16.0);
                        stencil.add(other, 1.0 / 16.0);
                    }
                }
            }
        });
        Ok(Refinement { mesh: self.refine_connectivity()?, stencils })
    }

    /// Halves each segment; points follow apart, as by [`spline_step`](Self::spline_step).
    ///
    /// # Errors
    /// [`MeshError::TooLarge`] if the finer network outgrows 32-bit ids.
    pub fn refine_connectivity(&self) -> Result<Self, MeshError> {
        let vertices = self.vertex_count();
        check_size("vertices", vertices + self.segments.len())?;
        check_size("segments", 2 * self.segments.len())?;
        let middle = |segment: usize| id(vertices + segment);
        let segments = self
            .segments
            .par_iter()
            .enumerate()
            .flat_map_iter(|(s, &[start, end])| [[start, middle(s)], [middle(s), end]])
            .collect();
        let half_at = |v: u32, segment: EdgeId| {
            EdgeId(2 * segment.0 + u32::from(self.segments[segment.index()][0] != v))
        };
        let old = self
            .curves
            .par_iter()
            .enumerate()
            .map(|(v, curve)| curve.map(|ss| ss.map(|s| half_at(id(v), s))));
        let new = (0..self.segments.len())
            .into_par_iter()
            .map(|s| Some([2 * s, 2 * s + 1].map(|half| EdgeId(id(half)))));
        Ok(Self { segments, curves: old.chain(new).collect() })
    }

    /// One stencil per vertex: its place on the limit curve, (1, 4, 1)/6 of a smooth vertex and its neighbours.
    ///
    /// ```
    /// use glam::DVec2;
    /// use subzero::CurveMesh;
    ///
    /// let square = CurveMesh::new(4, vec![[0, 1], [1, 2], [2, 3], [3, 0]], &[])?;
    /// let on_curve = square.limit_positions().apply(&[DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y]);
    /// assert!((on_curve[0] - DVec2::splat(1. / 6.)).length() < 1e-12, "(1, 4, 1)/6 of three points");
    /// # Ok::<(), subzero::MeshError>(())
    /// ```
    pub fn limit_positions(&self) -> StencilTable {
        StencilTable::from_stencils(self.vertex_count(), |v, stencil| match self.neighbours(v) {
            Some(neighbours) => {
                stencil.add(v, 4.0 / 6.0);
                for neighbour in neighbours {
                    stencil.add(neighbour, 1.0 / 6.0);
                }
            }
            None => stencil.add(v, 1.0),
        })
    }

    /// Two stencils per segment: the derivatives of the limit curve at its start and at its end, when the curve runs
    /// through the segment in unit time. Half the difference of the neighbours at smooth vertices, the one-sided
    /// difference at corners.
    pub fn limit_tangents(&self) -> StencilTable {
        StencilTable::from_stencils(2 * self.segments.len(), |i, stencil| {
            let [start, end] = self.segments[(i / 2) as usize];
            let at_start = i % 2 == 0;
            let (here, there) = if at_start { (start, end) } else { (end, start) };
            let forward = if at_start { 1.0 } else { -1.0 };
            if let Some(segments) = self.curves[here as usize] {
                let behind = if segments[0].0 == i / 2 { segments[1] } else { segments[0] };
                stencil.add(there, 0.5 * forward);
                stencil.add(self.other_end(behind, here), -0.5 * forward);
            } else {
                stencil.add(there, forward);
                stencil.add(here, -forward);
            }
        })
    }

    fn other_end(&self, segment: EdgeId, vertex: u32) -> u32 {
        let [start, end] = self.segments[segment.index()];
        if start == vertex { end } else { start }
    }

    /// One stencil of the table that [`refine`](Self::refine) makes, by itself: puts the old points that make up a vertex of the refined
    /// network in place of `entries`, each with its weight.
    ///
    /// # Panics
    /// If the refined network has no such vertex.
    pub fn spline_stencil(&self, vertex: u32, entries: &mut Vec<(u32, f64)>) {
        entries.clear();
        self.add_spline_stencil(vertex, &mut |point, weight| entries.push((point, weight)));
    }

    /// The points one level on: bit for bit what the table of [`refine`](Self::refine) makes of `points`, without the memory that the
    /// table takes.
    ///
    /// # Panics
    /// If there is not one point per vertex.
    pub fn spline_step<P: Point>(&self, points: &[P]) -> Vec<P> {
        assert_eq!(points.len(), self.vertex_count(), "there must be one point per vertex");
        let refined = (0..self.vertex_count() + self.segments.len()).into_par_iter();
        let point = |vertex: usize| {
            let mut sum = P::zero();
            self.add_spline_stencil(id(vertex), &mut |point, weight| {
                sum = sum.add_scaled(points[point as usize], weight);
            });
            sum
        };
        refined.map(point).collect()
    }

    fn stencils(&self) -> StencilTable {
        StencilTable::from_stencils(self.vertex_count() + self.segments.len(), |i, stencil| {
            self.add_spline_stencil(i, &mut |point, weight| stencil.add(point, weight));
        })
    }

    fn add_spline_stencil(&self, vertex: u32, add: &mut impl FnMut(u32, f64)) {
        if let Some(segment) = (vertex as usize).checked_sub(self.vertex_count()) {
            for end in self.segments[segment] {
                add(end, 0.5);
            }
        } else if let Some(neighbours) = self.neighbours(vertex) {
            add(vertex, 0.75);
            for neighbour in neighbours {
                add(neighbour, 0.125);
            }
        } else {
            add(vertex, 1.0);
        }
    }
}
