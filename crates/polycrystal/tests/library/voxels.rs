//! Networks of labelled voxels: each voxel in its grain, volumes of its voxels, nothing open and nothing crossed, whatever the labels.

use std::f64::consts::PI;

use glam::{BVec3, DVec3};
use polycrystal::{
    Elements, Expected, Fault, GrainId, NetworkError, Side, SmoothedVoxels, Surface, VoxelLabel,
    VoxelOptions, VoxelTuning, Voxels, certify, smooth_voxels, smooth_voxels_tuned, validate,
};
use proptest::prelude::*;
use voronoi::Domain;

use crate::inclusions::fractions;

fn voxels(spacing: DVec3, shape: [usize; 3], label: impl Fn([usize; 3]) -> Option<u32>) -> Voxels {
    let size = DVec3::from_array(shape.map(|count| count as f64)) * spacing;
    let lower = DVec3::new(-1.0, 2.0, 0.5);
    let domain = match shape[2] {
        1 => Domain::rectangle(lower.with_z(0.0), (lower + size).with_z(0.0)),
        _ => Domain::cuboid(lower, lower + size),
    };
    let [width, height, depth] = shape;
    let all = (0..depth).flat_map(|z| (0..height).flat_map(move |y| (0..width).map(move |x| [x, y, z])));
    let labels =
        all.map(|voxel| label(voxel).map_or(VoxelLabel::EXTERIOR, |grain| VoxelLabel::of(GrainId(grain))));
    Voxels::new(domain.expect("a box"), shape, labels.collect())
}

fn smoothed(voxels: &Voxels) -> SmoothedVoxels {
    smooth_voxels(voxels.clone(), VoxelOptions::ALL_POINTS, |_, _| ()).expect("a network")
}

/// The share of the full angle that a grain's elements are seen under from a point: 1 inside, 0 outside.
fn winding(surface: &Surface<'_>, grain: GrainId, from: DVec3) -> f64 {
    let count = u32::try_from(surface.elements.len()).expect("few elements");
    let turns = (0..count).map(|element| {
        let sign = match surface.sides_of(element).map(|side| side == Side::Grain(grain)) {
            [true, false] => 1.0,
            [false, true] => -1.0,
            _ => return 0.0,
        };
        let at = |corner: u32| (surface.points[corner as usize] - from).normalize();
        sign * match surface.elements {
            Elements::Triangles(triangles) => {
                // van Oosterom and Strackee, 1983.
                let [a, b, c] = triangles[element as usize].map(at);
                2.0 * a.dot(b.cross(c)).atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a)) / (4.0 * PI)
            }
            Elements::Refined(_) => unreachable!("the level is held"),
            Elements::Segments(segments) => {
                let [a, b] = segments[element as usize].map(at);
                a.cross(b).z.atan2(a.dot(b)) / (2.0 * PI)
            }
        }
    });
    turns.sum()
}

/// Closed, wound right, free of crossings, with the volumes that it states.
fn check_surface(SmoothedVoxels { network, points, .. }: &SmoothedVoxels) {
    let sides = network.sides();
    let surface = Surface::of_level(network.finest(), points, &sides);
    let volumes: Vec<_> = (0..).map(GrainId).zip(network.cell_volumes().iter().copied()).collect();
    let expected = Expected { grain_volumes: Some(&volumes), ..Expected::default() };
    let mut faults = certify(&surface, &expected).faults;
    faults.0.retain(|fault| !matches!(fault, Fault::Folded { .. }));
    assert!(faults.0.is_empty(), "{faults}");
}

/// That, points in the boxes of places between voxels, and every voxel in its grain unless it was relabelled, and volumes those of the voxels then.
fn check(voxels: &Voxels, smoothed: &SmoothedVoxels) {
    check_surface(smoothed);
    let SmoothedVoxels { network, points, relabelled, .. } = smoothed;
    let [lower, size] = [voxels.domain().lower(), voxels.domain().size()];
    let counts = DVec3::from_array(voxels.shape().map(|count| count as f64));
    for point in points {
        let place = (*point - lower) / size.max(DVec3::splat(1e-300)) * counts;
        let off = (place - place.round()).abs();
        assert!(off.x.max(off.y).max(if size.z > 0.0 { off.z } else { 0.0 }) < 0.49 + 1e-9, "{place}");
    }
    let sides = network.sides();
    let surface = Surface::of_level(network.finest(), points, &sides);
    let volumes: Vec<_> = (0..).map(GrainId).zip(network.cell_volumes().iter().copied()).collect();
    let domain = voxels.domain();
    let [width, height, depth] = voxels.shape();
    let spacing = domain.size() / DVec3::new(width as f64, height as f64, depth as f64);
    let volume = if depth == 1 { spacing.x * spacing.y } else { spacing.element_product() };
    let mut moved = 0;
    let mut counts = vec![0.0; volumes.len()];
    for (index, label) in voxels.labels().iter().enumerate() {
        let voxel = [index % width, index / width % height, index / width / height];
        let center = domain.lower() + (DVec3::from_array(voxel.map(|at| at as f64)) + 0.5) * spacing;
        let center = if depth == 1 { center.with_z(0.0) } else { center };
        let mut inside = volumes.iter().filter(|(grain, _)| winding(&surface, *grain, center) > 0.5);
        let found = inside.next().map_or(Side::Exterior, |(grain, _)| Side::Grain(*grain));
        assert!(inside.next().is_none(), "two grains hold voxel {voxel:?}");
        moved += usize::from(found != label.side());
        if let Side::Grain(grain) = found {
            counts[grain.index()] += volume;
        }
    }
    assert!(moved <= *relabelled, "{moved} voxels in other grains, {relabelled} relabelled");
    for ((grain, found), count) in volumes.iter().zip(counts) {
        assert!((found / count - 1.0).abs() < 1e-9, "{grain:?} has {found}, its voxels {count}");
    }
}

/// Eleven by ten voxels in each layer, each in the grain of the seed nearest to it; the edge of the seeds' cube is ten voxels.
fn nearest_seeds(seeds: &[[f64; 3]], depth: usize) -> Voxels {
    let seeds: Vec<DVec3> = seeds.iter().map(|seed| DVec3::from_array(*seed) * 10.0).collect();
    nearest_of(&seeds, [11, 10, depth])
}

/// Voxels, each in the grain of the seed nearest to it; one grain for each seed that is nearest to any.
fn nearest_of(seeds: &[DVec3], shape: [usize; 3]) -> Voxels {
    let nearest = |voxel: [usize; 3]| {
        let place = DVec3::from_array(voxel.map(|at| at as f64)) + 0.5;
        let squared = |seed: &usize| place.distance_squared(seeds[*seed]);
        (0..seeds.len()).min_by(|a, b| squared(a).total_cmp(&squared(b))).expect("a seed")
    };
    let mut known = std::collections::BTreeMap::new();
    let [width, height, depth] = shape;
    let mut labels = Vec::new();
    for index in 0..width * height * depth {
        let count = u32::try_from(known.len()).expect("few grains");
        let voxel = [index % width, index / width % height, index / width / height];
        labels.push(*known.entry(nearest(voxel)).or_insert(count));
    }
    voxels(DVec3::ONE, shape, |[x, y, z]| Some(labels[(z * height + y) * width + x]))
}

/// In single precision 0.49 is larger by 1e-8: a point at the side of its box was outside by that.
#[test]
fn points_at_the_sides_of_their_boxes_are_inside() {
    let seeds = [
        [0.7313824856514416, 0.9486347145654053, 0.0],
        [0.4804714802960406, 0.31733269000241127, 0.48480160982365456],
    ];
    let map = nearest_seeds(&seeds, 1);
    check(&map, &smoothed(&map));
}

/// Flat boundaries across an axis stay where they are, to the last place.
#[test]
fn layers_stay_flat() {
    let spacing = DVec3::new(0.25, 0.5, 2.0);
    for shape in [[6, 4, 3], [6, 4, 1]] {
        let map = voxels(spacing, shape, |[x, _, _]| Some(u32::from(x > 1) + u32::from(x > 3)));
        let smoothed = smoothed(&map);
        check(&map, &smoothed);
        assert_eq!(smoothed.relabelled, 0);
        for boundary in [0.5, 1.0] {
            let at = |point: &&DVec3| (point.x - (boundary - 1.0)).abs() < 1e-9;
            let on_layer = smoothed.points.iter().filter(at).count();
            assert_eq!(on_layer, if shape[2] == 1 { 5 } else { 20 });
        }
    }
}

/// A plane that cuts the lattice at an angle: its staircase becomes a plane again, beside walls too.
#[test]
fn staircase_of_a_plane_becomes_flat() {
    let normal = DVec3::new(1.0, 0.36, 0.21).normalize();
    let shape = [24, 24, 24];
    let offset = normal.dot(DVec3::splat(12.0));
    let is_above = |voxel: [usize; 3]| {
        let center = DVec3::from_array(voxel.map(|at| at as f64)) + 0.5;
        normal.dot(center) > offset
    };
    let map = voxels(DVec3::ONE, shape, |voxel| Some(u32::from(is_above(voxel))));
    let SmoothedVoxels { network, points, .. } = smoothed(&map);
    let level = network.finest().held();
    let polycrystal::Mesh::Triangles(mesh) = &level.mesh else { panic!("a map in space") };
    let (mut sum, mut worst, mut count) = (0.0, 0.0f64, 0);
    for (triangle, boundary) in mesh.triangles().iter().zip(&level.boundary_of) {
        if network.boundaries()[boundary.index()].wall.is_some() {
            continue;
        }
        let [a, b, c] = triangle.map(|corner| points[corner as usize] - map.domain().lower());
        let angle = (b - a).cross(c - a).normalize().dot(normal).abs().min(1.0).acos().to_degrees();
        (sum, worst, count) = (sum + angle, worst.max(angle), count + 1);
    }
    assert!(count > 1000);
    // The staircase itself is 41 degrees off in the mean: each axis by the angle to the normal, weighed by its share of it.
    let mean = sum / f64::from(count);
    assert!(mean < 1.5 && worst < 8.0, "mean {mean}, worst {worst}");
}

#[test]
fn pores_grains_in_grains_and_bodies_in_nothing() {
    let ball = |voxel: [usize; 3], radius: f64| {
        (DVec3::from_array(voxel.map(|at| at as f64)) + 0.5).distance(DVec3::splat(6.0)) < radius
    };
    let shape = [12, 12, 12];
    let pore = voxels(DVec3::ONE, shape, |voxel| (!ball(voxel, 3.2)).then_some(0));
    let inclusion = voxels(DVec3::ONE, shape, |voxel| Some(u32::from(ball(voxel, 3.2))));
    let body = voxels(DVec3::ONE, shape, |voxel| ball(voxel, 4.6).then_some(u32::from(voxel[0] > 5)));
    for (map, counts) in [(&pore, [1, 0]), (&inclusion, [2, 0]), (&body, [2, 1])] {
        let smoothed = smoothed(map);
        check(map, &smoothed);
        assert_eq!(smoothed.network.cell_volumes().len(), counts[0]);
        assert_eq!(smoothed.network.junction_counts().triple_lines, counts[1]);
    }
}

/// Two grains that take turns touch along every edge and in every point: voxels are relabelled until none does.
#[test]
fn checkerboard_is_parted() {
    for shape in [[4, 4, 4], [5, 3, 2], [5, 4, 1]] {
        let map = voxels(DVec3::ONE, shape, |[x, y, z]| Some(u32::from((x + y + z) % 2 == 1)));
        check(&map, &smoothed(&map));
    }
}

#[test]
fn labels_without_grains_or_with_gaps_are_refused() {
    let smooth = |map: &Voxels| {
        smooth_voxels(map.clone(), VoxelOptions::ALL_POINTS, |_, _| ()).expect_err("no network")
    };
    let empty = voxels(DVec3::ONE, [3, 3, 3], |_| None);
    assert!(matches!(smooth(&empty), NetworkError::NoGrain));
    for largest in [2, u32::MAX - 1] {
        let gap = voxels(DVec3::ONE, [3, 3, 3], |[x, _, _]| Some(if x == 0 { 0 } else { largest }));
        assert!(matches!(smooth(&gap), NetworkError::MissingGrain { grain: GrainId(1) }));
    }
}

/// The same map in another unit gives the same network in that unit, and any number of threads the same bits.
#[test]
fn units_and_threads_change_nothing() {
    let label = |[x, y, z]: [usize; 3]| u32::try_from((x * x + 3 * y * z + y) / 17 % 3).ok();
    let map = voxels(DVec3::ONE, [9, 8, 7], label);
    let one = smoothed(&map);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    assert_eq!(pool.install(|| smoothed(&map)).points, one.points);
    let scaled = voxels(DVec3::splat(4.0), [9, 8, 7], label);
    let other = smoothed(&scaled);
    for (point, other) in one.points.iter().zip(&other.points) {
        let [point, other] =
            [(point, &map), (other, &scaled)].map(|(point, map)| *point - map.domain().lower());
        assert!((point * 4.0).distance(other) < 1e-12);
    }
}

/// A network without the edges that are shorter than so many voxels.
fn decimated(voxels: &Voxels, shortest_edge: f64) -> Result<SmoothedVoxels, NetworkError> {
    let options = VoxelOptions { shortest_edge, ..VoxelOptions::ALL_POINTS };
    smooth_voxels(voxels.clone(), options, |_, _| ())
}

/// Balls in a ball's place: large grains beside small ones and a pore. Volumes hold exactly, and of large boundaries a small part of the elements is left.
#[test]
fn short_edges_collapse_and_volumes_stay() {
    for (shape, at_most) in [([28, 28, 28], 0.16), ([60, 60, 1], 0.5)] {
        let size = DVec3::from_array(shape.map(|count| count as f64));
        let is_in = |voxel: [usize; 3], at: [f64; 3], radius: f64| {
            let away = DVec3::from_array(voxel.map(|at| at as f64)) + 0.5 - DVec3::from_array(at) * size;
            if shape[2] == 1 { away.with_z(0.0).length() < radius } else { away.length() < radius }
        };
        let map = voxels(DVec3::new(0.5, 0.5, 0.8), shape, |voxel @ [x, y, _]| match voxel {
            _ if is_in(voxel, [0.3, 0.3, 0.5], 6.0) => Some(3),
            _ if is_in(voxel, [0.7, 0.7, 0.5], 4.0) => None,
            _ if is_in(voxel, [0.5, 0.9, 0.5], 1.1) => Some(4),
            _ if 2 * x > y + 14 => Some(if 3 * y > x + 20 { 0 } else { 1 }),
            _ => Some(2),
        });
        let whole = smoothed(&map);
        let [two, three] = [2.0, 3.0].map(|length| decimated(&map, length).expect("a network"));
        let count = |found: &SmoothedVoxels| found.network.finest().element_count() as f64;
        for found in [&two, &three] {
            check_surface(found);
            assert_eq!(found.network.cell_volumes(), whole.network.cell_volumes());
            // Points nearer than that may become one.
            let [left, all] = [found, &whole].map(|of| of.network.junction_counts());
            assert_eq!(left.triple_lines, all.triple_lines);
            assert!(
                left.quadruple_points <= all.quadruple_points
                    && left.quadruple_points + 1 >= all.quadruple_points
            );
        }
        assert!(count(&three) < count(&two), "{} and {}", count(&three), count(&two));
        assert!(count(&two) < at_most * count(&whole), "{} of {}", count(&two), count(&whole));
        // The least grain has too few voxels to lose any edge: a ball of 8 of them keeps its shape.
        let of_least = |found: &SmoothedVoxels| {
            let sides = found.network.sides();
            let level = found.network.finest();
            let surface = Surface::of_level(level, &found.points, &sides);
            let all = 0..u32::try_from(surface.elements.len()).expect("few elements");
            all.filter(|element| surface.sides_of(*element).contains(&Side::Grain(GrainId(4)))).count()
        };
        assert_eq!(of_least(&two), of_least(&whole));
    }
}

/// Flat boundaries of small grains. Where volumes make them cross, points stay; where collapses do, all is decimated once more without these. Before, all was decimated
/// anew for either, and in the end nothing was.
#[test]
fn points_around_crossings_stay() {
    let options = VoxelOptions { shortest_edge: 2.0, ..VoxelOptions::ALL_POINTS };
    for (start, decimations) in [(18, 2), (32, 2), (57, 1), (230, 1)] {
        let tuning = VoxelTuning { decimations, ..VoxelTuning::default() };
        let mut fraction = fractions(start);
        let mut seed = || DVec3::new(fraction(), fraction(), fraction()) * 24.0;
        let seeds: Vec<DVec3> = (0..60).map(|_| seed()).collect();
        let map = nearest_of(&seeds, [24, 24, 24]);
        let few = smooth_voxels_tuned(map.clone(), options, &tuning, &|_, _| ()).expect("a network");
        let all = smoothed(&map);
        check_surface(&few);
        assert!(4 * few.points.len() < all.points.len(), "{} of {}", few.points.len(), all.points.len());
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Noise is the worst of maps: every grain in many pieces of one voxel. One in two thousand is refused.
    #[test]
    fn any_labels_give_a_closed_network_or_are_refused(
        shape in [1usize..7, 1usize..7, 1usize..7],
        numbers in prop::collection::vec(0u32..5, 216),
        grains in 1u32..5,
        has_pores: bool,
    ) {
        let [width, height, depth] = shape;
        let mut known = std::collections::BTreeMap::new();
        let labels: Vec<Option<u32>> = numbers[..width * height * depth]
            .iter()
            .map(|number| {
                let count = u32::try_from(known.len()).unwrap();
                let is_pore = has_pores && *number >= grains;
                (!is_pore).then(|| *known.entry(number % grains).or_insert(count))
            })
            .collect();
        prop_assume!(!known.is_empty());
        let map = voxels(DVec3::new(1.0, 2.0, 0.5), shape, |[x, y, z]| labels[(z * height + y) * width + x]);
        match smooth_voxels(map.clone(), VoxelOptions::ALL_POINTS, |_, _| ()) {
            Ok(smoothed) => check(&map, &smoothed),
            Err(NetworkError::VoxelsTouch { .. } | NetworkError::Invalid(_)) => (),
            Err(other) => prop_assert!(false, "{other}"),
        }
    }

    /// The same when edges collapse: what a fault would come of stays as it is.
    #[test]
    fn any_labels_can_be_decimated(
        shape in [2usize..8, 2usize..8, 1usize..8],
        numbers in prop::collection::vec(0u32..3, 8),
        shortest_edge in 0.5..4.0f64,
    ) {
        let [width, height, _] = shape;
        // Blocks of two by two voxels with some noise, so that there are edges that may collapse.
        let label = |[x, y, z]: [usize; 3]| {
            let block = (x / 2 + 3 * (y / 2) + 5 * (z / 2)) % 8;
            numbers[if (x * 7 + y * 5 + z * 3) % 11 == 0 { (block + 1) % 8 } else { block }]
        };
        let mut known = std::collections::BTreeMap::new();
        for index in 0..shape.iter().product() {
            let count = u32::try_from(known.len()).unwrap();
            known.entry(label([index % width, index / width % height, index / width / height])).or_insert(count);
        }
        let map = voxels(DVec3::ONE, shape, |voxel| Some(known[&label(voxel)]));
        match (smooth_voxels(map.clone(), VoxelOptions::ALL_POINTS, |_, _| ()), decimated(&map, shortest_edge)) {
            (Ok(whole), Ok(found)) => {
                check_surface(&found);
                prop_assert!(found.points.len() <= whole.points.len());
                prop_assert_eq!(found.network.cell_volumes(), whole.network.cell_volumes());
            }
            (Err(_), Err(_)) => (),
            (whole, found) => prop_assert!(false, "{:?} and {:?}", whole.is_ok(), found.is_ok()),
        }
    }

    /// Large grains, as seeds that are not resolved leave them.
    #[test]
    fn nearest_seeds_give_a_closed_network(
        seeds in prop::collection::vec([0.0..1.0f64, 0.0..1.0, 0.0..1.0], 2..12),
        depth in prop::sample::select(vec![1usize, 9]),
    ) {
        let map = nearest_seeds(&seeds, depth);
        let smoothed = smoothed(&map);
        prop_assert!(smoothed.relabelled < 10);
        check(&map, &smoothed);
    }
}

/// Relabelling of these ends, as in turn all voxels around a place give way: one that alone did went back and forth between two labels.
#[test]
fn noise_that_touches_itself_is_parted() {
    for (edge, seed) in [(5, 33), (6, 0)] {
        let mut state: u64 = seed;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            u32::try_from((state >> 33) % 4).expect("a small number")
        };
        let noise: Vec<u32> = (0..edge * edge * edge).map(|_| next()).collect();
        let map = voxels(DVec3::ONE, [edge; 3], |[x, y, z]| Some(noise[(z * edge + y) * edge + x]));
        let found = smoothed(&map);
        assert!(found.relabelled > 0);
        check(&map, &found);
    }
}

#[test]
fn grains_of_one_voxel_leave_other_boundaries_smooth() {
    // A slanted boundary, with single voxels of noise far from it, side by side, corner to corner and alone.
    for (shape, noise) in [
        ([40, 40, 1], &[[4, 30, 0], [5, 31, 0], [9, 35, 0], [10, 35, 0], [30, 6, 0]][..]),
        ([20, 20, 8], &[[3, 15, 4], [4, 16, 4], [3, 15, 5], [16, 3, 2]][..]),
    ] {
        let slanted = |[x, y, _]: [usize; 3]| u32::from(3 * x > 2 * y + 5);
        let clean = smoothed(&voxels(DVec3::ONE, shape, |voxel| Some(slanted(voxel))));
        let noisy = voxels(DVec3::ONE, shape, |voxel| {
            let speck = noise.iter().position(|speck| *speck == voxel);
            Some(speck.map_or(slanted(voxel), |speck| 2 + u32::try_from(speck).expect("a few")))
        });
        let found = smoothed(&noisy);
        check(&noisy, &found);
        assert_eq!(found.relabelled, 0);
        for point in &clean.points {
            let nearest =
                found.points.iter().map(|other| other.distance(*point)).fold(f64::INFINITY, f64::min);
            assert!(nearest < 1e-3, "{shape:?}: {point} is {nearest} away");
        }
    }
}

/// Grains of the seeds that are nearest through the sides of the box along some axes, shifted by so many voxels.
fn repeating(seeds: &[[f64; 3]], shape: [usize; 3], axes: BVec3, shift: [usize; 3]) -> Voxels {
    let size = DVec3::from_array(shape.map(|count| count as f64));
    let nearest = |voxel: [usize; 3]| {
        let place = DVec3::from_array([0, 1, 2].map(|k| ((voxel[k] + shift[k]) % shape[k]) as f64)) + 0.5;
        let distance = |seed: &[f64; 3]| {
            let straight = (place - DVec3::from_array(*seed) * size).abs();
            DVec3::select(axes, straight.min(size - straight), straight).length_squared()
        };
        (0..seeds.len()).min_by(|a, b| distance(&seeds[*a]).total_cmp(&distance(&seeds[*b]))).expect("seeds")
    };
    let mut known = std::collections::BTreeMap::new();
    for index in 0..shape.iter().product() {
        let count = u32::try_from(known.len()).expect("few grains");
        let [width, height, _] = shape;
        known
            .entry(nearest([index % width, index / width % height, index / width / height]))
            .or_insert(count);
    }
    let map = voxels(DVec3::new(1.0, 0.5, 2.0), shape, |voxel| Some(known[&nearest(voxel)]));
    Voxels::new(map.domain().clone().with_periods(axes), shape, map.labels().to_vec())
}

/// Whole grains, valid together, with the volumes of their voxels, each of which is in its grain or in an image of it, and in no other.
fn check_repeating(map: &Voxels, found: &SmoothedVoxels) {
    let SmoothedVoxels { network, points, .. } = found;
    if found.certificate.is_good() {
        assert!(validate(network, points).is_ok());
    }
    let sides = network.sides();
    let surface = Surface::of_level(network.finest(), points, &sides);
    let (domain, shape) = (map.domain(), map.shape());
    let counts = DVec3::from_array(shape.map(|count| count as f64));
    let spacing = domain.size() / counts;
    let mut volumes = vec![0.0; network.grain_count()];
    let images = |axis: usize| if domain.periodic().test(axis) { -1..=1 } else { 0..=0 };
    for (index, label) in map.labels().iter().enumerate() {
        let voxel = [index % shape[0], index / shape[0] % shape[1], index / shape[0] / shape[1]];
        let center = domain.lower() + (DVec3::from_array(voxel.map(|at| at as f64)) + 0.5) * spacing;
        let own = label.side().grain().expect("no pores");
        volumes[own.index()] += if shape[2] == 1 { spacing.x * spacing.y } else { spacing.element_product() };
        // A part of them will do.
        for grain in (0..).take(if index % 41 == 0 { volumes.len() } else { 0 }).map(GrainId) {
            let mut turns = 0.0;
            for x in images(0) {
                for y in images(1) {
                    for z in images(2) {
                        let period = DVec3::new(f64::from(x), f64::from(y), f64::from(z)) * domain.size();
                        turns += winding(&surface, grain, center + period);
                    }
                }
            }
            assert!((turns - f64::from(grain == own)).abs() < 1e-6, "{voxel:?}: {turns} in {grain:?}");
        }
    }
    for (found, voxels) in network.grain_volumes(network.finest(), points).iter().zip(volumes) {
        assert!((found / voxels - 1.0).abs() < 1e-9, "{found}, voxels {voxels}");
    }
}

/// Where a map repeats, its first voxels are as good as any others: shifted, it has the same boundaries, shifted.
#[test]
fn maps_that_repeat_have_no_seam() {
    // A body-centred lattice off its places: no grain meets its own image.
    let seed = |index: u32| {
        let off = |axis: u32| f64::from((7 * index + 5 * axis * axis + 3 * axis) % 11) / 60.0;
        let at = |axis: u32| f64::from(index >> axis & 1) / 2.0 + f64::from(index >> 3) / 4.0 + off(axis);
        [0, 1, 2].map(|axis| at(axis) % 1.0)
    };
    let seeds: Vec<[f64; 3]> = (0..16).map(seed).collect();
    for (shape, axes) in [
        ([14, 12, 13], BVec3::new(true, true, true)),
        ([14, 12, 9], BVec3::new(false, true, false)),
        ([20, 18, 1], BVec3::new(true, true, false)),
        ([20, 18, 1], BVec3::new(true, false, false)),
    ] {
        let shifts: [usize; 3] = [5, 7, 4];
        let shift = std::array::from_fn(|axis| if axes.test(axis) { shifts[axis] } else { 0 });
        let [map, shifted] = [[0; 3], shift].map(|shift| repeating(&seeds, shape, axes, shift));
        let [one, other] = [&map, &shifted].map(smoothed);
        assert_eq!([one.relabelled, other.relabelled], [0, 0]);
        check_repeating(&map, &one);
        // Rounding and the order of grains decide some diagonals, and so volumes that points make up for.
        let size = map.domain().size();
        let moved = DVec3::from_array(shift.map(|voxels| voxels as f64)) * DVec3::new(1.0, 0.5, 2.0);
        for point in &other.points {
            let apart = |known: &DVec3| {
                let straight = point + moved - known;
                let around = straight - (straight / size.max(DVec3::splat(1e-300))).round() * size;
                DVec3::select(axes, around, straight).length()
            };
            let nearest = one.points.iter().map(apart).fold(f64::INFINITY, f64::min);
            assert!(nearest < 1e-3, "{shape:?}: {point} is {nearest} away");
        }
        let fewer = decimated(&map, 2.0).expect("a network");
        check_repeating_volumes(&map, &fewer);
        assert!(fewer.points.len() < one.points.len());
    }
}

/// As [`check_repeating`], of voxels that may be in a grain beside.
fn check_repeating_volumes(
    map: &Voxels,
    SmoothedVoxels { network, points, certificate, .. }: &SmoothedVoxels,
) {
    assert!(certificate.faults.0.iter().all(|fault| matches!(fault, Fault::Folded { .. })));
    let shape = map.shape().map(|count| count as f64);
    let size = map.domain().size();
    let voxel =
        size.x * size.y / (shape[0] * shape[1]) * if shape[2] == 1.0 { 1.0 } else { size.z / shape[2] };
    let mut counts = vec![0.0; network.grain_count()];
    map.labels()
        .iter()
        .filter_map(|label| label.side().grain())
        .for_each(|grain| counts[grain.index()] += voxel);
    for (found, count) in network.grain_volumes(network.finest(), points).iter().zip(counts) {
        assert!((found / count - 1.0).abs() < 1e-9, "{found}, voxels {count}");
    }
}

#[test]
fn maps_that_cannot_repeat_are_refused() {
    let periods = BVec3::new(true, true, false);
    let refused = |shape, label: &dyn Fn([usize; 3]) -> Option<u32>| {
        let map = voxels(DVec3::ONE, shape, label);
        let map = Voxels::new(map.domain().clone().with_periods(periods), shape, map.labels().to_vec());
        smooth_voxels(map.clone(), VoxelOptions::ALL_POINTS, |_, _| ()).expect_err("no whole grains")
    };
    for depth in [1, 5] {
        let layers = refused([6, 6, depth], &|[x, _, _]| Some(u32::from(x > 2)));
        assert!(matches!(layers, NetworkError::EndlessGrain { grain: GrainId(0) }), "{layers}");
        let short = refused([6, 2, depth], &|[x, y, _]| u32::try_from(x + 6 * y).ok());
        assert!(matches!(short, NetworkError::ShortPeriod { axis: 'y', voxels: 2, .. }), "{short}");
        let pores = refused([6, 6, depth], &|[x, y, _]| (x % 3 > 0 && y % 3 > 0).then_some(0));
        assert!(matches!(pores, NetworkError::PeriodicPores), "{pores}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    /// Few grains that meet their own images, many of few voxels, and noise: valid, or refused for what they are.
    #[test]
    fn any_labels_that_repeat_give_whole_grains_or_are_refused(
        seeds in prop::collection::vec([0.0..1.0f64, 0.0..1.0, 0.0..1.0], 8..30),
        shape in prop::sample::select(vec![[8usize, 9, 7], [9, 6, 8], [12, 9, 1]]),
        axes in prop::sample::select(vec![[true, true, true], [true, false, false], [false, true, true]]),
    ) {
        let mut axes = BVec3::from_array(axes);
        axes.z &= shape[2] > 1;
        let map = repeating(&seeds, shape, axes, [0; 3]);
        match smooth_voxels(map.clone(), VoxelOptions::ALL_POINTS, |_, _| ()) {
            Ok(found) if found.relabelled == 0 => {
                check_repeating(&map, &found);
                check_repeating_volumes(&map, &decimated(&map, 1.6).expect("a network"));
            }
            Ok(_) | Err(NetworkError::EndlessGrain { .. }) => (),
            Err(other) => prop_assert!(false, "{other}"),
        }
    }
}
