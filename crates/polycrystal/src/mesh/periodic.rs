//! Parts of a periodic network that are others moved by whole periods.

use glam::DVec3;
use voronoi::{Domain, FaceId, PeriodicPair, PeriodicVertex, Tessellation, Translation};

use crate::Elements;
use crate::mesh::id::id;

/// On one level, the vertices and elements that are others moved by whole periods; none in a domain with walls only.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct PeriodicCopies {
    /// Moved vertices, by number, with what they are copies of.
    pub vertices: Vec<PeriodicPair<u32>>,
    /// Pairs of a moved element and what it is a copy of, the other way round.
    pub(crate) elements: Vec<PeriodicPair<u32>>,
}

impl PeriodicCopies {
    /// The vertices of a tessellation that are copies.
    pub(crate) fn of_vertices(tessellation: &Tessellation) -> Self {
        let vertices = tessellation.periodic_vertices().iter().map(|pair| map_ids(*pair, |vertex| vertex.0));
        Self { vertices: vertices.collect(), elements: Vec::new() }
    }

    /// What each of so many vertices is a copy of, or itself.
    pub(crate) fn originals(&self, vertex_count: usize) -> Vec<PeriodicVertex> {
        let unmoved = |vertex| PeriodicVertex { vertex, translation: Translation::ZERO };
        let mut originals: Vec<PeriodicVertex> = (0..id(vertex_count)).map(unmoved).collect();
        for pair in &self.vertices {
            originals[pair.secondary as usize] =
                PeriodicVertex { vertex: pair.primary, translation: pair.translation };
        }
        originals
    }

    /// Adds the triangles and inner points of copied faces, of which each face has so many; inner points are numbered face by face from
    /// `first_inner`.
    pub(crate) fn add_faces(
        &mut self,
        pairs: &[PeriodicPair<FaceId>],
        counts: &[[usize; 2]],
        first_inner: usize,
    ) {
        if pairs.is_empty() {
            return;
        }
        let (mut triangle, mut inner) = (0, id(first_inner));
        let firsts: Vec<[u32; 2]> = counts
            .iter()
            .map(|[triangles, inner_points]| {
                let firsts = [triangle, inner];
                triangle += id(*triangles);
                inner += id(*inner_points);
                firsts
            })
            .collect();
        for &PeriodicPair { secondary, primary, translation } in pairs {
            let [secondary_firsts, primary_firsts] = [secondary, primary].map(|face| firsts[face.index()]);
            let pair = |kind: usize, k: u32| PeriodicPair {
                secondary: secondary_firsts[kind] + k,
                primary: primary_firsts[kind] + k,
                translation,
            };
            let [triangles, inner_points] = counts[primary.index()].map(id);
            self.elements.extend((0..triangles).map(|k| pair(0, k)));
            self.vertices.extend((0..inner_points).map(|k| pair(1, k)));
        }
    }

    /// Adds elements that each are a copied face.
    pub(crate) fn add_elements(&mut self, pairs: &[PeriodicPair<FaceId>]) {
        self.elements.extend(pairs.iter().map(|pair| map_ids(*pair, |face| face.0)));
    }

    /// Adds the segments of copied lines in the plane, which run the other way; those of line k begin with `firsts[k]`.
    pub(crate) fn add_lines(&mut self, pairs: &[PeriodicPair<u32>], firsts: &[u32]) {
        for &PeriodicPair { secondary, primary, translation } in pairs {
            let [own, other] = [secondary, primary].map(|line| firsts[line as usize]);
            let count = firsts[secondary as usize + 1] - own;
            let pair = |k| PeriodicPair { secondary: own + k, primary: other + count - 1 - k, translation };
            self.elements.extend((0..count).map(pair));
        }
    }

    /// Those of the next level, whose elements are numbered as [`subzero::MeshCounts`] says.
    pub(crate) fn refined(&self, vertex_count: usize, element_count: usize, finer: Elements<'_>) -> Self {
        if self.elements.is_empty() {
            return Self::default();
        }
        let mut finer_copies = Self { vertices: self.vertices.clone(), elements: Vec::new() };
        let mut new = NewVertices::new(vertex_count);
        match finer {
            Elements::Triangles(_) | Elements::Refined(_) => {
                let mut places: Vec<(u32, Translation)> =
                    (0..id(vertex_count)).map(|vertex| (vertex, Translation::ZERO)).collect();
                for pair in &self.vertices {
                    places[pair.secondary as usize] = (pair.primary, pair.translation);
                }
                let corners = |child: u32| finer.points::<3>(child);
                for &PeriodicPair { secondary, primary, translation } in &self.elements {
                    for own in (0..3).map(|k| 3 * secondary + k) {
                        let place = |child: u32| places[corners(child)[0] as usize];
                        let (vertex, at) = place(own);
                        let matching = (0..3)
                            .map(|k| 3 * primary + k)
                            .find(|child| place(*child) == (vertex, at - translation));
                        let other = matching.expect("a copied triangle has copied corners");
                        let ([_, a, b], [_, d, c]) = (corners(own), corners(other));
                        new.unite(a, c, translation);
                        new.unite(b, d, translation);
                        finer_copies.elements.push(PeriodicPair {
                            secondary: own,
                            primary: other,
                            translation,
                        });
                    }
                    let [own, other] = [secondary, primary].map(|parent| 3 * id(element_count) + parent);
                    finer_copies.elements.push(PeriodicPair { secondary: own, primary: other, translation });
                }
            }
            Elements::Segments(_) => {
                for &PeriodicPair { secondary, primary, translation } in &self.elements {
                    new.unite(id(vertex_count) + secondary, id(vertex_count) + primary, translation);
                    let halves = [0, 1].map(|half| PeriodicPair {
                        secondary: 2 * secondary + half,
                        primary: 2 * primary + 1 - half,
                        translation,
                    });
                    finer_copies.elements.extend(halves);
                }
            }
        }
        finer_copies.vertices.extend(new.copies());
        finer_copies
    }

    /// Puts each moved vertex where it belongs: at its original plus the translation.
    pub fn place(&self, domain: &Domain, points: &mut [DVec3]) {
        for PeriodicPair { secondary, primary, translation } in &self.vertices {
            points[*secondary as usize] = points[*primary as usize] + translation.vector(domain);
        }
    }
}

fn map_ids<Id: Copy>(pair: PeriodicPair<Id>, id: impl Fn(Id) -> u32) -> PeriodicPair<u32> {
    PeriodicPair { secondary: id(pair.secondary), primary: id(pair.primary), translation: pair.translation }
}

/// The vertices that a refinement adds, joined to those that they are copies of: a forest of numbers and translations.
struct NewVertices {
    first: usize,
    /// Of each new vertex, one of smaller number that it is a copy of, or itself, and the translation from there.
    parents: Vec<(u32, Translation)>,
}

impl NewVertices {
    fn new(first: usize) -> Self {
        Self { first, parents: Vec::new() }
    }

    fn parent(&mut self, vertex: u32) -> (u32, Translation) {
        let place = vertex as usize - self.first;
        for vertex in self.first + self.parents.len()..=vertex as usize {
            self.parents.push((u32::try_from(vertex).expect("ids fit 32 bits"), Translation::ZERO));
        }
        self.parents[place]
    }

    fn root(&mut self, vertex: u32) -> (u32, Translation) {
        let (mut at, mut translation) = (vertex, Translation::ZERO);
        loop {
            let (parent, step) = self.parent(at);
            if parent == at {
                return (at, translation);
            }
            (at, translation) = (parent, translation + step);
        }
    }

    /// Notes that `secondary = primary + translation`.
    fn unite(&mut self, secondary: u32, primary: u32, translation: Translation) {
        let ((a, from_a), (b, from_b)) = (self.root(secondary), self.root(primary));
        // secondary = a + from_a = b + from_b + translation.
        let place = |vertex: u32| vertex as usize - self.first;
        if a > b {
            let place = place(a);
            self.parents[place] = (b, from_b + translation - from_a);
        } else if b > a {
            let place = place(b);
            self.parents[place] = (a, from_a - translation - from_b);
        }
    }

    fn copies(mut self) -> Vec<PeriodicPair<u32>> {
        let all: Vec<u32> = (self.first..self.first + self.parents.len())
            .map(|v| u32::try_from(v).expect("ids fit 32 bits"))
            .collect();
        let pairs = all.into_iter().map(|secondary| {
            let (primary, translation) = self.root(secondary);
            PeriodicPair { secondary, primary, translation }
        });
        pairs.filter(|pair| pair.secondary != pair.primary).collect()
    }
}
