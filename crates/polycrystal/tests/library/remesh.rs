//! Remeshed networks: the same boundaries and volumes, on the smooth surface, with triangles of the size asked for.

use std::collections::BTreeSet;

use crate::common::{Labelled, ball, regular_network, relaxed};
use glam::{BVec3, DVec3};
use polycrystal::{
    BoxCut, ElementSize, Measures, Mesh, Network, NetworkError, Remeshed, measure_network, validate,
};
use subzero::{EdgeId, FaceId};
use voronoi::Domain;

/// The size of elements of which so many edges make the mean equivalent diameter.
fn size(network: &Network, per_diameter: f64) -> ElementSize {
    let volume = network.domain().measure() / network.grain_count() as f64;
    ElementSize::new((6.0 * volume / std::f64::consts::PI).cbrt() / per_diameter)
}

fn triangles(network: &Network) -> &[[u32; 3]] {
    match &network.finest().held().mesh {
        Mesh::Triangles(mesh) => mesh.triangles(),
        Mesh::Segments(_) => panic!("a network in space"),
    }
}

/// The distance of a point from some triangles.
fn distance(point: DVec3, triangles: &[[u32; 3]], points: &[DVec3]) -> f64 {
    let to_segment = |from: DVec3, to: DVec3| {
        let share = ((point - from).dot(to - from) / from.distance_squared(to)).clamp(0.0, 1.0);
        from.lerp(to, share).distance(point)
    };
    let of_triangle = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|corner| points[corner as usize]);
        let normal = (b - a).cross(c - a);
        let is_above = [[a, b], [b, c], [c, a]]
            .iter()
            .all(|[from, to]| normal.dot((to - from).cross(point - from)) >= 0.0);
        let to_plane = normal.normalize().dot(point - a).abs();
        if is_above { to_plane } else { to_segment(a, b).min(to_segment(b, c)).min(to_segment(c, a)) }
    };
    triangles.iter().map(of_triangle).fold(f64::INFINITY, f64::min)
}

/// Numbers of triple lines and quadruple points.
fn junctions(network: &Network, points: &[DVec3]) -> [usize; 2] {
    let Measures::Space(space) = measure_network(network, points) else { panic!("a network in space") };
    [space.triple_lines.len(), space.quadruple_points.len()]
}

/// Everything that holds of every remeshed network.
fn check(network: &Network, points: &[DVec3], size: &ElementSize, remeshed: &Remeshed) {
    let Remeshed { network: new, points: new_points, certificate, .. } = remeshed;
    assert!(certificate.largest_volume_error < 1e-9, "{}", certificate.largest_volume_error);
    assert_eq!(new.boundaries(), network.boundaries());
    assert_eq!(validate(new, new_points).as_ref(), Ok(certificate));
    assert_eq!(junctions(new, new_points), junctions(network, points));
    let per_point = triangles(new).len().div_ceil(100);
    for corners in triangles(new).iter().step_by(per_point) {
        let apart = distance(new_points[corners[0] as usize], triangles(network), points);
        assert!(apart < 0.3 * size.length, "{apart} from the smooth surface");
    }
    let mean = new.mean_edge_length(new_points) / size.length;
    assert!((0.8..1.2).contains(&mean), "mean edge {mean} of the size asked for");
}

#[test]
fn random_grains_keep_boundaries_and_volumes() {
    let (network, flat) = regular_network(&Domain::unit_cube(), 15, 3, 2);
    let points = relaxed(&network, &flat);
    let size = size(&network, 5.0);
    let remeshed = network.remeshed(&points, &size, BVec3::FALSE).expect("remeshed");
    check(&network, &points, &size, &remeshed);
    let quality = remeshed.certificate.triangles.expect("triangles");
    assert!(quality.first_percentile > 25.0, "{quality:?}");
}

#[test]
fn threads_do_not_change_a_bit() {
    let (network, flat) = regular_network(&Domain::unit_cube(), 8, 4, 2);
    let points = relaxed(&network, &flat);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| network.remeshed(&points, &size(&network, 4.0), BVec3::FALSE).expect("remeshed"))
    };
    let (one, two) = (with(1), with(2));
    assert_eq!(one.points, two.points);
    assert_eq!(one.network, two.network);
}

#[test]
fn periodic_copies_are_the_same_bit_for_bit() {
    let domain = Domain::cuboid(DVec3::new(-1.0, 0.3, 2.0), DVec3::new(0.3, 1.7, 3.1)).expect("a box");
    let domain = domain.with_periods(BVec3::new(true, true, false));
    let (network, flat) = regular_network(&domain, 20, 2, 2);
    let points = relaxed(&network, &flat);
    let size = size(&network, 5.0);
    let remeshed = network.remeshed(&points, &size, BVec3::FALSE).expect("remeshed");
    check(&network, &points, &size, &remeshed);
    let copies = &remeshed.network.finest().held().copies.vertices;
    assert!(copies.len() > 50);
    for pair in copies {
        let [secondary, primary] =
            [pair.secondary, pair.primary].map(|point| remeshed.points[point as usize]);
        assert_eq!(secondary, primary + pair.translation.vector(&domain));
    }
}

#[test]
fn opposite_walls_of_a_cut_box_stay_the_same() {
    let domain = Domain::unit_cube().with_periods(BVec3::TRUE);
    for seed in 1..=3 {
        let (network, flat) = regular_network(&domain, 20, seed, 2);
        let BoxCut { network: cut, points, .. } =
            network.cut_at_box(&relaxed(&network, &flat), false).expect("cut");
        let cut = cut.with_cell_volumes(network.cell_volumes().to_vec());
        let remeshed = cut.remeshed(&points, &size(&network, 5.0), BVec3::TRUE).expect("remeshed");
        assert!(remeshed.certificate.largest_volume_error < 1e-9);
        // Walls have long edges on the smooth network: segments as small as at their ends all along would be strips of narrow triangles.
        let quality = remeshed.certificate.triangles.expect("triangles");
        assert!(quality.first_percentile > 20.0, "{quality:?}");
        for axis in 0..3 {
            let on = |wall: f64| {
                let on_wall = remeshed.points.iter().filter(|point| point[axis] == wall);
                let bits = on_wall.map(|point| [1, 2].map(|other| point[(axis + other) % 3].to_bits()));
                bits.collect::<BTreeSet<_>>()
            };
            assert!(on(0.0).len() > 20 && on(0.0) == on(1.0));
        }
    }
}

/// A grain within another has a boundary without lines, and walls of two triangles have lines of one step.
#[test]
fn a_ball_and_the_walls_around_it_get_elements_of_their_own() {
    let (points, faces) = ball(0.3, DVec3::splat(0.5), 3);
    let (network, points) = Labelled::inclusion(&points, &faces).network(0).expect("a ball in a cube");
    let size = ElementSize::new(0.12);
    let remeshed = network.remeshed(&points, &size, BVec3::FALSE).expect("remeshed");
    check(&network, &points, &size, &remeshed);
    let quality = remeshed.certificate.triangles.expect("triangles");
    assert!(quality.least > 25.0, "{quality:?}");
}

#[test]
fn curved_boundaries_get_small_elements_where_asked() {
    let (points, faces) = ball(0.2, DVec3::splat(0.5), 4);
    let (network, points) = Labelled::inclusion(&points, &faces).network(0).expect("a ball in a cube");
    let size = ElementSize { of_radius: Some(0.3), ..ElementSize::new(0.2) };
    let remeshed = network.remeshed(&points, &size, BVec3::FALSE).expect("remeshed");
    let is_on_ball = |corners: &&[u32; 3]| {
        corners.iter().all(|corner| remeshed.points[*corner as usize].distance(DVec3::splat(0.5)) < 0.25)
    };
    let count = triangles(&remeshed.network).iter().filter(is_on_ball).count();
    // 4 pi r^2 in equilateral triangles with edges of 0.3 r: 322.
    assert!((200..500).contains(&count), "{count}");
}

/// What vertices, edges and triangles of each grain add up to: 2 of a ball, and less where its surface touches itself.
fn euler_numbers(network: &Network) -> Vec<i64> {
    let mut parts = vec![(BTreeSet::new(), BTreeSet::new(), 0i64); network.grain_count()];
    let level = network.finest();
    for (triangle, corners) in (0u32..).zip(triangles(network)) {
        for (grain, _) in network.boundaries()[level.boundary(triangle).index()].signed_grains() {
            let (vertices, edges, count) = &mut parts[grain.index()];
            vertices.extend(*corners);
            let [a, b, c] = *corners;
            edges.extend([[a, b], [b, c], [c, a]].map(|[from, to]| [from.min(to), from.max(to)]));
            *count += 1;
        }
    }
    let number = |count: usize| i64::try_from(count).expect("a small network");
    parts
        .iter()
        .map(|(vertices, edges, count)| number(vertices.len()) - number(edges.len()) + count)
        .collect()
}

#[test]
fn short_lines_become_points_and_grains_stay_balls() {
    for periods in [BVec3::FALSE, BVec3::new(true, true, false), BVec3::TRUE] {
        let (network, flat) = regular_network(&Domain::unit_cube().with_periods(periods), 40, 3, 2);
        let points = relaxed(&network, &flat);
        let keeping = size(&network, 1.2);
        let merging = ElementSize { merges_short_lines: true, ..keeping };
        let kept = network.remeshed(&points, &keeping, BVec3::FALSE).expect("remeshed");
        let remeshed = network.remeshed(&points, &merging, BVec3::FALSE).expect("remeshed");
        assert!(kept.merged.is_empty() && !remeshed.merged.is_empty());
        assert!(remeshed.certificate.largest_volume_error < 1e-9);
        assert!(triangles(&remeshed.network).len() < triangles(&kept.network).len());
        assert_eq!(euler_numbers(&remeshed.network), euler_numbers(&network));
        let [lines, _] = junctions(&network, &points);
        let counted = remeshed.network.junction_counts();
        assert_eq!(
            [counted.triple_lines, counted.quadruple_points],
            junctions(&remeshed.network, &remeshed.points)
        );
        assert_eq!(counted.triple_lines, lines - remeshed.merged.len());
        for line in &remeshed.merged {
            assert!(line.length < 0.5 * merging.length && line.grains.len() >= 2, "{line:?}");
            let moved = remeshed.points.iter().map(|point| point.distance(line.place));
            assert!(moved.fold(f64::INFINITY, f64::min) < 0.2 * merging.length, "{line:?}");
        }
    }
}

/// Where a line that became a point folds something, it stays a line after all. These boxes found no valid mesh: each of many faults beside each other made
/// elements half as large as the others had, and lines nearby became points instead.
#[test]
fn short_lines_of_cut_boxes_become_points_where_nothing_folds() {
    for random_seed in [24, 40, 44] {
        let (network, flat) =
            regular_network(&Domain::unit_cube().with_periods(BVec3::TRUE), 20, random_seed, 2);
        let BoxCut { network: cut, points, .. } =
            network.cut_at_box(&relaxed(&network, &flat), false).expect("cut");
        let cut = cut.with_cell_volumes(network.cell_volumes().to_vec());
        let size = ElementSize { merges_short_lines: true, ..size(&network, 1.5) };
        let remeshed = cut.remeshed(&points, &size, BVec3::TRUE).expect("remeshed");
        assert!(!remeshed.merged.is_empty());
        assert!(remeshed.certificate.largest_volume_error < 1e-9);
        assert_eq!(euler_numbers(&remeshed.network), euler_numbers(&cut));
        for axis in 0..3 {
            let on = |wall: f64| {
                let on_wall = remeshed.points.iter().filter(|point| point[axis] == wall);
                let bits = on_wall.map(|point| [1, 2].map(|other| point[(axis + other) % 3].to_bits()));
                bits.collect::<BTreeSet<_>>()
            };
            assert_eq!(on(0.0), on(1.0));
        }
    }
}

#[test]
fn sizes_that_are_none_are_refused() {
    let (network, flat) = regular_network(&Domain::unit_cube(), 3, 1, 0);
    let points = network.subdivide(&flat);
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = network.remeshed(&points, &ElementSize::new(bad), BVec3::FALSE);
        assert!(matches!(error, Err(NetworkError::BadElementSize(_))), "{bad}");
    }
}

/// Opposite walls of grains that are not periodic differ.
#[test]
fn walls_without_copies_are_named() {
    let (network, points) = regular_network(&Domain::unit_cube(), 5, 1, 1);
    let error = network.remeshed(&network.subdivide(&points), &ElementSize::new(0.2), BVec3::TRUE);
    assert!(matches!(error, Err(NetworkError::NoCopyOnWall { .. })), "{error:?}");
}

#[test]
fn curved_boundaries_lie_on_the_smooth_surface_and_keep_volumes() {
    let periods = [BVec3::FALSE, BVec3::new(true, true, false)];
    for domain in periods.map(|periods| Domain::unit_cube().with_periods(periods)) {
        let (network, flat) = regular_network(&domain, 15, 3, 2);
        let points = relaxed(&network, &flat);
        let size = ElementSize { has_middles: true, ..size(&network, 4.0) };
        let remeshed = network.remeshed(&points, &size, BVec3::FALSE).expect("remeshed");
        let (new, new_points) = (&remeshed.network, remeshed.points.as_slice());
        let Mesh::Triangles(mesh) = &new.finest().held().mesh else { panic!("a network in space") };
        let mut curved = remeshed.curved.clone().expect("curved boundaries");
        let straight = |corners: &[DVec3]| -> Vec<DVec3> {
            mesh.edges()
                .map(|ends| ends.map(|end| corners[end as usize]))
                .map(|[a, b]| a.midpoint(b))
                .collect()
        };
        let largest_error = |volumes: &[f64]| {
            let relative = volumes.iter().zip(new.cell_volumes()).map(|(is, cell)| (is / cell - 1.0).abs());
            relative.fold(0.0, f64::max)
        };
        // Before any motion quadratic triangles err by a fraction of what straight ones do before theirs.
        let before = largest_error(&curved.grain_volumes(new));
        assert!((1e-9..5e-3).contains(&before), "{before}");
        assert!(curved.restore_volumes(new) < 1e-12);
        assert!(largest_error(&curved.grain_volumes(new)) < 1e-12);
        let rms = |places: &[DVec3]| {
            let some = places.iter().step_by(places.len().div_ceil(200));
            let squares = some.clone().map(|place| distance(*place, triangles(&network), &points).powi(2));
            (squares.sum::<f64>() / some.count() as f64).sqrt() / size.length
        };
        let chords = rms(&straight(curved.corners()));
        for places in [curved.corners(), curved.middles()] {
            assert!(rms(places) < 0.05 * chords, "{} of {chords} from the smooth surface", rms(places));
        }
        assert!(rms(new_points) > 0.2 * chords, "corners of flat triangles keep volumes beside it");

        // Straight where it is asked for, there and at copies, and grains still have their volumes.
        let asked: Vec<EdgeId> = (0u32..).take(mesh.edge_count()).step_by(7).map(EdgeId).collect();
        let corners: Vec<u32> = (0u32..).take(new_points.len()).step_by(5).collect();
        curved.straighten(new, new_points, corners.iter().copied(), asked.iter().copied());
        assert!(curved.restore_volumes(new) < 1e-12);
        for corner in corners {
            assert_eq!(curved.corners()[corner as usize], new_points[corner as usize]);
        }
        let straight = straight(curved.corners());
        for edge in asked {
            assert!(curved.is_straight(edge));
            assert!(curved.middles()[edge.index()].distance(straight[edge.index()]) < 1e-15);
        }
        for pair in &new.finest().held().copies.vertices {
            let [copy, original] =
                [pair.secondary, pair.primary].map(|corner| curved.corners()[corner as usize]);
            assert_eq!(copy, original + pair.translation.vector(&domain));
        }
        // What is on a wall stays there.
        let level = new.finest();
        for (triangle, corners) in (0u32..).zip(triangles(new)) {
            if new.boundaries()[level.boundary(triangle).index()].wall.is_none() {
                continue;
            }
            let [a, b, c] = corners.map(|corner| new_points[corner as usize]);
            let axis =
                (0..3).find(|axis| a[*axis] == b[*axis] && b[*axis] == c[*axis]).expect("walls of a box");
            for edge in mesh.triangle_edges(FaceId(triangle)) {
                assert_eq!(curved.middles()[edge.index()][axis], a[axis]);
            }
        }
    }
}
