//! Relaxation to equilibrium in the plane.
//!
//! There, boundaries in equilibrium are arcs of circles, whose curvature is the difference of pressure over the tension. So little is
//! unknown: where vertices are, and how far each edge turns.

pub(crate) mod arc_network;
pub(crate) mod chordal_arc;
pub(crate) mod descent;
pub(crate) mod kkt_system;
pub(crate) mod switching;

use glam::{DVec2, DVec3};
use voronoi::{FaceId, PeriodicVertex, Tessellation};

use crate::CellComplex;
use crate::energy::local_size::LocalSize;
use crate::events::reconnection::Reconnections;
use crate::flow::balance::Balance;
use crate::flow::recipe::{Certified, NetworkRecipe, RelaxedCells};
use crate::flow::relaxation::{Moving, RelaxationStep, Relaxed};
use crate::flow::tuning::Tuning;
use crate::network::face_mesh::FEWEST_SEGMENTS;
use crate::{Mesh, Network, NetworkError, Side, Volumes, measure_network};
use arc_network::ArcNetwork;
use chordal_arc::point_on_arc;
use descent::Descent;
use switching::{CurvedEdges, Switcher};

/// Chords of an arc as long as the topology changes: as good as a smooth one.
const CHORDS: u32 = 32;

/// Largest angle by which a boundary turns from one segment to the next, in degrees. Segments at a triple point are off the
/// boundaries' own directions by half of that.
const LARGEST_BEND: f64 = 0.25;

/// Most steps while the topology changes, and most after that. Some fifty are usual.
const STEPS: usize = 2000;

/// As [`relax_cells`](crate::relax::relax_cells), in the plane.
pub(crate) fn equilibrate(
    tessellation: &Tessellation,
    recipe: &NetworkRecipe<'_>,
    watch: &mut dyn FnMut(RelaxationStep<'_>),
) -> Result<RelaxedCells, NetworkError> {
    let areas: Vec<f64> = tessellation.cell_measures().iter().map(|cell| cell.volume).collect();
    let complex = CellComplex::from(tessellation);
    let turnings = vec![0.0; complex.faces().len()];
    let mut edges = CurvedEdges { complex, turnings };
    let Settled { reconnections, states, descent } = settle(&mut edges, recipe, &areas)?;
    let smooth = SmoothEdges::new(&edges, recipe, &areas)?;
    let relaxed = smooth.balanced(&edges, recipe, states, descent, watch)?;
    let network = smooth.network;
    let certified = Certified::new(&network, &relaxed, Volumes::Kept)?;
    let cells = RelaxedCells::of_kept_topology(network, relaxed, certified);
    let balance = Some(balance(&cells.network, &cells.points));
    Ok(RelaxedCells { reconnections, balance, ..cells })
}

/// How a topology came about, and the states from there to rest.
struct Settled {
    reconnections: Reconnections,
    states: Vec<Vec<f64>>,
    descent: Descent,
}

/// Lets edges move and switch until all is at rest.
fn settle(
    edges: &mut CurvedEdges,
    recipe: &NetworkRecipe<'_>,
    areas: &[f64],
) -> Result<Settled, NetworkError> {
    let domain = edges.complex.domain();
    let size = domain.dimension().cube_edge(domain.measure() / areas.len() as f64);
    let feature_size = size.min(domain.size().truncate().min_element());
    let local_size = LocalSize::new(domain.dimension(), Tuning::default().small_grain * size);
    let mut switcher = Switcher::new(feature_size, local_size, areas, recipe.tension);
    let mut reconnections = switcher.start(edges);
    let mut network = edges.network(areas, recipe, |_| CHORDS);
    let mut descent = Descent::new(&network, edges.state(&network));
    let mut states = vec![descent.state.clone()];
    for _ in 0..STEPS {
        let step = descent.step(&network)?;
        if step.is_at_rest {
            break;
        }
        edges.place(&network, &descent.state);
        let events = switcher.pass(edges, &step.vanishing);
        if events.count() > 0 {
            reconnections.add(events);
            network = edges.network(areas, recipe, |_| CHORDS);
            descent.go_on(&network, edges.state(&network));
            states.clear();
        }
        states.push(descent.state.clone());
    }
    Ok(Settled { reconnections, states, descent })
}

impl CurvedEdges {
    fn network<'a>(
        &self,
        areas: &'a [f64],
        recipe: &NetworkRecipe<'_>,
        chords: impl Fn(FaceId) -> u32,
    ) -> ArcNetwork<'a> {
        ArcNetwork::new(&self.complex, areas, recipe.tension, chords)
    }

    fn state(&self, network: &ArcNetwork<'_>) -> Vec<f64> {
        let places = self.complex.vertices.iter().flat_map(|place| [place.x, place.y]);
        places.chain(network.arcs.iter().map(|arc| self.turnings[arc.face.index()])).collect()
    }

    fn place(&mut self, network: &ArcNetwork<'_>, state: &[f64]) {
        for (vertex, place) in self.complex.vertices.iter_mut().zip(state.chunks(2)) {
            *vertex = DVec3::new(place[0], place[1], 0.0);
        }
        for (number, arc) in network.arcs.iter().enumerate() {
            self.turnings[arc.face.index()] = network.turning(number, state);
        }
    }
}

/// The network of curved edges with so many segments that all look smooth.
struct SmoothEdges {
    network: Network,
    /// Of each vertex of the network's cells, that of the complex.
    corners: Vec<PeriodicVertex>,
    /// Segments of each edge on the finest level, in the order of the complex.
    chords: Vec<u32>,
}

impl SmoothEdges {
    fn new(edges: &CurvedEdges, recipe: &NetworkRecipe<'_>, areas: &[f64]) -> Result<Self, NetworkError> {
        let (cells, corners) = edges.complex.tessellation();
        let whole = f64::from(recipe.levels.try_into().unwrap_or(u16::MAX)).exp2();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most 360 degrees")]
        let segments = |face: FaceId| {
            let turning = edges.turnings[face.index()].to_degrees().abs();
            ((turning / (LARGEST_BEND * whole)).ceil() as u32).max(FEWEST_SEGMENTS)
        };
        let own: Vec<u32> = edges.complex.faces().into_iter().map(segments).collect();
        let copied = cells.periodic_faces().iter().map(|pair| own[pair.primary.index()]);
        let counts: Vec<u32> = own.iter().copied().chain(copied).collect();
        let network = Network::of_divided_lines(&cells, &counts, recipe.levels)?;
        let network = network.with_cell_volumes(areas.to_vec()).with_tensions(recipe.tension)?;
        let chords = own.iter().map(|count| count << recipe.levels).collect();
        Ok(Self { network, corners, chords })
    }

    /// Brings all to rest with its segments as they are in the end, after the states on the way to there.
    fn balanced(
        &self,
        edges: &CurvedEdges,
        recipe: &NetworkRecipe<'_>,
        states: Vec<Vec<f64>>,
        mut descent: Descent,
        watch: &mut dyn FnMut(RelaxationStep<'_>),
    ) -> Result<Relaxed, NetworkError> {
        let faces = edges.complex.faces();
        let chords = |face| self.chords[faces.binary_search(&face).expect("numbers do not change")];
        let network = edges.network(self.network.cell_volumes(), recipe, chords);
        let level = self.network.level_count();
        let mut show = |done: usize, state: &[f64]| {
            let points = self.points(&network, state);
            watch(RelaxationStep {
                done,
                count: STEPS,
                time: done as f64,
                now: Moving::Points { level, points: &points },
            });
        };
        states.iter().enumerate().for_each(|(done, state)| show(done, state));
        let mut steps = states.len() - 1;
        for _ in 0..STEPS {
            if descent.step(&network)?.is_at_rest {
                break;
            }
            steps += 1;
            show(steps, &descent.state);
        }
        let points = self.points(&network, &descent.state);
        Ok(Relaxed { steps, time: steps as f64, ..Relaxed::new(level, points) })
    }

    fn points(&self, network: &ArcNetwork<'_>, state: &[f64]) -> Vec<DVec3> {
        let finest = self.network.finest_level();
        let Mesh::Segments(mesh) = &finest.mesh else { unreachable!("a network in the plane has lines") };
        let mut points = vec![DVec3::ZERO; finest.vertex_count()];
        // Some vertices belong to copies of edges alone.
        for (point, corner) in points.iter_mut().zip(&self.corners) {
            let place = 2 * corner.vertex as usize;
            let own = DVec3::new(state[place], state[place + 1], 0.0);
            *point = own + corner.translation.vector(self.network.domain());
        }
        let mut segments = mesh.segments().iter();
        for ((number, arc), chords) in network.arcs.iter().enumerate().zip(&self.chords) {
            let ends: [DVec2; 2] = network.ends(arc, state);
            let turning = network.turning(number, state);
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
    Balance::of_lines(measures.triple_points.iter().map(|point| {
        let is_inside = !point.sides.contains(&Side::Exterior);
        (is_inside && point.sides.len() > 3, point.residual)
    }))
}
