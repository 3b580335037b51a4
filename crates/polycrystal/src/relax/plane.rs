//! Relaxation to equilibrium in the plane.
//!
//! There, boundaries in equilibrium are arcs of circles, whose curvature is the difference of pressure over the tension. So little is
//! unknown: where vertices are, and how far each edge turns.

mod bow;
mod descent;
mod foam;
mod switching;

use glam::{DVec2, DVec3};
use voronoi::{CellComplex, Collapsed, Corner, FaceId, Tessellation};

use super::equilibrium::{Balance, Equilibrium, NetworkRecipe};
use super::reconnection::Reconnections;
use super::{RelaxationStep, Relaxed};
use crate::{Mesh, Network, NetworkError, Side, measure_network, validate};
use bow::point_on_arc;
use descent::Descent;
use foam::Foam;
use switching::{CurvedEdges, Switcher};

/// Chords of an arc as long as the topology changes: as good as a smooth one.
const CHORDS: u32 = 32;

/// Largest angle by which a boundary turns from one segment to the next, in degrees. Segments at a triple point are off the
/// boundaries' own directions by half of that.
const LARGEST_BEND: f64 = 0.5;

/// Most steps while the topology changes, and most after that.
const STEPS: usize = 2000;

/// Fewest segments of a boundary on the control mesh, as elsewhere.
const FEWEST_SEGMENTS: u32 = 2;

/// As [`equilibrate`](super::equilibrate), in the plane.
pub(super) fn equilibrate(
    tessellation: &Tessellation,
    recipe: &NetworkRecipe<'_>,
    watch: &mut impl FnMut(RelaxationStep<'_>),
) -> Result<Equilibrium, NetworkError> {
    let areas: Vec<f64> = tessellation.cell_measures().iter().map(|cell| cell.volume).collect();
    let complex = CellComplex::from(tessellation);
    let turnings = vec![0.0; complex.faces().last().map_or(0, |face| face.index() + 1)];
    let mut edges = CurvedEdges { complex, turnings };
    let reconnections = settle(&mut edges, recipe, &areas)?;
    let smooth = Smooth::new(&edges, recipe, areas.clone())?;
    let (points, steps) = smooth.balanced(&mut edges, recipe, &areas, watch)?;
    let network = smooth.network;
    validate(&network, &points).map_err(NetworkError::Invalid)?;
    let level = network.levels().len() - 1;
    let balance = balance(&network, &points);
    let relaxed = Relaxed { level, points, steps, time: steps as f64, fell_back: false };
    Ok(Equilibrium { network, relaxed, reconnections, merged: Collapsed::default(), balance })
}

/// Lets edges move and switch until all is at rest.
fn settle(
    edges: &mut CurvedEdges,
    recipe: &NetworkRecipe<'_>,
    areas: &[f64],
) -> Result<Reconnections, NetworkError> {
    let domain = edges.complex.domain();
    let size = domain.dimension().cube_edge(domain.measure() / areas.len() as f64);
    let sides = domain.size().truncate();
    let mut switcher = Switcher::new(size.min(sides.min_element()), recipe.tension);
    let mut all = switcher.pass(edges, &[]);
    let mut foam = edges.foam(areas, recipe, |_| CHORDS);
    let mut descent = Descent::new(&foam, edges.state(&foam));
    for _ in 0..STEPS {
        let step = descent.step(&foam).ok_or(NetworkError::Folded { count: 0 })?;
        edges.place(&foam, &descent.state);
        let events = switcher.pass(edges, &step.vanishing);
        if events.count() > 0 {
            all.add(events);
            foam = edges.foam(areas, recipe, |_| CHORDS);
            let state = edges.state(&foam);
            descent = Descent::new(&foam, state);
        } else if step.is_at_rest {
            break;
        }
    }
    Ok(all)
}

impl CurvedEdges {
    fn foam<'a>(
        &self,
        areas: &'a [f64],
        recipe: &NetworkRecipe<'_>,
        chords: impl Fn(FaceId) -> u32,
    ) -> Foam<'a> {
        Foam::new(&self.complex, areas, recipe.tension, chords)
    }

    fn state(&self, foam: &Foam<'_>) -> Vec<f64> {
        let places = self.complex.vertices.iter().flat_map(|place| [place.x, place.y]);
        places.chain(foam.arcs.iter().map(|arc| self.turnings[arc.face.index()])).collect()
    }

    fn place(&mut self, foam: &Foam<'_>, state: &[f64]) {
        for (vertex, place) in self.complex.vertices.iter_mut().zip(state.chunks(2)) {
            *vertex = DVec3::new(place[0], place[1], 0.0);
        }
        for (number, arc) in foam.arcs.iter().enumerate() {
            self.turnings[arc.face.index()] = foam.turning(number, state);
        }
    }
}

/// The network of curved edges with enough segments for all to be smooth.
struct Smooth {
    network: Network,
    /// Of each vertex of the network's cells, that of the complex.
    corners: Vec<Corner>,
    /// Segments of each edge on the finest level, in the order of the complex.
    chords: Vec<u32>,
}

impl Smooth {
    fn new(edges: &CurvedEdges, recipe: &NetworkRecipe<'_>, areas: Vec<f64>) -> Result<Self, NetworkError> {
        let (cells, corners) = edges.complex.tessellation();
        let finest = 2f64.powi(i32::try_from(recipe.levels).unwrap_or(i32::MAX));
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most 360 degrees")]
        let segments = |face: FaceId| {
            let turning = edges.turnings[face.index()].to_degrees().abs();
            ((turning / (LARGEST_BEND * finest)).ceil() as u32).max(FEWEST_SEGMENTS)
        };
        let mut counts: Vec<u32> = edges.complex.faces().into_iter().map(segments).collect();
        let primary = |face: FaceId| cells.periodic_faces().iter().find(|pair| pair.secondary == face);
        for copy in cells.faces().skip(counts.len()) {
            let primary = primary(copy).expect("what is not in the complex is a copy").primary;
            counts.push(counts[primary.index()]);
        }
        let network = Network::of_divided_lines(&cells, &counts, recipe.levels)?;
        let network = network.with_cell_volumes(areas).with_tensions(recipe.tension)?;
        counts.truncate(edges.complex.faces().len());
        let chords = counts.iter().map(|count| count << recipe.levels).collect();
        Ok(Self { network, corners, chords })
    }

    /// Points of the finest level in equilibrium, and the number of steps there.
    fn balanced(
        &self,
        edges: &mut CurvedEdges,
        recipe: &NetworkRecipe<'_>,
        areas: &[f64],
        watch: &mut impl FnMut(RelaxationStep<'_>),
    ) -> Result<(Vec<DVec3>, usize), NetworkError> {
        let faces = edges.complex.faces();
        let chords = |face| self.chords[faces.binary_search(&face).expect("the edge is there")];
        let foam = edges.foam(areas, recipe, chords);
        let mut descent = Descent::new(&foam, edges.state(&foam));
        let level = self.network.levels().len() - 1;
        let mut show = |done: usize, points: &[DVec3]| {
            watch(RelaxationStep { done, count: STEPS, time: done as f64, level, points });
        };
        let mut points = self.points(&foam, &descent.state);
        show(0, &points);
        for done in 1..=STEPS {
            let step = descent.step(&foam).ok_or(NetworkError::Folded { count: 0 })?;
            points = self.points(&foam, &descent.state);
            show(done, &points);
            if step.is_at_rest {
                edges.place(&foam, &descent.state);
                return Ok((points, done));
            }
        }
        Ok((points, STEPS))
    }

    fn points(&self, foam: &Foam<'_>, state: &[f64]) -> Vec<DVec3> {
        let finest = self.network.finest();
        let Mesh::Segments(mesh) = &finest.mesh else { unreachable!("a network in the plane has lines") };
        let mut points = vec![DVec3::ZERO; finest.vertex_count()];
        // Some vertices belong to copies of edges alone.
        for (point, corner) in points.iter_mut().zip(&self.corners) {
            let place = 2 * corner.vertex as usize;
            let own = DVec3::new(state[place], state[place + 1], 0.0);
            *point = own + corner.shift.vector(self.network.domain());
        }
        let mut segments = mesh.segments().iter();
        for ((number, arc), chords) in foam.arcs.iter().enumerate().zip(&self.chords) {
            let ends: [DVec2; 2] = foam.ends(arc, state);
            let turning = foam.turning(number, state);
            for (done, [_, end]) in (1..=*chords).zip(&mut segments).filter(|(done, _)| done < chords) {
                points[*end as usize] = point_on_arc(ends, turning, done, *chords).extend(0.0);
            }
        }
        let walls = points.iter_mut().zip(&finest.walls);
        walls.for_each(|(point, walls)| *point = self.network.wall_sets().put_on_walls(*walls, *point));
        finest.copies.place(self.network.domain(), &mut points);
        points
    }
}

/// How near to equilibrium a network in the plane is.
fn balance(network: &Network, points: &[DVec3]) -> Balance {
    let measures = measure_network(network, points).in_plane().expect("a network in the plane");
    let inside = || measures.triple_points.iter().filter(|point| !point.sides.contains(&Side::Exterior));
    let deviations = inside().filter(|point| point.sides.len() == 3).flat_map(|point| &point.angles);
    Balance {
        flagged_lines: inside().filter(|point| point.sides.len() > 3).count(),
        largest_deviation: deviations.map(|angle| (angle - 120.0).abs()).fold(0.0, f64::max),
    }
}
