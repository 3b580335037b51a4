//! What relaxation of cells takes and gives.

use std::time::{Duration, Instant};

use glam::DVec3;

use crate::events::reconnection::Reconnections;
use crate::flow::balance::Balance;
use crate::flow::relaxation::Relaxed;
use crate::validate::certificate;
use crate::{Attempt, Boundary, Certificate, FaceMesh, Junctions, Network, NetworkError};
use crate::{Collapsed, Volumes};

/// How a network is made of cells.
#[derive(Clone, Copy)]
pub struct NetworkRecipe<'a> {
    /// Where its control points are. Grains that come together and part leave lines and boundaries in [`FaceMesh::Fan`] where they are;
    /// others start from the flat boundaries between them.
    pub face_mesh: FaceMesh,
    /// How triple lines are smoothed.
    pub junctions: Junctions,
    /// Number of subdivisions.
    pub levels: usize,
    /// The tension of each boundary.
    pub tension: &'a (dyn Fn(&Boundary) -> f64 + Sync),
}

/// What relaxation of cells gives.
#[derive(Debug, Clone)]
pub struct RelaxedCells {
    /// The network with its topology in the end.
    pub network: Network,
    /// Where its points are.
    pub relaxed: Relaxed,
    /// Those of the finest level, as of [`Relaxed::finest_points`].
    pub points: Vec<DVec3>,
    /// What changed the topology.
    pub reconnections: Reconnections,
    /// Short triple lines, and boundaries with them, that were drawn together into points of higher order.
    pub merged: Collapsed,
    /// How near to equilibrium it is, where that was asked for.
    pub balance: Option<Balance>,
    /// What validation found.
    pub validation: Certificate,
    /// Time that validation took, of all.
    pub validated_in: Duration,
    /// What was tried before, and tangled.
    pub attempts: Vec<Attempt>,
}

impl RelaxedCells {
    /// A network whose topology has stayed.
    pub(crate) fn of_kept_topology(network: Network, relaxed: Relaxed, certified: Certified) -> Self {
        let Certified { points, validation, validated_in } = certified;
        Self {
            network,
            relaxed,
            points,
            reconnections: Reconnections::default(),
            merged: Collapsed::default(),
            balance: None,
            validation,
            validated_in,
            attempts: Vec::new(),
        }
    }
}

/// The finest level of a relaxed network, certified.
#[derive(Debug, Clone)]
pub struct Certified {
    /// Its points, as of [`Relaxed::finest_points`].
    pub points: Vec<DVec3>,
    /// What validation found.
    pub validation: Certificate,
    /// Time that validation took.
    pub validated_in: Duration,
}

impl Certified {
    /// That of a network where its points are. Where volumes are free, grains have those that they have reached.
    pub(crate) fn new(network: &Network, relaxed: &Relaxed, volumes: Volumes) -> Result<Self, NetworkError> {
        let points = relaxed.finest_points(network);
        let start = Instant::now();
        let reached;
        let volumes = match volumes {
            Volumes::Kept => network.cell_volumes(),
            Volumes::Free => {
                reached = network.grain_volumes(network.finest(), &points);
                &reached
            }
        };
        let validation = certificate(network, &points, volumes);
        if !validation.is_good() {
            return Err(NetworkError::Invalid(validation.faults));
        }
        Ok(Self { points, validation, validated_in: start.elapsed() })
    }
}
