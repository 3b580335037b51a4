//! The control mesh of any labelled surface.

use glam::DVec3;
use subzero::{Crease, CurveMesh, EdgeId, FaceId, Features, TriangleMesh};
use voronoi::{Dimension, Domain, PeriodicPair, Wall};

use crate::mesh::adjacency::{Adjacency, Incidence};
use crate::mesh::disjoint_sets::DisjointSets;
use crate::mesh::id::id;
use crate::mesh::node_type::Meeting;
use crate::network::control_mesh::{ControlMesh, JunctionCounts};
use crate::{
    Boundary, BoundaryId, Certificate, Elements, Expected, Fault, GrainId, Junctions, Level, Mesh,
    NetworkError, PeriodicCopies, Side, Surface, WallSets, certify,
};

/// Distance from a wall that is not square to an axis, in units of the domain's diagonal, within which points lie on it.
const ON_WALL: f64 = 1e-12;

/// What a labelled surface may be like.
#[derive(Debug, Clone, Copy)]
pub(crate) enum SurfaceKind<'a> {
    /// Grains fill the domain, and nothing is folded.
    Whole,
    /// Grains may have pores between them, and be folded where they are thin.
    Measured {
        /// What each grain is to have, where that is known.
        volumes: Option<&'a [f64]>,
    },
}

impl SurfaceKind<'_> {
    /// What a surface is like. Its only faults may be folds, where these are allowed.
    ///
    /// # Errors
    /// [`NetworkError::Invalid`].
    pub(crate) fn certify(self, domain: &Domain, surface: &Surface<'_>) -> Result<Certificate, NetworkError> {
        let certificate = match self {
            Self::Whole => {
                let expected = Expected { domain_volume: Some(domain.measure()), ..Expected::default() };
                certify(surface, &expected)
            }
            Self::Measured { volumes } => {
                let numbered = |volumes: &[f64]| (0u32..).map(GrainId).zip(volumes.iter().copied()).collect();
                let of_grains: Option<Vec<_>> = volumes.map(numbered);
                let expected = Expected { grain_volumes: of_grains.as_deref(), ..Expected::default() };
                certify(surface, &expected)
            }
        };
        match self {
            Self::Whole if certificate.is_good() => Ok(certificate),
            Self::Whole => Err(NetworkError::Invalid(certificate.faults)),
            Self::Measured { .. } => but_folded(certificate),
        }
    }
}

/// What a measured surface is like, whose grains may be folded where they are thin.
///
/// # Errors
/// [`NetworkError::Invalid`] where it has other faults.
pub(crate) fn but_folded(certificate: Certificate) -> Result<Certificate, NetworkError> {
    let is_allowed = |fault: &Fault| matches!(fault, Fault::Folded { .. });
    if certificate.faults.0.iter().all(is_allowed) {
        return Ok(certificate);
    }
    let mut faults = certificate.faults;
    faults.0.retain(|fault| !is_allowed(fault));
    Err(NetworkError::Invalid(faults))
}

impl ControlMesh {
    /// The control mesh whose points and elements are those of a surface, which is certified to be of this kind.
    pub(crate) fn of_surface(
        domain: &Domain,
        surface: &Surface<'_>,
        kind: SurfaceKind<'_>,
        junctions: Junctions,
    ) -> Result<Self, NetworkError> {
        let elements = OrderedElements::new(domain, surface, kind)?;
        let adjacency = Adjacency::of_elements(elements.as_elements(), &elements.boundary_of);
        let Connected { boundaries, boundary_of } = Connected::new(&elements, &adjacency);
        let mut walls_of = vec![Vec::new(); surface.points.len()];
        let mut sides_of = vec![Vec::new(); surface.points.len()];
        for (element, boundary) in (0u32..).zip(&boundary_of) {
            let Boundary { sides, wall, .. } = boundaries[boundary.index()];
            for corner in elements.as_elements().corners(element).iter() {
                walls_of[*corner as usize].extend(wall);
                sides_of[*corner as usize].extend(sides);
            }
        }
        let sorted = |list: &mut Vec<Wall>| {
            list.sort_unstable();
            list.dedup();
        };
        walls_of.iter_mut().for_each(sorted);
        let ends = || adjacency.non_manifold_edges().map(|at| at[0].ends(elements.as_elements()));
        let (wall_sets, walls) = WallSets::of_walls(domain, &walls_of, &boundaries, ends());
        let mut points = surface.points.to_vec();
        points
            .iter_mut()
            .zip(&walls)
            .for_each(|(point, walls)| *point = wall_sets.put_on_walls(*walls, *point));
        let meetings: Vec<Meeting> = sides_of.iter_mut().map(meeting).collect();
        let at_places: Vec<Meeting> = adjacency
            .non_manifold_edges()
            .map(|at| meeting(&mut at.iter().flat_map(|at| elements.sides_of(at)).collect()))
            .collect();
        let at_points = || meetings.iter().map(|at| at.sides);
        let generations = vec![0; points.len()];
        let copies = PeriodicCopies::default();
        let (mesh, at_edges, junctions) = match &elements.ordered {
            Ordered::Segments(segments) => {
                let corners: Vec<u32> = adjacency.non_manifold_edges().map(|at| at[0].edge).collect();
                let mesh = CurveMesh::new(points.len(), segments.clone(), &corners)?;
                (Mesh::Segments(mesh), Vec::new(), JunctionCounts::new(at_points(), at_points()))
            }
            Ordered::Triangles(triangles) => {
                let ends: Vec<[u32; 2]> = ends().collect();
                let lines = Lines::new(points.len(), &ends);
                let creases: Vec<Crease> = ends.iter().map(|ends| Crease::infinite(*ends)).collect();
                let corners = lines.corners(junctions);
                let features = Features { creases: &creases, corners: &corners, ..Features::default() };
                let mesh = TriangleMesh::new(points.len(), triangles.clone(), &features)?;
                let inside = |edge: EdgeId| {
                    let triangle = mesh.edge_triangles(edge).expect("an edge inside a boundary has two")[0];
                    Meeting::inside(&boundaries[boundary_of[triangle.index()].index()])
                };
                let mut at_lines: Vec<Option<Meeting>> = vec![None; mesh.edge_count()];
                for (at, meeting) in adjacency.non_manifold_edges().zip(&at_places) {
                    let edge = mesh.triangle_edges(FaceId(at[0].element))[usize::from(at[0].corner)];
                    at_lines[edge.index()] = Some(*meeting);
                }
                let at_edges = (0u32..)
                    .zip(at_lines)
                    .map(|(edge, at)| at.unwrap_or_else(|| inside(EdgeId(edge))))
                    .collect();
                let junctions = JunctionCounts::new(lines.sides(&at_places, &[]), at_points());
                (Mesh::Triangles(mesh), at_edges, junctions)
            }
        };
        let node_types = meetings.iter().map(|at| at.node_type).collect();
        let grain_counts = meetings.iter().map(|at| at.grains).collect();
        let level =
            Level { mesh, boundary_of, node_types, grain_counts, generations, walls, copies, at_edges };
        Ok(Self { level, points, boundaries, wall_sets, junctions })
    }
}

fn meeting(sides: &mut Vec<Side>) -> Meeting {
    sides.sort_unstable();
    sides.dedup();
    Meeting::of_sides(sides)
}

/// The elements of a surface, turned so that the smaller side comes first.
struct OrderedElements {
    ordered: Ordered,
    /// Sides and wall of each group of elements that had one boundary.
    groups: Vec<(BoundaryId, [Side; 2], Option<Wall>)>,
    /// The group of each element.
    boundary_of: Vec<BoundaryId>,
}

enum Ordered {
    Triangles(Vec<[u32; 3]>),
    Segments(Vec<[u32; 2]>),
}

impl OrderedElements {
    fn new(domain: &Domain, surface: &Surface<'_>, kind: SurfaceKind<'_>) -> Result<Self, NetworkError> {
        let is_turned = |element: u32| {
            let [first, second] = surface.sides_of(element);
            second < first
        };
        let all = || 0..id(surface.elements.len());
        let triangle = |element: u32| {
            let [a, b, c] = surface.elements.points(element);
            if is_turned(element) { [a, c, b] } else { [a, b, c] }
        };
        let segment = |element: u32| {
            let [a, b] = surface.elements.points(element);
            if is_turned(element) { [b, a] } else { [a, b] }
        };
        let ordered = match surface.elements.dimension() {
            Dimension::Three => Ordered::Triangles(all().map(triangle).collect()),
            Dimension::Two => Ordered::Segments(all().map(segment).collect()),
        };
        let mut keys = Vec::with_capacity(surface.elements.len());
        for element in all() {
            let boundary = surface.boundary(element);
            let mut sides = surface.sides[boundary.index()];
            sides.sort_unstable();
            let wall = match sides[1] {
                Side::Grain(_) => None,
                Side::Exterior => match (wall_of(domain, surface, element), kind) {
                    (None, SurfaceKind::Whole) => return Err(NetworkError::NotOnWall { element }),
                    (wall, _) => wall,
                },
            };
            keys.push((boundary, sides, wall));
        }
        let mut groups = keys.clone();
        groups.sort_unstable();
        groups.dedup();
        let group = |key| BoundaryId(id(groups.binary_search(key).expect("all were listed")));
        Ok(Self { ordered, boundary_of: keys.iter().map(group).collect(), groups })
    }

    fn as_elements(&self) -> Elements<'_> {
        match &self.ordered {
            Ordered::Triangles(triangles) => Elements::Triangles(triangles),
            Ordered::Segments(segments) => Elements::Segments(segments),
        }
    }

    fn sides_of(&self, at: &Incidence) -> [Side; 2] {
        self.groups[self.boundary_of[at.element as usize].index()].1
    }
}

/// The wall that all corners of an element lie on.
pub(super) fn wall_of(domain: &Domain, surface: &Surface<'_>, element: u32) -> Option<Wall> {
    let diagonal = domain.size().length();
    let is_on = |wall: Wall, point: DVec3| match domain.across_axis(wall) {
        Some((axis, coordinate)) => point[axis] == coordinate,
        None => {
            let (normal, offset) = domain.wall_equation(wall);
            (normal.dot(point) - offset).abs() <= ON_WALL * diagonal * normal.length()
        }
    };
    let corners = surface.elements.corners(element);
    domain.walls().find(|wall| corners.iter().all(|corner| is_on(*wall, surface.points[*corner as usize])))
}

/// The boundaries that elements make up where they hang together.
struct Connected {
    boundaries: Vec<Boundary>,
    boundary_of: Vec<BoundaryId>,
}

impl Connected {
    fn new(elements: &OrderedElements, adjacency: &Adjacency<'_>) -> Self {
        let mut pieces = DisjointSets::new(elements.boundary_of.len());
        adjacency.inner.pairs().iter().for_each(|[a, b]| pieces.join(*a, *b));
        let mut numbers = vec![None; elements.boundary_of.len()];
        let mut boundaries = Vec::new();
        let mut boundary_of = Vec::with_capacity(numbers.len());
        for (element, group) in (0u32..).zip(&elements.boundary_of) {
            let number = *numbers[pieces.root(element) as usize].get_or_insert_with(|| {
                let (_, sides, wall) = elements.groups[group.index()];
                boundaries.push(Boundary { sides, wall, twin: None });
                BoundaryId(id(boundaries.len() - 1))
            });
            boundary_of.push(number);
        }
        Self { boundaries, boundary_of }
    }
}

/// Where boundaries meet: edges and the lines that they make up.
pub(crate) struct Lines<'a> {
    ends: &'a [[u32; 2]],
    /// The edges at each point.
    edges_at: Vec<Vec<u32>>,
}

impl<'a> Lines<'a> {
    pub(crate) fn new(point_count: usize, ends: &'a [[u32; 2]]) -> Self {
        let mut edges_at = vec![Vec::new(); point_count];
        for (edge, ends) in (0u32..).zip(ends) {
            ends.iter().for_each(|end| edges_at[*end as usize].push(edge));
        }
        Self { ends, edges_at }
    }

    /// The points where lines end, or all on lines.
    pub(crate) fn corners(&self, junctions: Junctions) -> Vec<u32> {
        let is_corner = |edges: &Vec<u32>| match junctions {
            Junctions::Crease => !matches!(edges.len(), 0 | 2),
            Junctions::Corner => !edges.is_empty(),
        };
        (0u32..).zip(&self.edges_at).filter(|(_, edges)| is_corner(edges)).map(|(point, _)| point).collect()
    }

    /// The number of sides of each line, given the edges that are others moved by whole periods.
    pub(crate) fn sides(
        &self,
        at_edges: &[Meeting],
        copies: &[PeriodicPair<u32>],
    ) -> impl Iterator<Item = u8> {
        let mut pieces = DisjointSets::new(self.ends.len());
        copies.iter().for_each(|pair| pieces.join(pair.secondary, pair.primary));
        for edges in self.edges_at.iter().filter(|edges| edges.len() == 2) {
            pieces.join(edges[0], edges[1]);
        }
        (0u32..).zip(at_edges).filter(move |(edge, _)| pieces.root(*edge) == *edge).map(|(_, at)| at.sides)
    }
}
