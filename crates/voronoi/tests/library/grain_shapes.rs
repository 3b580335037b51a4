//! Grains of given volumes and shapes, each of several power cells.

use crate::common::random_seeds;
use glam::{BVec3, DMat3, DQuat, DVec3};
use voronoi::volumes::{GrainDiagram, GrainShape, TOLERANCE, VolumesError, place_ellipsoids};
use voronoi::{CellId, Dimension, Domain, Side, Tessellation};

fn periodic_cube() -> Domain {
    Domain::unit_cube().with_periods(BVec3::TRUE)
}

/// Numbers from 0 to 1.
fn fractions(count: usize, random_seed: u64) -> impl Iterator<Item = f64> {
    random_seeds(count.div_ceil(3), random_seed).into_iter().flat_map(|point| point.to_array())
}

/// Volumes of lognormal diameters with a coefficient of variation of 0.35 that fill the domain.
fn volumes(domain: &Domain, count: usize) -> Vec<f64> {
    let spread = (1.0f64 + 0.35 * 0.35).ln().sqrt();
    let normal: Vec<f64> = fractions(2 * count, 7).take(2 * count).collect();
    let normal = normal
        .chunks(2)
        .map(|pair| (-2.0 * (1.0 - pair[0]).ln()).sqrt() * (std::f64::consts::TAU * pair[1]).cos());
    let axes = if domain.dimension() == Dimension::Two { 2.0 } else { 3.0 };
    let sizes: Vec<f64> = normal.map(|normal| (axes * spread * normal).exp()).collect();
    let scale = domain.measure() / sizes.iter().sum::<f64>();
    sizes.into_iter().map(|size| size * scale).collect()
}

/// Shapes of these proportions in random directions.
fn shapes(domain: &Domain, count: usize, lengths: [f64; 3]) -> Vec<GrainShape> {
    let mut numbers = fractions(4 * count, 5);
    let mut next = move || 2.0 * numbers.next().expect("enough numbers") - 1.0;
    let axes = || match domain.dimension() {
        Dimension::Two => DMat3::from_rotation_z(std::f64::consts::PI * next()),
        Dimension::Three => DMat3::from_quat(DQuat::from_xyzw(next(), next(), next(), next()).normalize()),
    };
    std::iter::repeat_with(axes)
        .map(|axes| GrainShape { lengths: DVec3::from_array(lengths), axes })
        .take(count)
        .collect()
}

fn made(domain: &Domain, count: usize, lengths: [f64; 3], steps: usize) -> GrainDiagram {
    let (volumes, shapes) = (volumes(domain, count), shapes(domain, count, lengths));
    let mut numbers = fractions(1_000_000, 3);
    let centers = place_ellipsoids(domain, &volumes, &shapes, || numbers.next().expect("enough numbers"));
    let diagram = GrainDiagram::with_shapes(domain, &centers.expect("good volumes"), &volumes, &shapes);
    diagram.expect("volumes are reached").lloyd(steps).expect("volumes are kept")
}

/// Each grain has its volume, and its cells hang together: counted from the cells alone.
fn assert_good(diagram: &GrainDiagram) {
    let (tessellation, of_cell) = (diagram.tessellation(), diagram.grain_of_cell());
    let count = diagram.volumes().len();
    let mut sums = vec![0.0; count];
    for (cell, grain) in tessellation.cell_measures().iter().zip(of_cell) {
        sums[*grain as usize] += cell.volume;
    }
    for (grain, (sum, volume)) in sums.iter().zip(diagram.volumes()).enumerate() {
        assert!((sum / volume - 1.0).abs() <= 1.1 * TOLERANCE, "grain {grain} has {sum} for {volume}");
    }
    for grain in (0u32..).take(count) {
        let cells: Vec<usize> = (0..of_cell.len())
            .filter(|cell| of_cell[*cell] == grain && tessellation.cell_measures()[*cell].face_count > 0)
            .collect();
        let mut reached = vec![cells[0]];
        let mut next = 0;
        while let Some(&cell) = reached.get(next) {
            next += 1;
            let id = CellId(u32::try_from(cell).expect("few cells"));
            for side in tessellation.neighbors(id) {
                if let Side::Cell(other) | Side::Image(other, _) = side
                    && of_cell[other.index()] == grain
                    && !reached.contains(&other.index())
                {
                    reached.push(other.index());
                }
            }
        }
        assert_eq!(reached.len(), cells.len(), "grain {grain} is in several pieces");
    }
}

/// The integral of `r r^T` over a cell about a point; in the plane over its area.
fn second_moment(tessellation: &Tessellation, cell: CellId, about: DVec3) -> DMat3 {
    let square = |v: DVec3| DMat3::from_cols(v * v.x, v * v.y, v * v.z);
    let mut sum = DMat3::ZERO;
    for &face in tessellation.cell_faces(cell) {
        let sign = if tessellation.face_sides(face)[0] == Side::Cell(cell) { 1.0 } else { -1.0 };
        let corners = tessellation.face_corners(face);
        let at = |place: usize| tessellation.vertices()[corners[place].index()] - about;
        if corners.len() == 2 {
            let [a, b] = [at(0), at(1)];
            let area = 0.5 * a.truncate().perp_dot(b.truncate());
            sum += (square(a) + square(b) + square(a + b)) * (sign * area / 12.0);
        }
        for last in 2..corners.len() {
            let [a, b, c] = [at(0), at(last - 1), at(last)];
            let volume = a.dot(b.cross(c)) / 6.0;
            sum += (square(a) + square(b) + square(c) + square(a + b + c)) * (sign * volume / 20.0);
        }
    }
    sum
}

/// Of each grain the lengths along the given axes of the ellipsoid with its second moments.
fn lengths(diagram: &GrainDiagram, shapes: &[GrainShape]) -> Vec<DVec3> {
    let (tessellation, of_cell) = (diagram.tessellation(), diagram.grain_of_cell());
    let period = tessellation.domain().size();
    let cells = tessellation.cell_measures();
    let moments = diagram.second_moments();
    let of_grain = |grain: usize| {
        let own: Vec<usize> = (0..of_cell.len()).filter(|cell| of_cell[*cell] as usize == grain).collect();
        // Grains are smaller than half a period, so each cell stands next to the first.
        let near = |place: DVec3, to: DVec3| {
            let away = ((place - to) / period).round() * period;
            DVec3::select(tessellation.domain().periodic(), away, DVec3::ZERO)
        };
        let first = cells[own[0]].centroid;
        let moved: Vec<DVec3> = own.iter().map(|cell| -near(cells[*cell].centroid, first)).collect();
        let volume: f64 = own.iter().map(|cell| cells[*cell].volume).sum();
        let sum: DVec3 =
            own.iter().zip(&moved).map(|(cell, by)| cells[*cell].volume * (cells[*cell].centroid + by)).sum();
        let centroid = sum / volume;
        let moment: DMat3 = own
            .iter()
            .zip(&moved)
            .map(|(cell, by)| {
                second_moment(tessellation, CellId(u32::try_from(*cell).expect("few cells")), centroid - by)
            })
            .fold(DMat3::ZERO, |sum, next| sum + next);
        assert!(moments[grain].abs_diff_eq(moment, 1e-9 * (moment.x_axis.x + moment.y_axis.y)), "{grain}");
        DVec3::from_array([0, 1, 2].map(|axis| {
            let axis = shapes[grain].axes.col(axis);
            axis.dot(moment * axis).max(0.0).sqrt()
        }))
    };
    (0..shapes.len()).map(of_grain).collect()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// As a prototype reached them with 120 to 300 grains in random directions: 1.75 and 2.2 along the wanted axes, 1.94 for plates. Space must be
/// filled.
#[test]
fn long_and_flat_grains_come_near_their_shapes_in_one_piece_each() {
    let square = Domain::unit_square().with_periods(BVec3::new(true, true, false));
    let cases = [
        (periodic_cube(), [2.0, 1.0, 1.0], 1.65),
        (periodic_cube(), [3.0, 1.0, 1.0], 2.1),
        (Domain::unit_cube(), [3.0, 3.0, 1.0], 1.8),
        (square, [3.0, 1.0, 1.0], 2.1),
    ];
    for (domain, wanted, least) in cases {
        let diagram = made(&domain, 120, wanted, 3);
        assert_good(&diagram);
        let lengths = lengths(&diagram, &shapes(&domain, 120, wanted));
        let ratio = |length: &DVec3| match (domain.dimension(), wanted) {
            (Dimension::Two, _) => length.x / length.y,
            (_, [.., 1.0, 1.0]) => length.x / (length.y * length.z).sqrt(),
            _ => (length.x * length.y).sqrt() / length.z,
        };
        let ratio = median(lengths.iter().map(ratio).collect());
        assert!(ratio >= least, "{domain}, {wanted:?}: {ratio}");
    }
}

/// Space is filled by grains that are all long in one direction, so they can be as they should.
#[test]
fn aligned_grains_reach_their_ratio() {
    let domain = Domain::unit_cube();
    let volumes = volumes(&domain, 100);
    let shape = GrainShape { lengths: DVec3::new(1.0, 1.0, 3.0), axes: DMat3::IDENTITY };
    let shapes = vec![shape; 100];
    let mut numbers = fractions(1_000_000, 3);
    let centers = place_ellipsoids(&domain, &volumes, &shapes, || numbers.next().expect("enough numbers"));
    let centers = centers.expect("good volumes");
    let diagram = GrainDiagram::with_shapes(&domain, &centers, &volumes, &shapes);
    let diagram = diagram.expect("volumes are reached").lloyd(3).expect("volumes are kept");
    assert_good(&diagram);
    let lengths = lengths(&diagram, &shapes);
    let ratio = median(lengths.iter().map(|length| length.z / (length.x * length.y).sqrt()).collect());
    assert!((2.0..3.3).contains(&ratio), "{ratio}");
}

#[test]
fn balls_are_the_cells_of_a_power_diagram() {
    let domain = periodic_cube();
    let volumes = volumes(&domain, 60);
    let seeds = random_seeds(60, 2);
    let balls = vec![GrainShape::BALL; 60];
    let diagram = GrainDiagram::with_shapes(&domain, &seeds, &volumes, &balls).expect("volumes are reached");
    let power = voronoi::volumes::PowerDiagram::with_volumes(&domain, &seeds, &volumes);
    let power = power.expect("volumes are reached");
    assert_eq!(diagram.grain_of_cell(), (0..60).collect::<Vec<u32>>());
    for (ours, theirs) in
        diagram.tessellation().cell_measures().iter().zip(power.tessellation().cell_measures())
    {
        assert!(ours.centroid.abs_diff_eq(theirs.centroid, 1e-9));
    }
    assert!(diagram.contrasts().iter().all(|contrast| *contrast == 1.0));
}

#[test]
fn bad_input_is_refused_by_the_number_of_its_grain() {
    let domain = Domain::unit_cube();
    let shapes = [GrainShape::BALL; 2];
    let refused = |seeds: &[DVec3], volumes: &[f64]| {
        GrainDiagram::with_shapes(&domain, seeds, volumes, &shapes[..seeds.len()]).expect_err("bad input")
    };
    let inside = [DVec3::splat(0.3), DVec3::splat(0.6)];
    assert!(matches!(refused(&inside, &[1.0]), VolumesError::Count { seeds: 2, volumes: 1 }));
    assert!(matches!(refused(&inside, &[2.0, -1.0]), VolumesError::BadVolume { grain: 1, .. }));
    assert!(matches!(refused(&inside, &[0.3, 0.3]), VolumesError::BadSum { .. }));
    assert!(matches!(refused(&[inside[0], DVec3::splat(2.0)], &[0.5, 0.5]), VolumesError::Voronoi(_)));
}

/// Grains whose cells fold as they are smoothed could not be given other shapes once.
#[test]
fn single_grains_can_be_made_rounder_at_their_volumes() {
    let domain = periodic_cube();
    let diagram = made(&domain, 60, [3.0, 1.0, 1.0], 1);
    let grain = (0..60).find(|grain| diagram.contrasts()[*grain] == 1.0).expect("not all are rounder");
    let rounder = diagram.rounder([grain]).expect("volumes are kept").expect("it is no ball");
    assert_good(&rounder);
    assert!(rounder.contrasts()[grain] < 1.0);
    let ratio = |diagram: &GrainDiagram| {
        let length = lengths(diagram, &shapes(&domain, 60, [3.0, 1.0, 1.0]))[grain];
        length.x / (length.y * length.z).sqrt()
    };
    assert!(ratio(&rounder) < ratio(&diagram), "{} of {}", ratio(&rounder), ratio(&diagram));
    let balls = GrainDiagram::with_shapes(
        &domain,
        &random_seeds(9, 2),
        &volumes(&domain, 9),
        &[GrainShape { lengths: DVec3::ONE, axes: DMat3::IDENTITY }; 9],
    );
    assert!(balls.expect("volumes are reached").rounder([3]).expect("nothing changes").is_none());
}
