//! A network as the page draws it: boundary after boundary, each with points of its own, so that normals end at its rim.

use glam::DVec3;
use serde::Serialize;

use super::super::packed::Packed;
use crate::picture::{Parts, Pieces, differing};

/// A network on its way to the page.
#[derive(Debug)]
pub(crate) struct ShownNetwork {
    /// Numbers of the grains, in order; all else counts grains by place in this list.
    pub(crate) ids: Vec<u32>,
    /// Of each grain.
    pub(crate) facts: Vec<GrainFacts>,
    /// Of each vertex of a boundary, the point that it is of.
    pub(crate) point_of: Vec<u32>,
    /// The triangles, by number, boundary after boundary.
    order: Vec<u32>,
    /// Corners by vertex, three a triangle.
    corners: Vec<u32>,
    /// The ends of edges at rims, boundary after boundary.
    rims: Vec<u32>,
    boundaries: Vec<ShownBoundary>,
    normals: Vec<DVec3>,
    /// Of each piece of a grain, the middle.
    centers: Vec<DVec3>,
    /// Of each grain a number, such that no neighbours have the same.
    different: Vec<usize>,
}

/// What is known of a grain by its surface, in the plane by its lines.
#[derive(Debug, Clone, Default, Serialize)]
pub(crate) struct GrainFacts {
    /// In the plane, the area.
    pub(crate) volume: f64,
    /// Of the surface; in the plane, the length of its lines.
    pub(crate) area: f64,
    /// Number of grains beyond its boundaries.
    pub(crate) neighbors: usize,
}

#[derive(Debug, Serialize)]
struct ShownBoundary {
    /// Places of the grains, -1 for the exterior. Normals point from the first to the second.
    sides: [i64; 2],
    /// Pieces of these grains, which the box may have cut.
    pieces: [i64; 2],
    vertices: usize,
    triangles: usize,
    rim: usize,
}

/// Where a page puts points: the middle at the origin, the longest side of length 1.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Frame {
    middle: DVec3,
    unit: f64,
}

#[derive(Serialize)]
struct Head<'a, T> {
    #[serde(flatten)]
    more: &'a T,
    middle: [f64; 3],
    unit: f64,
    ids: &'a [u32],
    facts: &'a [GrainFacts],
    centers: Vec<[f32; 3]>,
    different: &'a [usize],
    boundaries: &'a [ShownBoundary],
}

impl ShownNetwork {
    /// A network of triangles, each of a boundary with two sides: numbers of grains, or nothing outside.
    pub(crate) fn new(
        points: &[DVec3],
        triangles: &[[u32; 3]],
        boundary_of: &[u32],
        sides: &[[Option<u32>; 2]],
    ) -> Self {
        let mut ids: Vec<u32> = sides.iter().flatten().flatten().copied().collect();
        ids.sort_unstable();
        ids.dedup();
        let places: Vec<[Option<usize>; 2]> =
            sides.iter().map(|sides| sides.map(|grain| ids.binary_search(&grain?).ok())).collect();
        let mut order: Vec<u32> = (0..).take(triangles.len()).collect();
        order.sort_by_key(|triangle| boundary_of[*triangle as usize]);
        let groups: Vec<&[u32]> =
            order.chunk_by(|a, b| boundary_of[*a as usize] == boundary_of[*b as usize]).collect();
        let boundary = |group: &[u32]| boundary_of[group[0] as usize] as usize;
        let group_sides: Vec<[Option<u32>; 2]> = groups.iter().map(|group| sides[boundary(group)]).collect();
        let parts = Parts {
            points,
            sides: &group_sides,
            triangles_of: |part: usize| groups[part].iter().map(|number| triangles[*number as usize]),
        };
        let Pieces { of_sides, centers } = parts.pieces();
        let mut network = Self {
            facts: vec![GrainFacts::default(); ids.len()],
            ids,
            point_of: Vec::new(),
            corners: Vec::with_capacity(3 * triangles.len()),
            rims: Vec::new(),
            boundaries: Vec::new(),
            normals: Vec::new(),
            centers,
            different: Vec::new(),
            order: Vec::new(),
        };
        let facets = parts.facet_edges();
        let mut vertex_of = vec![u32::MAX; points.len()];
        for (part, pieces) in of_sides.into_iter().enumerate() {
            let members: Vec<[u32; 3]> = (parts.triangles_of)(part).collect();
            let grains = places[boundary(groups[part])];
            let outer = group_sides[part][0].filter(|_| group_sides[part][1].is_none());
            let is_facet =
                |ends: [u32; 2]| outer.is_some_and(|grain| facets.binary_search(&(grain, ends)).is_ok());
            network.add_boundary(points, &members, (grains, pieces), is_facet, &mut vertex_of);
        }
        network.order = order;
        network.set_neighbors(&places);
        network
    }

    fn add_boundary(
        &mut self,
        points: &[DVec3],
        triangles: &[[u32; 3]],
        (sides, pieces): ([Option<usize>; 2], [Option<usize>; 2]),
        is_facet: impl Fn([u32; 2]) -> bool,
        vertex_of: &mut [u32],
    ) {
        let (first_vertex, first_rim) = (self.point_of.len(), self.rims.len());
        let mut edges = Vec::with_capacity(3 * triangles.len());
        for triangle in triangles {
            let corners = triangle.map(|point| {
                let vertex = &mut vertex_of[point as usize];
                if *vertex == u32::MAX {
                    // Boundaries have fewer vertices together than triangles have corners, which are counted in 32 bits.
                    *vertex = u32::try_from(self.point_of.len()).unwrap_or(u32::MAX);
                    self.point_of.push(point);
                    self.normals.push(DVec3::ZERO);
                }
                *vertex
            });
            let [a, b, c] = triangle.map(|point| points[point as usize]);
            let normal = (b - a).cross(c - a);
            corners.iter().for_each(|vertex| self.normals[*vertex as usize] += normal);
            self.corners.extend(corners);
            let [a_id, b_id, c_id] = corners;
            edges.extend([[a_id, b_id], [b_id, c_id], [c_id, a_id]].map(|[a, b]| [a.min(b), a.max(b)]));
            let area = 0.5 * normal.length();
            for (side, sign) in sides.into_iter().zip([1.0, -1.0]) {
                let Some(facts) = side.map(|side| &mut self.facts[side]) else { continue };
                facts.area += area;
                facts.volume += sign * a.dot(b.cross(c)) / 6.0;
            }
        }
        for point in &self.point_of[first_vertex..] {
            vertex_of[*point as usize] = u32::MAX;
        }
        edges.sort_unstable();
        let rim = edges.chunk_by(|a, b| a == b).filter(|edge| edge.len() == 1).map(|edge| edge[0]);
        let is_drawn = |ends: &[u32; 2]| {
            let [a, b] = ends.map(|vertex| self.point_of[vertex as usize]);
            !is_facet([a.min(b), a.max(b)])
        };
        self.rims.extend(rim.filter(is_drawn).flatten());
        // Places in a list of numbers of 32 bits.
        let place = |side: Option<usize>| side.map_or(-1, |side| i64::try_from(side).unwrap_or(-1));
        self.boundaries.push(ShownBoundary {
            sides: sides.map(place),
            pieces: pieces.map(place),
            vertices: self.point_of.len() - first_vertex,
            triangles: triangles.len(),
            rim: (self.rims.len() - first_rim) / 2,
        });
    }

    /// Tells who are neighbours, by the places of the grains on both sides of each boundary.
    pub(super) fn set_neighbors(&mut self, places: &[[Option<usize>; 2]]) {
        let pairs = places.iter().filter_map(|[first, second]| Some([(*first)?, (*second)?]));
        let mut pairs: Vec<[usize; 2]> = pairs.filter(|[a, b]| a != b).collect();
        pairs.iter_mut().for_each(|pair| pair.sort_unstable());
        pairs.sort_unstable();
        pairs.dedup();
        self.facts.iter_mut().for_each(|facts| facts.neighbors = 0);
        pairs.iter().flatten().for_each(|grain| self.facts[*grain].neighbors += 1);
        self.different = differing(self.ids.len(), pairs);
    }

    /// Of each vertex, the number of the grain on the first side of its boundary.
    pub(super) fn grain_of_vertices(&self) -> impl Iterator<Item = u32> {
        let grain = |boundary: &ShownBoundary| {
            let place = usize::try_from(boundary.sides[0]).ok();
            place.map_or(u32::MAX, |place| self.ids[place])
        };
        self.boundaries.iter().flat_map(move |one| std::iter::repeat_n(grain(one), one.vertices))
    }

    /// The numbers of an array with `width` numbers for each point, at each vertex.
    pub(crate) fn of_points(&self, numbers: &[f64], width: usize, component: usize) -> Vec<f64> {
        self.point_of.iter().map(|point| numbers[width * *point as usize + component]).collect()
    }

    /// The means of the numbers of the triangles around each vertex in its boundary.
    pub(crate) fn of_triangles(&self, numbers: &[f64], width: usize, component: usize) -> Vec<f64> {
        let mut sums = vec![(0.0, 0.0); self.point_of.len()];
        for (triangle, corners) in self.order.iter().zip(self.corners.as_chunks::<3>().0) {
            let number = numbers[width * *triangle as usize + component];
            for corner in corners {
                sums[*corner as usize].0 += number;
                sums[*corner as usize].1 += 1.0;
            }
        }
        sums.into_iter().map(|(sum, count)| sum / count).collect()
    }

    /// The network with more in its head, for the page.
    pub(crate) fn packed(&self, points: &[DVec3], more: &impl Serialize) -> serde_json::Result<Vec<u8>> {
        let frame = Frame::around(points);
        let mut packed = Packed::default();
        let places = self.point_of.iter().flat_map(|point| frame.place(points[*point as usize]));
        packed.floats("position", places);
        let unit = |normal: &DVec3| normal.normalize_or_zero().to_array();
        #[expect(clippy::cast_possible_truncation, reason = "from -127 to 127")]
        let steps = |cosine: f64| (127.0 * cosine).round() as i8;
        packed.small(
            "normal",
            self.normals.iter().map(|normal| {
                let [x, y, z] = unit(normal);
                [steps(x), steps(y), steps(z), 0]
            }),
        );
        packed.ids("corners", self.corners.iter().copied());
        packed.ids("rims", self.rims.iter().copied());
        packed.bytes(&Head {
            more,
            middle: frame.middle.to_array(),
            unit: frame.unit,
            ids: &self.ids,
            facts: &self.facts,
            centers: self.centers.iter().map(|center| frame.place(*center)).collect(),
            different: &self.different,
            boundaries: &self.boundaries,
        })
    }
}

impl Frame {
    /// The frame in which some points lie from -1/2 to 1/2.
    pub(crate) fn around(points: &[DVec3]) -> Self {
        let low = points.iter().copied().reduce(DVec3::min).unwrap_or_default();
        let high = points.iter().copied().reduce(DVec3::max).unwrap_or_default();
        let unit = Some((high - low).max_element()).filter(|unit| *unit > 0.0).unwrap_or(1.0);
        Self { middle: low.midpoint(high), unit }
    }

    /// Where a point is drawn, in single precision as graphics cards have it.
    pub(crate) fn place(self, point: DVec3) -> [f32; 3] {
        self.in_frame(point).as_vec3().to_array()
    }

    /// The same in double precision.
    pub(crate) fn in_frame(self, point: DVec3) -> DVec3 {
        (point - self.middle) / self.unit
    }

    /// The point that is drawn at a place.
    pub(crate) fn point(self, place: DVec3) -> DVec3 {
        self.middle + self.unit * place
    }

    pub(crate) fn middle(self) -> DVec3 {
        self.middle
    }

    pub(crate) fn unit(self) -> f64 {
        self.unit
    }
}
