//! Triangles that fill grains in the plane, as solvers and other programs read them.

use std::fs;
use std::process::Command;

use glam::{BVec3, DMat2, DVec2};
use grainsmooth::{
    Config, DeckOutput, Output, PeriodicCut, PlaneState, Polycrystal, SeedSource, SolverDeck, TextureOptions,
    TextureSource, make_polycrystal, write_together,
};
use polycrystal::Relaxation;
use voronoi::Dimension;

use crate::programs::run;
use crate::tetrahedra::{BOXES, agrees, calculix};
use crate::tools::text;
use crate::workplace::{BOX, PLANE, SPACE, config, write};

/// Few grains at equilibrium, with large elements.
pub fn coarse(periodic: BVec3, periodic_cut: PeriodicCut) -> Config {
    let mut config = Config {
        seeds: SeedSource::Random { count: 12 },
        relaxation: Some(Relaxation::Equilibrium),
        periodic,
        periodic_cut,
        ..config(Dimension::Two, 0.0)
    };
    config.file.voxels = None;
    config.elements.elements_per_grain = Some(3.0);
    config
}

pub fn filled(config: &Config) -> Polycrystal {
    make_polycrystal(config, &|_, _, _| ()).unwrap().completed(&|_, _, _| ()).unwrap()
}

/// One material under a mean strain of all components: the stress is the same everywhere, with curved edges too.
#[test]
fn calculix_strains_triangles_evenly() {
    let test = "calculix_strains_triangles_evenly";
    let cuts = [PeriodicCut::Wrap, PeriodicCut::Box].into_iter();
    let cases = cuts.flat_map(|cut| [1, 2].map(|order| (cut, order)));
    let cases = cases.flat_map(|case| [PlaneState::Stress, PlaneState::Strain].map(|state| (case, state)));
    for ((cut, order), state) in cases {
        let mut config = coarse(BVec3::TRUE, cut);
        config.file.volume.periodic_equations = true;
        config.file.volume.order = Some(order);
        config.file.volume.plane_state = Some(state);
        let polycrystal = filled(&config);
        let (folder, _) = write(&polycrystal, "grains.inp");
        let strain = DMat2::from_cols(DVec2::new(2e-3, 5e-4), DVec2::new(5e-4, -1e-3));
        let mut job = "*INCLUDE, INPUT=grains.inp\n*MATERIAL, NAME=GRAINS\n*ELASTIC\n1000, 0.3\n\
            *BOUNDARY\nHELD, 1, 2\n*STEP\n*STATIC\n*BOUNDARY\n"
            .to_owned();
        for (axis, name) in ["X", "Y"].into_iter().enumerate() {
            for component in 0..2 {
                let displacement = strain.col(axis)[component] * BOX[axis];
                job += &format!("PERIOD_{name}, {0}, {0}, {displacement}\n", component + 1);
            }
        }
        job += "*EL PRINT, ELSET=ELEMENTS\nS\n*END STEP\n";
        fs::write(folder.path().join("job.inp"), job).unwrap();
        let Some(printed) = calculix(test, folder.path(), "job") else { return };

        let (shear, ratio) = (1000.0 / 2.6, 0.3);
        let trace = strain.x_axis.x + strain.y_axis.y;
        // Lame's constant, and what it is where nothing holds across the plane.
        let lame = match state {
            PlaneState::Stress => 1000.0 * ratio / (1.0 - ratio * ratio),
            PlaneState::Strain => 1000.0 * ratio / (1.3 * 0.4),
        };
        let across = if state == PlaneState::Strain { lame * trace } else { 0.0 };
        let stress = strain * (2.0 * shear) + DMat2::from_diagonal(DVec2::splat(lame * trace));
        let [x, y] = [stress.x_axis, stress.y_axis];
        let exact = [x.x, y.y, across, x.y, 0.0, 0.0];
        let mut points = 0;
        for line in printed.lines() {
            let words: Vec<f64> = line.split_whitespace().filter_map(|word| word.parse().ok()).collect();
            let [_, _, stress @ ..] = &words[..] else { continue };
            if stress.len() == 6 {
                let is_exact = |(stress, exact): (&f64, f64)| (stress - exact).abs() < 1e-6 * x.x;
                assert!(stress.iter().zip(exact).all(is_exact), "{cut:?} {order}: {line} is not {exact:?}");
                points += 1;
            }
        }
        // CalculiX makes wedges of triangles, with two and nine points of integration.
        let of_element = if order == 2 { 9 } else { 2 };
        assert_eq!(points, of_element * polycrystal.plane_mesh.as_ref().unwrap().mesh.triangles.len());
    }
}

/// `plane.py` says which of the files that it is given disagree with what is expected.
#[test]
fn meshio_scikit_fem_and_gmsh_read_triangles() {
    let test = "meshio_scikit_fem_and_gmsh_read_triangles";
    for ((periodic, periodic_cut), order) in
        BOXES.into_iter().flat_map(|case| [1, 2].map(|order| (case, order)))
    {
        let mut config = coarse(periodic, periodic_cut);
        config.file.volume.volume_mesh = true;
        config.file.volume.order = Some(order);
        let mut polycrystal = filled(&config);
        let folder = tempfile::tempdir().unwrap();
        for name in ["grains.msh", "grains.vtu", "grains.bdf", "grains.xdmf", "grains.inp"] {
            polycrystal.write(&Output::check(folder.path().join(name)).unwrap()).unwrap();
        }
        if order == 1 {
            polycrystal.file_mut().volume.cohesive = true;
            polycrystal.write(&Output::check(folder.path().join("cohesive.inp")).unwrap()).unwrap();
        }
        let filled = polycrystal.plane_mesh.as_ref().unwrap();
        let quality = filled.quality().unwrap();
        // Where grains are cut, corners are narrow.
        let is_cut = periodic_cut == PeriodicCut::Box;
        assert!(is_cut || quality.least_angle > 25.0 && quality.mean_shape > 0.9, "{quality:?}");
        let network = &polycrystal.network;
        let boundaries = network.boundaries();
        let expected = serde_json::json!({
            "points": filled.mesh.points.iter().map(|point| point.to_array()).collect::<Vec<_>>(),
            "line_points": filled.mesh.line_points,
            "triangles": filled.mesh.triangles,
            "grains": filled.mesh.grains.iter().map(|grain| grain.0).collect::<Vec<_>>(),
            "areas": network.cell_volumes(),
            "segments": network.finest().element_count(),
            "segments_between_grains": network.finest().boundaries()
                .filter(|boundary| boundaries[boundary.index()].wall.is_none()).count(),
            "box": BOX.to_array(),
            "order": order,
            "periodic": periodic.any(),
            "has_sides": !periodic.any() || periodic_cut == PeriodicCut::Box,
        });
        fs::write(folder.path().join("expected.json"), expected.to_string()).unwrap();
        if !agrees(test, concat!(env!("CARGO_MANIFEST_DIR"), "/tests/formats/plane.py"), folder.path()) {
            return;
        }
        let mut gmsh = Command::new("gmsh");
        gmsh.arg(folder.path().join("grains.msh")).args(["-save", "-format", "msh22", "-o"]);
        let Some(output) = run(test, gmsh.arg(folder.path().join("again.msh"))) else { return };
        let said = text(&output.stdout) + &text(&output.stderr);
        assert!(output.status.success() && !said.contains("Error") && !said.contains("Warning"), "{said}");
    }
}

/// `voxels.py` compares hexahedra and squares with the labels of voxels.
#[test]
fn vtk_and_meshio_read_voxels_as_elements() {
    for polycrystal in [&*SPACE, &*PLANE] {
        let mut polycrystal = polycrystal.clone();
        polycrystal.file_mut().volume.volume_mesh = true;
        let folder = tempfile::tempdir().unwrap();
        for name in ["grains.vtu", "grains.inp", "grains.npy"] {
            polycrystal.write(&Output::check(folder.path().join(name)).unwrap()).unwrap();
        }
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/formats/voxels.py");
        if !agrees("vtk_and_meshio_read_voxels_as_elements", script, folder.path()) {
            return;
        }
    }
}

#[test]
fn a_table_has_the_material_of_each_grain() {
    let mut config = coarse(BVec3::FALSE, PeriodicCut::Wrap);
    config.texture.source = Some(TextureSource::new("random").unwrap());
    config.phases = ["first:0.6", "second:0.4"].map(|phase| phase.parse().unwrap()).to_vec();
    let polycrystal = filled(&config);
    let (_folder, path) = write(&polycrystal, "materials.csv");
    let text = fs::read_to_string(path).unwrap();
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    assert_eq!(lines.next(), Some("GrainId,SeedId,Phase,phi1,Phi,phi2"));
    let grains = polycrystal.grains();
    let phases: Vec<&str> = grains.phases.as_ref().unwrap().names().collect();
    let phase_of = grains.phases.as_ref().unwrap().phase_of();
    let orientations = grains.texture.as_ref().unwrap().orientations();
    for (grain, line) in lines.by_ref().take(orientations.len()).enumerate() {
        let [phi1, phi, phi2] = orientations[grain].euler_degrees();
        let (seed, phase) = (grains.ids[grain], phases[phase_of[grain]]);
        assert_eq!(line, format!("{grain},{seed},{phase},{phi1:?},{phi:?},{phi2:?}"));
    }
    assert_eq!(lines.next(), None);
}

/// A sheet of copper crystals is no stiffer along x than its stiffest grain could be, nor softer than the softest: 66.7 and 191.1 GPa along <100> and <111>.
#[test]
fn calculix_pulls_a_sheet() {
    let test = "calculix_pulls_a_sheet";
    for periodic in [BVec3::FALSE, BVec3::new(true, true, false)] {
        let mut config = coarse(periodic, PeriodicCut::Wrap);
        config.texture = TextureOptions {
            source: Some(TextureSource::new("random").unwrap()),
            ..TextureOptions::default()
        };
        config.file.volume.solver_deck = Some(SolverDeck::TensionX);
        config.check().unwrap();
        let polycrystal = filled(&config);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("grains.inp");
        let elements = Output::check(&path).unwrap();
        let deck = DeckOutput::check(&path, SolverDeck::TensionX).unwrap();
        write_together(|files| {
            polycrystal.stage(&elements, files)?;
            polycrystal.stage_solver_deck(&deck, files)
        })
        .unwrap();
        let Some(printed) = calculix(test, folder.path(), "grains.tension-x") else { return };
        let number =
            |line: &str, word: usize| -> f64 { line.split_whitespace().nth(word).unwrap().parse().unwrap() };
        let modulus = match printed.split_once("total force") {
            Some((_, forces)) => number(forces.lines().nth(2).unwrap(), 0) / BOX.y / 0.001,
            None => 100.0 / (number(printed.lines().last().unwrap(), 1) / BOX.x),
        };
        assert!((66_700.0..191_100.0).contains(&modulus), "{modulus}");
    }
}
