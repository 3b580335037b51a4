//! Programs that others wrote, where they are installed.

use std::fs;
use std::path::Path;
use std::process::Command;

use clap::ValueEnum;
use grainsmooth::spelling::name_of;
use grainsmooth::vtk::VtkEncoding;
use grainsmooth::{
    Config, OutputDirectory, OutputFormat, PeriodicCut, Polycrystal, SeedSource, StlEncoding, TextureOptions,
    TextureSource, make_polycrystal, write_together,
};
use texture::CrystalSymmetry;
use voronoi::Dimension;

use crate::programs::{run, skip};
use crate::workplace::{PLANE, SPACE, config, write};

pub fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Volumes of the tetrahedra of each physical volume in a Gmsh file of version 2.2.
pub fn tetrahedra(path: &Path, grain_count: usize) -> Vec<f64> {
    let file = fs::read_to_string(path).unwrap();
    let section = |name: &str| {
        let after = file.split_once(&format!("${name}\n")).unwrap().1;
        let lines = after.split_once(&format!("$End{name}")).unwrap().0;
        lines
            .lines()
            .skip(1)
            .map(|line| line.split_whitespace().map(str::to_owned).collect())
            .collect::<Vec<Vec<String>>>()
    };
    let nodes: std::collections::BTreeMap<String, glam::DVec3> = section("Nodes")
        .into_iter()
        .map(|words| {
            let coordinates: Vec<f64> = words[1..].iter().map(|word| word.parse().unwrap()).collect();
            (words[0].clone(), glam::DVec3::from_slice(&coordinates))
        })
        .collect();
    let mut volumes = vec![0.0; grain_count];
    for element in section("Elements").iter().filter(|words| words[1] == "4") {
        let [a, b, c, d] = [5, 6, 7, 8].map(|place| nodes[&element[place]]);
        let volume = (b - a).cross(c - a).dot(d - a) / 6.0;
        assert!(volume > 0.0, "tetrahedron {} has volume {volume}", element[0]);
        // The physical volume.
        let grain: usize = element[3].parse().unwrap();
        volumes[grain - 1] += volume;
    }
    volumes
}

/// Checks that Gmsh fills each grain, all its pieces together, to its volume.
fn check_filled(test: &str, polycrystal: &Polycrystal) {
    let (folder, path) = write(polycrystal, "grains.msh");
    let filled = folder.path().join("filled.msh");
    let mut gmsh = Command::new("gmsh");
    gmsh.arg("-3").arg(path.with_extension("geo")).args(["-format", "msh22", "-nt", "1", "-o"]).arg(&filled);
    let Some(output) = run(test, &mut gmsh) else { return };
    let said = text(&output.stdout) + &text(&output.stderr);
    assert!(output.status.success() && !said.contains("Error"), "{said}");
    let volumes = polycrystal.network.cell_volumes();
    for (grain, (volume, expected)) in tetrahedra(&filled, volumes.len()).into_iter().zip(volumes).enumerate()
    {
        // The format in which gmsh writes here has 16 digits.
        assert!((volume / expected - 1.0).abs() < 1e-9, "grain {grain}: {volume} {expected}");
    }
}

#[test]
fn gmsh_fills_every_grain_with_tetrahedra() {
    check_filled("gmsh_fills_every_grain_with_tetrahedra", &SPACE);
}

/// Where the box cuts grains apart, each piece is a volume.
#[test]
fn gmsh_fills_all_pieces_of_grains_that_the_box_cuts() {
    let config = Config {
        seeds: SeedSource::Random { count: 30 },
        periodic: glam::BVec3::TRUE,
        periodic_cut: PeriodicCut::Box,
        levels: 1,
        ..Config::default()
    };
    let whole = make_polycrystal(&config, &|_, _, _| ()).unwrap();
    let cut = whole.cut_if_asked().unwrap();
    let (_folder, path) = write(&cut, "grains.msh");
    let script = fs::read_to_string(path.with_extension("geo")).unwrap();
    assert!(script.matches("\nVolume(").count() > 60, "grains at walls are in several pieces");
    assert_eq!(script.matches("\nPhysical Volume(").count(), 30);
    check_filled("gmsh_fills_all_pieces_of_grains_that_the_box_cuts", &cut);
}

/// The settings in a solid's name are no more than it takes.
#[test]
fn gmsh_reads_stl() {
    for encoding in [StlEncoding::Ascii, StlEncoding::Binary] {
        let mut polycrystal = SPACE.clone();
        polycrystal.file_mut().stl = encoding;
        let (folder, path) = write(&polycrystal, "network.stl");
        let mesh = folder.path().join("network.msh");
        let mut gmsh = Command::new("gmsh");
        gmsh.arg(&path).args(["-save", "-format", "msh22", "-o"]).arg(&mesh);
        let Some(output) = run("gmsh_reads_stl", &mut gmsh) else { return };
        assert!(output.status.success(), "{}: {}", output.status, text(&output.stderr));
        let file = fs::read_to_string(&mesh).unwrap();
        let count = file.split_once("$Elements\n").unwrap().1.lines().next().unwrap().parse();
        assert_eq!(count, Ok(SPACE.network.finest().element_count()));
    }
}

/// `readers.py` says which of the files that it is given disagree with what is expected.
#[test]
fn vtk_meshio_and_trimesh_read_every_format() {
    let directory = tempfile::tempdir().unwrap();
    let names = ["a.vtp", "a.vtu", "a.vtk", "a.vtm", "a.stl", "a.ply", "a.obj", "a.msh", "a.vti", "a.npy"];
    for name in names {
        let output = grainsmooth::Output::check(directory.path().join(name)).unwrap();
        SPACE.write(&output).unwrap();
    }
    for name in ["b.vtp", "b.vtu", "b.vti", "b.vtm"] {
        PLANE.write(&grainsmooth::Output::check(directory.path().join(name)).unwrap()).unwrap();
    }
    let mut measured = SPACE.clone();
    *measured.file_mut() =
        grainsmooth::FileOptions { arrays: true, stl: StlEncoding::Ascii, ..measured.file() };
    for name in ["measured.vtp", "measured.vtu", "measured.vtk", "text.stl"] {
        measured.write(&grainsmooth::Output::check(directory.path().join(name)).unwrap()).unwrap();
    }
    for encoding in [VtkEncoding::Base64, VtkEncoding::Zlib] {
        let mut encoded = SPACE.clone();
        encoded.file_mut().encoding = encoding;
        for extension in ["vtp", "vtu", "vti", "vtm"] {
            let path = directory.path().join(format!("{}.{extension}", name_of(&encoding)));
            encoded.write(&grainsmooth::Output::check(path).unwrap()).unwrap();
        }
    }
    let picture = grainsmooth::Output::check_as(directory.path().join("a.png"), grainsmooth::Png).unwrap();
    write_together(|files| SPACE.stage_picture(&grainsmooth::Picture::default(), &picture, files)).unwrap();
    for names in grainsmooth::Names::value_variants() {
        for (polycrystal, dimension) in [(&*SPACE, "3d"), (&*PLANE, "2d")] {
            let mut renamed = polycrystal.clone();
            renamed.file_mut().names = *names;
            for extension in ["vtp", "vtm"] {
                let name = format!("{}_{dimension}.{extension}", name_of(names));
                renamed.write(&grainsmooth::Output::check(directory.path().join(name)).unwrap()).unwrap();
            }
        }
    }
    let grains =
        OutputDirectory::check(directory.path().join("each"), OutputFormat::of_extension("stl").unwrap())
            .unwrap();
    write_together(|files| SPACE.stage_grains(&grains, files)).unwrap();
    let level = SPACE.network.finest().held();
    let counts = SPACE.network.junction_counts();
    let expected = serde_json::json!({
        "points": SPACE.points.iter().map(|point| point.to_array()).collect::<Vec<_>>(),
        "triangles": level.element_count(),
        "boundaries": SPACE.network.boundaries().len(),
        "triple_lines": counts.triple_lines,
        "quadruple_points": counts.quadruple_points,
        "volumes": SPACE.network.cell_volumes(),
        "settings": SPACE.synthesis().unwrap().config.to_toml(),
        "triple_points_2d": PLANE.network.junction_counts().triple_lines,
        "areas_2d": PLANE.network.cell_volumes(),
    });
    fs::write(directory.path().join("expected.json"), expected.to_string()).unwrap();
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/formats/readers.py");
    let mut python = Command::new("python3");
    python.arg(script).arg(directory.path());
    let Some(output) = run("vtk_meshio_and_trimesh_read_every_format", &mut python) else { return };
    assert!(output.status.success(), "{}: {}", output.status, text(&output.stderr));
}

/// `materials.py` says where a grid and its materials disagree.
#[test]
fn damask_reads_materials_with_the_phases_of_voxels() {
    let directory = tempfile::tempdir().unwrap();
    let phases = ["first:0.6,symmetry=hexagonal", "second:0.4"].map(|phase| phase.parse().unwrap());
    let texture = TextureOptions {
        source: Some(TextureSource::Words("random".to_owned())),
        ..TextureOptions::default()
    };
    let config = Config { texture, phases: phases.to_vec(), ..config(Dimension::Three, 0.0) };
    let polycrystal = make_polycrystal(&config, &|_, _, _| ()).unwrap();
    for name in ["grains.vti", "material.yaml"] {
        polycrystal.write(&grainsmooth::Output::check(directory.path().join(name)).unwrap()).unwrap();
    }
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/formats/materials.py");
    let mut python = Command::new("python3");
    python.arg(script).arg(directory.path());
    let Some(output) = run("damask_reads_materials_with_the_phases_of_voxels", &mut python) else { return };
    assert!(output.status.success(), "{}: {}", output.status, text(&output.stderr));
}

/// `orientations.py` says which of the files that it is given disagree with orix.
#[test]
fn orix_agrees_on_orientations_colors_and_disorientations() {
    let directory = tempfile::tempdir().unwrap();
    for symmetry in [CrystalSymmetry::Octahedral, CrystalSymmetry::Hexagonal] {
        let texture = TextureOptions {
            source: Some(TextureSource::Words("random".to_owned())),
            symmetry,
            ..TextureOptions::default()
        };
        let make = |dimension| {
            let config = Config { texture: texture.clone(), ..config(dimension, 0.0) };
            make_polycrystal(&config, &|_, _, _| ()).unwrap()
        };
        let write = |polycrystal: &Polycrystal, name: &str| {
            let path = directory.path().join(format!("{symmetry}{name}"));
            polycrystal.write(&grainsmooth::Output::check(path).unwrap()).unwrap();
        };
        let space = make(Dimension::Three);
        [".vtm", ".vti", ".vtp", ".vtu", ".vtk", ".ori"].into_iter().for_each(|name| write(&space, name));
        if symmetry == CrystalSymmetry::Octahedral {
            let folder = directory.path().join("each");
            let grains = OutputDirectory::check(folder, OutputFormat::VTP).unwrap();
            write_together(|files| space.stage_grains(&grains, files)).unwrap();
            let mut renamed = space.clone();
            renamed.file_mut().names = grainsmooth::Names::Virmat;
            let path = directory.path().join("virmat.vtm");
            renamed.write(&grainsmooth::Output::check(path).unwrap()).unwrap();
        }
        let plane = make(Dimension::Two);
        ["_plane.vti", ".ang", ".ctf"].into_iter().for_each(|name| write(&plane, name));
    }
    for name in ["plain.ang", "plain.vti"] {
        PLANE.write(&grainsmooth::Output::check(directory.path().join(name)).unwrap()).unwrap();
    }
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/formats/orientations.py");
    let mut python = Command::new("python3");
    python.arg(script).arg(directory.path());
    let Some(output) = run("orix_agrees_on_orientations_colors_and_disorientations", &mut python) else {
        return;
    };
    assert!(output.status.success(), "{}: {}", output.status, text(&output.stderr));
}

/// A box of grains in one direction each, to be stretched.
fn patch_config() -> Config {
    let mut config = Config {
        seeds: SeedSource::Random { count: 9 },
        box_size: glam::DVec3::new(2.0, 1.0, 1.0),
        levels: 2,
        texture: TextureOptions {
            source: Some(TextureSource::new("random").unwrap()),
            ..TextureOptions::default()
        },
        ..config(Dimension::Three, 0.3)
    };
    config.file.voxels = None;
    config
}

/// A patch test: the stress is the same everywhere, and CalculiX tells it in the axes of each grain's crystal. Gives the number of integration points.
fn check_patch(test: &str, polycrystal: &Polycrystal) -> Option<usize> {
    let (folder, path) = write(polycrystal, "grains.inp");
    assert_eq!(fs::read_to_string(path).unwrap().matches("*SOLID SECTION").count(), 9);
    let deck = "*INCLUDE, INPUT=grains.inp
*MATERIAL, NAME=GRAINS
*ELASTIC
1000, 0.3
*BOUNDARY
X0, 1
Y0, 2
Z0, 3
*STEP
*STATIC
*BOUNDARY
X1, 1, 1, 0.002
*EL PRINT, ELSET=ELEMENTS
S
*END STEP
";
    fs::write(folder.path().join("deck.inp"), deck).unwrap();
    let mut calculix = Command::new("ccx");
    calculix.args(["-i", "deck"]).current_dir(folder.path());
    let output = run(test, &mut calculix)?;
    assert!(output.status.success(), "{}", text(&output.stdout));
    let printed = fs::read_to_string(folder.path().join("deck.dat")).unwrap();
    let orientations = polycrystal.grains().texture.as_ref().unwrap().orientations();
    let mut points = 0;
    for line in printed.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        // Element, integration point, six components, and whose axes they are in.
        let [_, _, stress @ .., axes] = &words[..] else { continue };
        let Some(grain) = axes.strip_prefix("ORIENTATION_") else { continue };
        let stress: Vec<f64> = stress.iter().map(|word| word.parse().unwrap()).collect();
        let x = orientations[grain.parse::<usize>().unwrap()].to_crystal(glam::DVec3::X);
        let exact = [x.x * x.x, x.y * x.y, x.z * x.z, x.x * x.y, x.x * x.z, x.y * x.z];
        assert!(stress.iter().zip(exact).all(|(stress, exact)| (stress - exact).abs() < 1e-6), "{line}");
        points += 1;
    }
    Some(points)
}

#[test]
fn calculix_stretches_voxels_evenly() {
    let mut config = Config { levels: 0, ..patch_config() };
    config.file.voxels = Some([12, 6, 5].map(|count| std::num::NonZeroU32::new(count).unwrap()));
    let polycrystal = make_polycrystal(&config, &|_, _, _| ()).unwrap();
    let Some(points) = check_patch("calculix_stretches_voxels_evenly", &polycrystal) else { return };
    assert_eq!(points, 8 * 12 * 6 * 5);
}

/// Gmsh fills the grains, and their volumes are those of their surfaces.
#[test]
fn calculix_stretches_tetrahedra_evenly() {
    let test = "calculix_stretches_tetrahedra_evenly";
    let mut config = patch_config();
    config.elements.elements_per_grain = Some(4.0);
    let polycrystal = make_polycrystal(&config, &|_, _, _| ()).unwrap().remeshed_if_asked().unwrap();
    let filled = match polycrystal.filled() {
        Err(error @ grainsmooth::Error::NoGmsh { .. }) => return skip(test, &error.to_string()),
        filled => filled.unwrap(),
    };
    let mesh = filled.volume_mesh.as_ref().unwrap();
    let volumes = mesh.grain_volumes(9);
    let cells = filled.network.cell_volumes();
    assert!(volumes.iter().zip(cells).all(|(is, wanted)| (is / wanted - 1.0).abs() < 1e-9));
    assert_eq!(mesh.points[..mesh.surface_points], filled.points);
    let quality = mesh.quality().unwrap();
    assert!(quality.mean > 0.6 && quality.least > 0.01, "{quality}");
    let Some(points) = check_patch(test, &filled) else { return };
    assert_eq!(points, mesh.tetrahedra.len());
}
