//! Orientations, disorientations and colours against numbers of other programs.

use std::collections::BTreeMap;

use crate::common::load;
use glam::{DMat3, DVec3};
use proptest::prelude::*;
use serde::Deserialize;
use texture::{CrystalSymmetry, IpfKey, Orientation, Sector, ideal_orientations, mean_orientation};

#[derive(Deserialize)]
struct Orientations {
    orientations: Vec<Row>,
}

#[derive(Deserialize)]
struct Row {
    euler: [f64; 3],
    matrix: [[f64; 3]; 3],
    quaternion: [f64; 4],
    rodrigues: Option<[f64; 3]>,
}

fn rows() -> Vec<Row> {
    load::<Orientations>("orientations.json").orientations
}

fn orientation(row: &Row) -> Orientation {
    Orientation::from_euler_degrees(row.euler)
}

/// Whether two angles in degrees are equal up to whole turns.
fn is_same_angle(a: f64, b: f64, tolerance: f64) -> bool {
    let away = (a - b).rem_euclid(360.0);
    away.min(360.0 - away) < tolerance
}

#[test]
fn matrices_quaternions_and_rodrigues_vectors_are_those_of_orix_damask_and_neper() {
    for row in rows() {
        let matrix = DMat3::from_cols_array_2d(&row.matrix).transpose();
        let made = [
            orientation(&row),
            Orientation::from_matrix(matrix),
            Orientation::from_quaternion(row.quaternion).unwrap(),
        ];
        for made in made {
            assert!(made.matrix().abs_diff_eq(matrix, 2e-10), "{:?}", row.euler);
            let quaternion = made.quaternion();
            // Of half turns the sign is free.
            let sign =
                if quaternion[0] < 1e-9 && quaternion[1] * row.quaternion[1] < 0.0 { -1.0 } else { 1.0 };
            for (ours, theirs) in quaternion.into_iter().zip(row.quaternion) {
                assert!((ours - sign * theirs).abs() < 2e-10, "{:?}: {quaternion:?}", row.euler);
            }
            for direction in [DVec3::X, DVec3::Y, DVec3::Z] {
                assert!(made.to_crystal(direction).abs_diff_eq(matrix * direction, 2e-10));
                assert!(made.to_sample(made.to_crystal(direction)).abs_diff_eq(direction, 1e-15));
            }
        }
        if let Some(rodrigues) = row.rodrigues.map(DVec3::from_array) {
            let scale = 1.0 + rodrigues.length_squared();
            assert!(made[0].rodrigues().abs_diff_eq(rodrigues, 1e-9 * scale), "{:?}", row.euler);
            assert!(Orientation::from_rodrigues(rodrigues).matrix().abs_diff_eq(matrix, 1e-9));
        }
    }
}

#[test]
fn ideal_orientations_are_the_published_ones() {
    #[derive(Deserialize)]
    struct Ideal {
        euler: BTreeMap<String, [f64; 3]>,
    }
    let ideal: Ideal = load("ideal_orientations.json");
    let names = [
        ("cube", "Cube"),
        ("rotated-cube", "RotatedCube"),
        ("goss", "Goss"),
        ("rotated-goss", "AlphaRotatedGoss"),
        ("brass", "Brass"),
        ("copper", "Copper"),
        ("s", "S"),
        ("dillamore", "Dillamore"),
    ];
    assert_eq!(ideal_orientations().len(), names.len());
    for ((name, orientation), (ours, theirs)) in ideal_orientations().zip(names) {
        assert_eq!(name, ours);
        let published = Orientation::from_euler_degrees(ideal.euler[theirs]);
        let angle = CrystalSymmetry::Triclinic.disorientation_angle(orientation, published);
        assert!(angle < 1e-7, "{name} is off by {angle}");
    }
}

#[derive(Deserialize)]
struct Disorientations {
    pairs: Vec<[usize; 2]>,
    near: Vec<[[f64; 3]; 2]>,
    groups: BTreeMap<String, Group>,
}

#[derive(Deserialize)]
struct Group {
    order: usize,
    pairs: Vec<f64>,
    near: Vec<f64>,
}

#[test]
fn disorientations_are_exact_to_a_billionth_of_a_degree_in_all_eleven_groups() {
    let rows = rows();
    let reference: Disorientations = load("disorientations.json");
    assert_eq!(reference.groups.len(), CrystalSymmetry::ALL.len());
    for symmetry in CrystalSymmetry::ALL {
        let group = &reference.groups[symmetry.rotation_group()];
        assert_eq!(symmetry.order(), group.order, "{symmetry}");
        let far = reference.pairs.iter().map(|pair| pair.map(|index| orientation(&rows[index])));
        let near = reference.near.iter().map(|pair| pair.map(Orientation::from_euler_degrees));
        for ([a, b], exact) in far.chain(near).zip(group.pairs.iter().chain(&group.near)) {
            let found = symmetry.disorientation(a, b);
            let back = symmetry.disorientation(b, a);
            for angle in [found.angle, symmetry.disorientation_angle(a, b), back.angle] {
                assert!((angle - exact).abs() < 1e-9, "{symmetry}: {angle} is not {exact}");
            }
            assert!(found.axis.abs_diff_eq(back.axis, 1e-6), "{symmetry}: {} {}", found.axis, back.axis);
            assert!((found.axis.length() - 1.0).abs() < 1e-12);
            let outside =
                Sector::of(symmetry).normals().iter().map(|n| n.dot(found.axis)).fold(1.0, f64::min);
            assert!(outside > -1e-9, "{symmetry}: the axis {} lies outside the sector", found.axis);
        }
    }
}

#[test]
fn twins_turn_by_sixty_degrees_around_a_space_diagonal() {
    // Sigma 3 of cubic crystals, and the tension twin {10-12} of magnesium: 86.3 degrees around <11-20>.
    let diagonal = DVec3::ONE.normalize();
    let quaternion = |axis: DVec3, degrees: f64| {
        let (sine, cosine) = (degrees.to_radians() / 2.0).sin_cos();
        Orientation::from_quaternion([cosine, sine * axis.x, sine * axis.y, sine * axis.z]).unwrap()
    };
    let twin = CrystalSymmetry::Octahedral.disorientation(Orientation::IDENTITY, quaternion(-diagonal, 60.0));
    assert!((twin.angle - 60.0).abs() < 1e-12);
    assert!(twin.axis.abs_diff_eq(diagonal, 1e-12));
    let axis = DVec3::new(-0.5, 0.75_f64.sqrt(), 0.0);
    let twin = CrystalSymmetry::Hexagonal.disorientation(Orientation::IDENTITY, quaternion(axis, 86.3));
    assert!((twin.angle - 86.3).abs() < 1e-12);
    assert!(twin.axis.abs_diff_eq(DVec3::X, 1e-12), "{}", twin.axis);
}

#[test]
fn colors_are_those_of_orix_within_a_hundredth() {
    #[derive(Deserialize)]
    struct Colors {
        laue: BTreeMap<String, BTreeMap<String, Vec<[f64; 3]>>>,
    }
    let rows = rows();
    let colors: Colors = load("ipf_colors.json");
    for (laue, of_direction) in colors.laue {
        let key = IpfKey::new(laue.parse().unwrap());
        for (name, direction) in [("X", DVec3::X), ("Y", DVec3::Y), ("Z", DVec3::Z)] {
            for (row, theirs) in rows.iter().zip(&of_direction[name]) {
                let ours = key.color(orientation(row).to_crystal(direction));
                let off = ours.into_iter().zip(theirs).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(off < 0.01, "{laue} {name} {:?}: {ours:?} is not {theirs:?}", row.euler);
            }
        }
    }
}

#[test]
fn corners_of_every_key_are_red_green_and_blue_and_its_middle_is_white() {
    for symmetry in CrystalSymmetry::ALL {
        let (key, sector) = (IpfKey::new(symmetry), Sector::of(symmetry));
        for (corner, color) in
            sector.marks().into_iter().zip([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
        {
            // On the border itself two corners can be equal.
            let ours = DVec3::from_array(key.color(corner.lerp(sector.center(), 1e-7)));
            assert!(ours.abs_diff_eq(DVec3::from_array(color), 1e-5), "{symmetry}: {corner} is {ours}");
        }
        assert_eq!(key.color(sector.center()), [1.0; 3], "{symmetry}");
        assert_eq!(key.color_of(Orientation::IDENTITY, sector.center()), [255; 3], "{symmetry}");
    }
}

#[test]
fn symmetries_are_found_by_word_group_and_laue_group() {
    for symmetry in CrystalSymmetry::ALL {
        for name in
            [symmetry.rotation_group().to_owned(), symmetry.laue_group().to_owned(), symmetry.to_string()]
        {
            assert_eq!(name.parse(), Ok(symmetry), "{name}");
        }
    }
    assert_eq!("Cubic".parse(), Ok(CrystalSymmetry::Octahedral));
    let error = "cubical".parse::<CrystalSymmetry>().unwrap_err().to_string();
    assert!(error.contains("'cubical'") && error.contains("cubic, hexagonal"), "{error}");
}

fn any_orientation() -> impl Strategy<Value = Orientation> {
    prop::array::uniform3(-360.0..360.0_f64).prop_map(Orientation::from_euler_degrees)
}

fn any_symmetry() -> impl Strategy<Value = CrystalSymmetry> {
    prop::sample::select(CrystalSymmetry::ALL.to_vec())
}

proptest! {
    #[test]
    fn euler_angles_lead_back(angles in prop::array::uniform3(-360.0..360.0_f64), exact in 0_u8..3) {
        let [phi1, phi, phi2] = angles;
        let phi = [phi, 0.0, 180.0][usize::from(exact)];
        let made = Orientation::from_euler_degrees([phi1, phi, phi2]);
        let back = made.euler_degrees();
        prop_assert!((0.0..360.0).contains(&back[0]) && (0.0..360.0).contains(&back[2]), "{back:?}");
        prop_assert!((0.0..=180.0).contains(&back[1]), "{back:?}");
        let again = Orientation::from_euler_degrees(back);
        prop_assert!(CrystalSymmetry::Triclinic.disorientation_angle(made, again) < 1e-12);
        if exact == 0 && (1.0..179.0).contains(&phi) {
            for (ours, given) in back.into_iter().zip(angles) {
                prop_assert!(is_same_angle(ours, given, 1e-11), "{back:?} from {angles:?}");
            }
        }
    }

    #[test]
    fn equivalent_orientations_have_no_disorientation_and_one_color(
        orientation in any_orientation(), other in any_orientation(), symmetry in any_symmetry(), number in 0_usize..24,
    ) {
        let rotations = symmetry.rotations();
        let rotation = rotations[number % rotations.len()];
        let [w, x, y, z] = orientation.quaternion();
        let turned = (glam::DQuat::from_xyzw(x, y, z, w) * rotation).to_array();
        let turned = Orientation::from_quaternion([turned[3], turned[0], turned[1], turned[2]]).unwrap();
        prop_assert!(symmetry.disorientation(orientation, turned).angle < 1e-13);
        let [a, b] = [orientation, turned].map(|one| symmetry.disorientation(one, other));
        prop_assert!((a.angle - b.angle).abs() < 1e-12);
        let key = IpfKey::new(symmetry);
        let [a, b] = [orientation, turned].map(|one| DVec3::from_array(key.color(one.to_crystal(DVec3::Y))));
        prop_assert!(a.abs_diff_eq(b, 1e-6), "{symmetry}: {a} {b}");
    }

    #[test]
    fn mean_of_turned_equivalents_is_in_their_middle(
        middle in any_orientation(), symmetry in any_symmetry(), numbers in prop::array::uniform6(0_usize..24),
    ) {
        // Five degrees to either side along each axis.
        let rotations = symmetry.rotations();
        let [w, x, y, z] = middle.quaternion();
        let turned = |axis: DVec3, degrees: f64, number: usize| {
            let away = glam::DQuat::from_axis_angle(axis, degrees.to_radians());
            let other = (away * glam::DQuat::from_xyzw(x, y, z, w) * rotations[number % rotations.len()]).to_array();
            (Orientation::from_quaternion([other[3], other[0], other[1], other[2]]).unwrap(), 2.0)
        };
        let axes = [DVec3::X, DVec3::X, DVec3::Y, DVec3::Y, DVec3::Z, DVec3::Z];
        let angles = [5.0, -5.0, 5.0, -5.0, 5.0, -5.0];
        let all: Vec<_> = (0..6).map(|index| turned(axes[index], angles[index], numbers[index])).collect();
        let mean = mean_orientation(&all, symmetry).unwrap();
        prop_assert!(symmetry.disorientation_angle(mean, middle) < 1e-9);
    }
}
