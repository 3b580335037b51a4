//! Grains that are put where others are.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

use glam::{DMat3, DQuat, DVec3};
use rayon::prelude::*;

use super::division::{Division, part_volumes, seeds_of_parts};
use super::grains::{Grains, pieces_of_cells};
use super::newton::{Clipped, approach};
use super::spheres::whole_periods;
use super::{GOAL, VolumesError, check_volumes};
use crate::diagram::measures::face_area_and_centroid;
use crate::{CellId, Dimension, FaceId, Side, Tessellation, Translation};

/// How far the points around an inclusion stand from its centre at first, in distances of its faces; nearer where another inclusion is in the way.
const REACHES: [f64; 3] = [1.5, 1.25, 1.1];

/// How far corners of an inclusion are from its centre at most, in distances of its faces: 1.26 of a regular dodecahedron, and some more
/// as its faces move for its volume.
const LARGEST_RADIUS: f64 = 1.4;

/// By how much an inclusion is larger in each further grain that it is in, and by what angle in radians it is turned there: what is the same
/// in both would meet in edges of four cells, which rounding would decide. The steps are closed with other short edges.
const STEP: f64 = 0.01;
const TURN: f64 = 0.02;

/// As in [`divide_cells`](super::divide_cells). At 0.1 Newton's method took a third of the time for 157 inclusions on boundaries and as long on triple lines, where triangles came
/// down to 0.1 degrees.
const NEARNESS: f64 = 0.01;

/// Pieces of an inclusion or of what is around it below this share of the volume of the smallest one near are left to what is beside them.
const SMALLEST_PIECE: f64 = 0.01;

/// How often pieces apart from their grains go to what is beside them: with new weights, others may come off.
const MOST_ROUNDS: usize = 10;

/// A grain to be put into a tessellation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inclusion {
    /// A cell that its centre is in, or at the surface of.
    pub cell: CellId,
    /// Its centre, where this cell stands.
    pub center: DVec3,
    /// The volume that it is to have (in the plane: area).
    pub volume: f64,
}

/// Cells that make up the grains of a tessellation and others that are put where these are.
#[derive(Debug, Clone, PartialEq)]
pub struct InsertedGrains {
    /// The cells.
    pub tessellation: Tessellation,
    /// Their weights, with which [`Tessellation::power`] gives them.
    pub weights: Vec<f64>,
    /// The grain of each cell: first come those that were cells before, then the inclusions.
    pub grain_of_cell: Vec<u32>,
    /// By how much each cell has to be moved to stand with its grain: in a periodic domain its seed stands in the box.
    pub moves: Vec<Translation>,
}

/// Puts grains where the cells of a tessellation are, each of which stays one grain. `volumes` are those that the cells are to have then; with those
/// of the inclusions they add up to the domain's, and are reached within [`TOLERANCE`](super::TOLERANCE).
///
/// An inclusion is a dodecahedron (in the plane an octagon), cut where others or walls are near. It may be inside one cell, or on a face, an
/// edge or a vertex of several. All cells around it are divided as [`divide_cells`](super::divide_cells) does, by its centre and points around it; what belongs to the centre
/// is the inclusion, and the rest the grain that the cell was.
///
/// # Errors
/// [`VolumesError`]: [`VolumesError::TooNear`] where there is no room for a grain.
///
/// # Panics
/// When there are not as many weights and volumes as cells.
pub fn insert_grains(
    tessellation: &Tessellation,
    weights: &[f64],
    volumes: &[f64],
    inclusions: &[Inclusion],
) -> Result<InsertedGrains, VolumesError> {
    let domain = tessellation.domain();
    assert_eq!(tessellation.cell_count(), weights.len(), "one weight for each cell");
    assert_eq!(tessellation.cell_count(), volumes.len(), "one volume for each cell");
    let own = inclusions.iter().map(|inclusion| inclusion.volume);
    let volumes = check_volumes(domain, &volumes.iter().copied().chain(own).collect::<Vec<f64>>())?;
    let mut inside: Vec<Vec<Part>> = vec![Vec::new(); tessellation.cell_count()];
    for (number, inclusion) in inclusions.iter().enumerate() {
        let around = cells_around(tessellation, weights, inclusion);
        for (rank, (cell, moved)) in around.into_iter().enumerate() {
            let center = inclusion.center - moved.vector(domain);
            inside[cell.index()].push(Part { inclusion: number, center, moved, rank });
        }
    }
    let measures = tessellation.cell_measures();
    let pieces =
        (0u32..).map(CellId).zip(&inside).collect::<Vec<_>>().into_par_iter().map(|(cell, parts)| {
            let (seed, weight) = (tessellation.seeds()[cell.index()], weights[cell.index()]);
            let whole = Pieces {
                seeds: vec![seed],
                weights: vec![weight],
                grains: vec![cell.0],
                moves: vec![Translation::ZERO],
            };
            if parts.is_empty() {
                return Ok(whole);
            }
            let (division, part_of_point) = division(domain.dimension(), inclusions, parts);
            let smallest =
                parts.iter().map(|part| inclusions[part.inclusion].volume).fold(f64::INFINITY, f64::min);
            let middle = measures[cell.index()].centroid;
            let cell_count = tessellation.cell_count();
            let number = |part: Option<Part>| match part {
                Some(part) => u32::try_from(cell_count + part.inclusion).expect("fewer grains than cells"),
                None => cell.0,
            };
            let too_small = |_: &[f64]| SMALLEST_PIECE * smallest;
            let (_, points) = part_volumes(&tessellation.cell_domain(cell)?, middle, &division, too_small)?;
            let grains: Vec<u32> = points.iter().map(|point| number(part_of_point[*point])).collect();
            let is_own = |grain: &u32| *grain == cell.0;
            if grains.iter().all(is_own) || !grains.iter().any(is_own) {
                return Ok(whole);
            }
            let (seeds, weights) =
                seeds_of_parts(tessellation, cell, middle, weight, &division.of(&points), NEARNESS);
            let moved = |point: &usize| part_of_point[*point].map_or(Translation::ZERO, |part| part.moved);
            let moves = points.iter().map(moved).collect();
            Ok(Pieces { seeds, weights, grains, moves })
        });
    let pieces = pieces.collect::<Result<Vec<Pieces>, VolumesError>>()?;
    let seeds: Vec<DVec3> =
        pieces.iter().flat_map(|pieces| &pieces.seeds).map(|seed| domain.wrapped(*seed)).collect();
    let weights: Vec<f64> = pieces.iter().flat_map(|pieces| &pieces.weights).copied().collect();
    let grain_of_cell: Vec<u32> = pieces.iter().flat_map(|pieces| &pieces.grains).copied().collect();
    let stands = pieces.iter().flat_map(|pieces| pieces.seeds.iter().zip(&pieces.moves));
    let mut moves: Vec<Translation> = stands
        .zip(&seeds)
        .map(|((stands, moved), seed)| whole_periods(domain, *stands - *seed) + *moved)
        .collect();
    let mut grains = Grains::of_cells(grain_of_cell, volumes.len());
    let mut state = Clipped::new(domain, &seeds, weights, Arc::clone(&grains))?;
    for _ in 0..MOST_ROUNDS {
        if let Some(grain) = state.volumes().position(|volume| volume <= 0.0) {
            return Err(VolumesError::TooNear { grain });
        }
        approach(&mut state, &volumes, GOAL)?;
        let loose = loose_pieces(&state.tessellation, &grains, &moves);
        if loose.is_empty() {
            let grain_of_cell = grains.of_each_cell().to_vec();
            return Ok(InsertedGrains {
                tessellation: state.tessellation,
                weights: state.weights,
                grain_of_cell,
                moves,
            });
        }
        let mut of_cell = grains.of_each_cell().to_vec();
        for LoosePiece { cells, grain, moved, .. } in loose {
            for cell in cells {
                of_cell[cell.index()] = grain;
                moves[cell.index()] = moves[cell.index()] + moved;
            }
        }
        grains = Grains::of_cells(of_cell, volumes.len());
        state = Clipped::of(state.tessellation, state.weights, Arc::clone(&grains));
    }
    let grain = loose_pieces(&state.tessellation, &grains, &moves).first().map_or(0, |piece| piece.of);
    Err(VolumesError::InPieces { grain })
}

/// A piece of a grain apart from its largest one.
struct LoosePiece {
    cells: Vec<CellId>,
    /// The grain that it is of.
    of: usize,
    /// The grain that it shares most area with.
    grain: u32,
    /// By how much it has to be moved to stand with that one.
    moved: Translation,
}

/// The pieces of grains apart from the largest one of each.
fn loose_pieces(tessellation: &Tessellation, grains: &Grains, moves: &[Translation]) -> Vec<LoosePiece> {
    let pieces = pieces_of_cells(tessellation, grains, moves, 0.0);
    let mut volumes = vec![0.0; pieces.len()];
    tessellation.cell_measures().iter().zip(&pieces).for_each(|(cell, piece)| volumes[*piece] += cell.volume);
    let cells = || (0u32..).map(CellId).zip(&pieces);
    let mut largest: Vec<Option<usize>> = vec![None; grains.count()];
    for (cell, piece) in cells().filter(|(cell, piece)| cell.index() == **piece) {
        let largest = &mut largest[grains.of(cell) as usize];
        if largest.is_none_or(|other| volumes[*piece] > volumes[other]) {
            *largest = Some(*piece);
        }
    }
    let is_loose =
        |cell: CellId, piece: usize| volumes[piece] > 0.0 && largest[grains.of(cell) as usize] != Some(piece);
    let mut loose: BTreeMap<usize, Vec<CellId>> = BTreeMap::new();
    for (cell, piece) in cells().filter(|(cell, piece)| is_loose(*cell, **piece)) {
        loose.entry(*piece).or_default().push(cell);
    }
    let beside = |cells: Vec<CellId>| {
        // What the piece shares with each grain beside it, and by how much it moves to the last of its cells there.
        let mut shared: BTreeMap<u32, (f64, Translation)> = BTreeMap::new();
        for cell in &cells {
            for face in tessellation.cell_faces(*cell) {
                let Some((other, translation)) = tessellation.across(*cell, *face).cell() else { continue };
                if grains.of(other) != grains.of(*cell) {
                    let (area, moved) = shared.entry(grains.of(other)).or_insert((0.0, Translation::ZERO));
                    *area += face_area_and_centroid(tessellation, *face).0;
                    *moved = moves[other.index()] - translation - moves[cell.index()];
                }
            }
        }
        let of = grains.of(cells[0]) as usize;
        let most =
            shared.into_iter().max_by(|one, other| one.1.0.total_cmp(&other.1.0).then(other.0.cmp(&one.0)));
        most.map(|(grain, (_, moved))| LoosePiece { cells, of, grain, moved })
    };
    loose.into_values().filter_map(beside).collect()
}

/// What a cell becomes.
struct Pieces {
    /// Where the cell stands.
    seeds: Vec<DVec3>,
    weights: Vec<f64>,
    grains: Vec<u32>,
    /// By how much each has to be moved from where the cell stands to stand with its grain.
    moves: Vec<Translation>,
}

/// What of an inclusion is in a cell.
#[derive(Debug, Clone, Copy)]
struct Part {
    inclusion: usize,
    /// Where the cell stands.
    center: DVec3,
    /// By how much the cell has to be moved to stand with the inclusion.
    moved: Translation,
    /// The number of the cell among those that the inclusion is in.
    rank: usize,
}

/// The distance of the faces of a regular dodecahedron from its middle, of a volume; in the plane of the edges of an octagon, of an area.
pub(super) fn face_distance(dimension: Dimension, volume: f64) -> f64 {
    match dimension {
        Dimension::Two => (volume / (8.0 * (std::f64::consts::PI / 8.0).tan())).sqrt(),
        Dimension::Three => (volume / 5.550_291).cbrt(),
    }
}

/// The cells that an inclusion may reach, and by how much they are moved there.
fn cells_around(
    tessellation: &Tessellation,
    weights: &[f64],
    inclusion: &Inclusion,
) -> Vec<(CellId, Translation)> {
    let domain = tessellation.domain();
    let radius = LARGEST_RADIUS * face_distance(domain.dimension(), inclusion.volume);
    let mut found = vec![(inclusion.cell, Translation::ZERO)];
    let mut next = VecDeque::from(found.clone());
    while let Some((cell, moved)) = next.pop_front() {
        let center = inclusion.center - moved.vector(domain);
        for face in tessellation.cell_faces(cell) {
            let Some((other, translation)) = tessellation.across(cell, *face).cell() else { continue };
            let there = (other, moved + translation);
            if !found.contains(&there) && beyond_face(tessellation, weights, cell, *face, center) < radius {
                let is_reached = tessellation.cell_faces(other).iter().all(|own| {
                    let center = center - translation.vector(domain);
                    beyond_face(tessellation, weights, other, *own, center) > -radius
                });
                if is_reached {
                    found.push(there);
                    next.push_back(there);
                }
            }
        }
    }
    found
}

/// How far a place inside a cell is from the plane of one of its faces; negative beyond it.
pub(super) fn beyond_face(
    tessellation: &Tessellation,
    weights: &[f64],
    cell: CellId,
    face: FaceId,
    place: DVec3,
) -> f64 {
    let domain = tessellation.domain();
    let (other, translation) = match tessellation.across(cell, face) {
        Side::Cell(other) => (other, Translation::ZERO),
        Side::Image(other, translation) => (other, translation),
        Side::Wall(wall) => {
            let (normal, distance) = domain.wall_equation(wall);
            return distance - normal.dot(place);
        }
    };
    let [own, beyond] = [
        tessellation.seeds()[cell.index()],
        tessellation.seeds()[other.index()] + translation.vector(domain),
    ];
    let power = |seed: DVec3, of: CellId| place.distance_squared(seed) - weights[of.index()];
    (power(beyond, other) - power(own, cell)) / (2.0 * own.distance(beyond))
}

/// The points that divide a cell, and the part that each is the centre of.
fn division(dimension: Dimension, inclusions: &[Inclusion], parts: &[Part]) -> (Division, Vec<Option<Part>>) {
    let distances: Vec<f64> = parts
        .iter()
        .map(|part| {
            let distance = face_distance(dimension, inclusions[part.inclusion].volume);
            distance * (1.0 + STEP * part.rank as f64)
        })
        .collect();
    let mut division = Division { points: Vec::new(), weights: Vec::new() };
    let mut part_of_point = Vec::new();
    let mut add = |point, radius: f64, part| {
        division.points.push(point);
        division.weights.push(radius * radius);
        part_of_point.push(part);
    };
    for (number, (part, distance)) in parts.iter().zip(&distances).enumerate() {
        add(part.center, *distance, Some(*part));
        for direction in directions(dimension, part) {
            // A sphere around each point touches that of the inclusion, and so the face between them is at its distance.
            let is_free = |reach: &f64| {
                let point = part.center + *reach * *distance * direction;
                let others = parts.iter().zip(&distances).enumerate().filter(|(other, _)| *other != number);
                let mut others = others.map(|(_, (other, radius))| point.distance(other.center) - radius);
                others.all(|gap| gap > (*reach - 1.0) * *distance)
            };
            if let Some(reach) = REACHES.into_iter().find(is_free) {
                add(part.center + reach * *distance * direction, (reach - 1.0) * *distance, None);
            }
        }
    }
    (division, part_of_point)
}

/// Directions of the faces of an inclusion.
fn directions(dimension: Dimension, part: &Part) -> Vec<DVec3> {
    // Multiples of the golden ratio and its kin turn each inclusion another way.
    let number = part.inclusion as f64 + 1.0;
    let turn = TURN * part.rank as f64;
    match dimension {
        Dimension::Two => {
            let start = std::f64::consts::TAU * (number * 0.618_033_988_749_895).fract() + turn;
            let angle = |step: u32| start + std::f64::consts::FRAC_PI_4 * f64::from(step);
            (0..8).map(angle).map(|angle| DVec3::new(angle.cos(), angle.sin(), 0.0)).collect()
        }
        Dimension::Three => {
            let axis = DVec3::new(0.36, 0.48, 0.8);
            let turns = [0.819_172_513_396_164, 0.671_043_606_703_789, 0.549_700_477_901_97]
                .map(|step| std::f64::consts::TAU * (number * step).fract());
            let rotation = DQuat::from_euler(glam::EulerRot::ZXZ, turns[0], turns[1], turns[2]);
            let rotation = DMat3::from_quat(rotation * DQuat::from_axis_angle(axis, turn));
            let golden = 0.5 * (1.0 + 5.0f64.sqrt());
            let corners = [-1.0, 1.0].into_iter().flat_map(|a| [-golden, golden].map(|b| [a, b]));
            let corners = corners
                .flat_map(|[a, b]| [DVec3::new(0.0, a, b), DVec3::new(a, b, 0.0), DVec3::new(b, 0.0, a)]);
            corners.map(|corner| rotation * corner.normalize()).collect()
        }
    }
}
