//! Parts of a periodic network that are others moved by whole periods.

use glam::DVec3;
use voronoi::{Domain, Edges, PeriodicPair, Shift, Tessellation};

use crate::Mesh;

/// On one level, the vertices and elements that are others moved by whole periods; none in a domain with walls only.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct PeriodicCopies {
    /// Moved vertices, by number, with what they are copies of.
    pub vertices: Vec<PeriodicPair<u32>>,
    /// Pairs of a moved element and what it is a copy of, the other way round.
    pub(crate) elements: Vec<PeriodicPair<u32>>,
}

impl PeriodicCopies {
    /// Those of a control mesh, with `middle` and `center` as the numbers of its points on edges and faces.
    pub(crate) fn of_control_mesh(
        tessellation: &Tessellation,
        edges: &Edges,
        middle: impl Fn(u32) -> u32,
        center: impl Fn(u32) -> u32,
    ) -> Self {
        let mut copies = Self::of_vertices(tessellation);
        copies
            .vertices
            .extend(tessellation.periodic_edges(edges).into_iter().map(|pair| map_ids(pair, &middle)));
        copies
            .vertices
            .extend(tessellation.periodic_faces().iter().map(|pair| map_ids(*pair, |face| center(face.0))));
        // Two triangles for each corner of a face, in order.
        let mut first_triangle = Vec::with_capacity(tessellation.face_count());
        let mut count = 0;
        for face in tessellation.faces() {
            first_triangle.push(count);
            count +=
                2 * u32::try_from(tessellation.face_corners(face).len()).expect("checked to fit 32-bit ids");
        }
        for pair in tessellation.periodic_faces() {
            let corners = u32::try_from(tessellation.face_corners(pair.primary).len()).expect("as above");
            for corner in 0..corners {
                // Corner k of the secondary is corner n - 1 - k of the primary, where the edge before it ends.
                let before = (2 * corners - 2 - corner) % corners;
                for half in 0..2 {
                    copies.elements.push(PeriodicPair {
                        secondary: first_triangle[pair.secondary.index()] + 2 * corner + half,
                        primary: first_triangle[pair.primary.index()] + 2 * before + 1 - half,
                        shift: pair.shift,
                    });
                }
            }
        }
        copies
    }

    /// Those of the control mesh in the plane: its segments come in pairs, one pair for each face.
    pub(crate) fn of_control_lines(tessellation: &Tessellation) -> Self {
        let mut copies = Self::of_vertices(tessellation);
        let vertex_count = u32::try_from(tessellation.vertices().len()).expect("checked to fit 32-bit ids");
        for pair in tessellation.periodic_faces() {
            copies.vertices.push(map_ids(*pair, |face| vertex_count + face.0));
            let halves = [0, 1].map(|half| PeriodicPair {
                secondary: 2 * pair.secondary.0 + half,
                primary: 2 * pair.primary.0 + 1 - half,
                shift: pair.shift,
            });
            copies.elements.extend(halves);
        }
        copies
    }

    fn of_vertices(tessellation: &Tessellation) -> Self {
        let vertices = tessellation.periodic_vertices().iter().map(|pair| map_ids(*pair, |vertex| vertex.0));
        Self { vertices: vertices.collect(), elements: Vec::new() }
    }

    /// Those of the next level, whose elements are numbered as [`subzero::MeshCounts`] says.
    pub(crate) fn refined(&self, vertex_count: usize, element_count: usize, finer: &Mesh) -> Self {
        if self.elements.is_empty() {
            return Self::default();
        }
        let mut finer_copies = Self { vertices: self.vertices.clone(), elements: Vec::new() };
        let mut new = NewVertices::new(vertex_count);
        let id = |index: usize| u32::try_from(index).expect("ids fit 32 bits");
        match finer {
            Mesh::Triangles(finer) => {
                let mut originals: Vec<u32> = (0..id(vertex_count)).collect();
                for pair in &self.vertices {
                    originals[pair.secondary as usize] = pair.primary;
                }
                let corners = finer.triangles();
                for &PeriodicPair { secondary, primary, shift } in &self.elements {
                    for own in (0..3).map(|k| 3 * secondary + k) {
                        let original = |child: u32| originals[corners[child as usize][0] as usize];
                        let matching =
                            (0..3).map(|k| 3 * primary + k).find(|child| original(*child) == original(own));
                        let other = matching.expect("a copied triangle has copied corners");
                        let ([_, a, b], [_, d, c]) = (corners[own as usize], corners[other as usize]);
                        new.unite(a, c, shift);
                        new.unite(b, d, shift);
                        finer_copies.elements.push(PeriodicPair { secondary: own, primary: other, shift });
                    }
                    let [own, other] = [secondary, primary].map(|parent| 3 * id(element_count) + parent);
                    finer_copies.elements.push(PeriodicPair { secondary: own, primary: other, shift });
                }
            }
            Mesh::Segments(_) => {
                for &PeriodicPair { secondary, primary, shift } in &self.elements {
                    new.unite(id(vertex_count) + secondary, id(vertex_count) + primary, shift);
                    let halves = [0, 1].map(|half| PeriodicPair {
                        secondary: 2 * secondary + half,
                        primary: 2 * primary + 1 - half,
                        shift,
                    });
                    finer_copies.elements.extend(halves);
                }
            }
        }
        finer_copies.vertices.extend(new.copies());
        finer_copies
    }

    /// Puts each moved vertex where it belongs: at its original plus the shift.
    pub fn place(&self, domain: &Domain, points: &mut [DVec3]) {
        for PeriodicPair { secondary, primary, shift } in &self.vertices {
            points[*secondary as usize] = points[*primary as usize] + shift.vector(domain);
        }
    }
}

fn map_ids<Id: Copy>(pair: PeriodicPair<Id>, id: impl Fn(Id) -> u32) -> PeriodicPair<u32> {
    PeriodicPair { secondary: id(pair.secondary), primary: id(pair.primary), shift: pair.shift }
}

/// The vertices that a refinement adds, joined to those that they are copies of: a forest of numbers and shifts.
struct NewVertices {
    first: usize,
    /// Of each new vertex, one of smaller number that it is a copy of, or itself, and the shift from there.
    parents: Vec<(u32, Shift)>,
}

impl NewVertices {
    fn new(first: usize) -> Self {
        Self { first, parents: Vec::new() }
    }

    fn parent(&mut self, vertex: u32) -> (u32, Shift) {
        let place = vertex as usize - self.first;
        for vertex in self.first + self.parents.len()..=vertex as usize {
            self.parents.push((u32::try_from(vertex).expect("ids fit 32 bits"), Shift::NONE));
        }
        self.parents[place]
    }

    fn root(&mut self, vertex: u32) -> (u32, Shift) {
        let (mut at, mut shift) = (vertex, Shift::NONE);
        loop {
            let (parent, step) = self.parent(at);
            if parent == at {
                return (at, shift);
            }
            (at, shift) = (parent, shift + step);
        }
    }

    /// Notes that `secondary = primary + shift`.
    fn unite(&mut self, secondary: u32, primary: u32, shift: Shift) {
        let ((a, from_a), (b, from_b)) = (self.root(secondary), self.root(primary));
        // secondary = a + from_a = b + from_b + shift.
        let place = |vertex: u32| vertex as usize - self.first;
        if a > b {
            let place = place(a);
            self.parents[place] = (b, from_b + shift - from_a);
        } else if b > a {
            let place = place(b);
            self.parents[place] = (a, from_a - shift - from_b);
        }
    }

    fn copies(mut self) -> Vec<PeriodicPair<u32>> {
        let all: Vec<u32> = (self.first..self.first + self.parents.len())
            .map(|v| u32::try_from(v).expect("ids fit 32 bits"))
            .collect();
        let pairs = all.into_iter().map(|secondary| {
            let (primary, shift) = self.root(secondary);
            PeriodicPair { secondary, primary, shift }
        });
        pairs.filter(|pair| pair.secondary != pair.primary).collect()
    }
}
