//! Surface Evolver's datafiles, read back here and, where it is installed, by Evolver itself.

use std::fs;
use std::process::Command;
use std::sync::LazyLock;

use glam::{BVec3, DVec3};
use grainsmooth::{Config, Polycrystal, make_polycrystal};
use polycrystal::Mesh;
use voronoi::Dimension;

use crate::programs::run;
use crate::tools::text;
use crate::workplace::{BOX, SPACE, TORUS, config, write};

/// Periodic along y, between walls along x and z, and relaxed.
static CHANNEL: LazyLock<Polycrystal> = LazyLock::new(|| {
    let periodic = BVec3::new(false, true, false);
    let config = Config { periodic, levels: 1, wall_tension: 0.5, ..config(Dimension::Three, 0.3) };
    make_polycrystal(&config, &|_, _, _| ()).unwrap()
});

/// A datafile of the torus model; numbers count from 1, as in the file.
struct TorusFile {
    periods: DVec3,
    vertices: Vec<DVec3>,
    edges: Vec<TorusEdge>,
    /// Signed edges, and the energy for each area.
    faces: Vec<([i64; 3], f64)>,
    /// Signed faces, and the volume.
    bodies: Vec<(Vec<i64>, f64)>,
}

struct TorusEdge {
    ends: [usize; 2],
    wraps: DVec3,
}

impl TorusFile {
    fn read(file: &str) -> Self {
        let lines: Vec<Vec<&str>> = file.lines().map(|line| line.split_whitespace().collect()).collect();
        // The lines from a keyword to the next empty one, without their numbers, which must be 1, 2, 3 and so on.
        let section = |keyword: &str| -> Vec<&[&str]> {
            let after = lines.iter().skip_while(move |words| **words != [keyword]).skip(1);
            let lines = after.take_while(|words| !words.is_empty()).filter(|words| words[0] != "//");
            let numbered = lines.enumerate().map(|(index, words)| {
                assert_eq!(words[0], (index + 1).to_string(), "{keyword}");
                &words[1..]
            });
            numbered.collect()
        };
        assert!(lines.contains(&vec!["torus_filled"]));
        let periods = lines.iter().skip_while(|words| **words != ["periods"]).skip(1);
        let periods: Vec<f64> =
            (0..3).zip(periods).map(|(axis, words)| words[axis].parse().unwrap()).collect();
        let wrap = |word: &&str| ["-", "*", "+"].iter().position(|sign| sign == word).unwrap() as f64 - 1.0;
        let edge = |words: &[&str]| TorusEdge {
            ends: [0, 1].map(|end| words[end].parse().unwrap()),
            wraps: DVec3::from_slice(&words[2..5].iter().map(wrap).collect::<Vec<f64>>()),
        };
        let density = |words: &[&str]| {
            let place = words.iter().position(|word| *word == "density");
            place.map_or(1.0, |place| words[place + 1].parse().unwrap())
        };
        let face = |words: &[&str]| ([0, 1, 2].map(|place| words[place].parse().unwrap()), density(words));
        let body = |words: &[&str]| {
            let place = words.iter().position(|word| *word == "volume").unwrap();
            let faces = words[..place].iter().map(|word| word.parse().unwrap());
            (faces.collect(), words[place + 1].parse().unwrap())
        };
        Self {
            periods: DVec3::from_slice(&periods),
            vertices: section("vertices")
                .into_iter()
                .map(|words| DVec3::from_array([0, 1, 2].map(|axis| words[axis].parse().unwrap())))
                .collect(),
            edges: section("edges").into_iter().map(edge).collect(),
            faces: section("faces").into_iter().map(face).collect(),
            bodies: section("bodies").into_iter().map(body).collect(),
        }
    }

    /// Where a signed edge begins and ends, and the wraps from there to there.
    fn along(&self, edge: i64) -> ([usize; 2], DVec3) {
        let TorusEdge { ends: [from, to], wraps } = self.edges[number(edge)];
        if edge > 0 { ([from, to], wraps) } else { ([to, from], -wraps) }
    }

    /// The vector along a signed edge.
    fn vector(&self, edge: i64) -> DVec3 {
        let ([from, to], wraps) = self.along(edge);
        self.vertices[to - 1] + wraps * self.periods - self.vertices[from - 1]
    }

    /// The total energy of the faces.
    fn energy(&self) -> f64 {
        let area = |[a, b, _]: [i64; 3]| self.vector(a).cross(self.vector(b)).length() / 2.0;
        self.faces.iter().map(|(face, density)| density * area(*face)).sum()
    }
}

fn number(signed: i64) -> usize {
    usize::try_from(signed.abs()).unwrap() - 1
}

/// The energy of the network: of a boundary that comes twice, once.
fn energy(polycrystal: &Polycrystal) -> f64 {
    let network = &polycrystal.network;
    let Mesh::Triangles(mesh) = &network.finest().held().mesh else { panic!("not in space") };
    let of_triangle = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|corner| polycrystal.points[corner as usize]);
        (b - a).cross(c - a).length() / 2.0
    };
    let share = |boundary: usize| if network.boundaries()[boundary].twin.is_some() { 0.5 } else { 1.0 };
    let numbered = mesh.triangles().iter().zip(&network.finest().held().boundary_of);
    numbered
        .map(|(triangle, id)| share(id.index()) * network.tensions()[id.index()] * of_triangle(triangle))
        .sum()
}

#[test]
fn a_periodic_network_stands_once_on_the_torus() {
    for (polycrystal, is_without_walls) in [(&*TORUS, true), (&*CHANNEL, false)] {
        let (_folder, path) = write(polycrystal, "grains.fe");
        let file = TorusFile::read(&fs::read_to_string(path).unwrap());
        let copies = &polycrystal.network.finest().held().copies.vertices;
        assert_eq!(file.vertices.len() + copies.len(), polycrystal.points.len());
        assert_eq!(file.periods, BOX);

        let mut valences = vec![0; file.edges.len()];
        for ([a, b, c], _) in &file.faces {
            // Edges follow one another, and come back to where they began, not to a place a period away.
            let [(x, first), (y, second), (z, third)] = [a, b, c].map(|edge| file.along(*edge));
            assert!(x[1] == y[0] && y[1] == z[0] && z[1] == x[0], "{a} {b} {c}");
            assert_eq!(first + second + third, DVec3::ZERO, "{a} {b} {c}");
            for edge in [a, b, c] {
                valences[number(*edge)] += 1;
            }
        }
        assert!(valences.iter().all(|valence| *valence >= 2));
        if is_without_walls {
            // What is not regularised either meets in threes.
            assert!(valences.iter().all(|valence| *valence <= 3));
            let count = |elements: usize| i64::try_from(elements).unwrap();
            let [v, e, f, c] =
                [file.vertices.len(), file.edges.len(), file.faces.len(), file.bodies.len()].map(count);
            assert_eq!(v - e + f - c, 0, "the characteristic of the torus, of balls");
        }

        let mut sides = vec![[0; 2]; file.faces.len()];
        for (faces, _) in &file.bodies {
            for face in faces {
                sides[number(*face)][usize::from(*face < 0)] += 1;
            }
        }
        let outside = sides.iter().filter(|sides| **sides == [1, 0]).count();
        assert!(sides.iter().all(|sides| [[1, 1], [1, 0]].contains(sides)));
        assert_eq!(outside == 0, is_without_walls);
        let stated: Vec<f64> = file.bodies.iter().map(|(_, volume)| *volume).collect();
        assert_eq!(stated, polycrystal.network.cell_volumes());
        assert!((file.energy() / energy(polycrystal) - 1.0).abs() < 1e-12);
    }
}

#[test]
fn surface_evolver_finds_every_volume_and_the_area_and_lessens_it() {
    let mut script = "printf \"area %20.15g\\n\", total_energy\n".to_owned();
    script += "foreach body bb do printf \"body %g %20.15g %20.15g\\n\", id, volume, target\n";
    script += "g 3\nprintf \"later %20.15g %20.15g\\n\", total_energy, max(body where target > 0, abs(volume/target - 1))\nq\nq\n";
    let directory = tempfile::tempdir().unwrap();
    let commands = directory.path().join("commands");
    fs::write(&commands, script).unwrap();
    for polycrystal in [&*SPACE, &*TORUS, &*CHANNEL] {
        let (_folder, path) = write(polycrystal, "grains.fe");
        let mut evolver = Command::new("evolver");
        evolver.arg(&path).stdin(fs::File::open(&commands).unwrap());
        let test = "surface_evolver_finds_every_volume_and_the_area_and_lessens_it";
        let Some(output) = run(test, &mut evolver) else { return };
        let said = text(&output.stdout) + &text(&output.stderr);
        assert!(!said.contains("WARNING") && !said.contains("ERROR"), "{said}");
        let numbers = |word: &str| -> Vec<Vec<f64>> {
            // Other lines repeat the commands.
            let lines = said.lines().filter_map(|line| line.strip_prefix(&format!("{word} ")));
            let line = |rest: &str| rest.split_whitespace().map(|number| number.parse().unwrap()).collect();
            lines.map(line).collect()
        };
        let bodies = numbers("body");
        let volumes = polycrystal.network.cell_volumes();
        assert_eq!(bodies.len(), volumes.len(), "{said}");
        for (body, expected) in bodies.iter().zip(volumes) {
            assert!((body[1] / expected - 1.0).abs() < 1e-9, "{body:?}");
            // Between walls the last volume follows from the others, and is not held as well.
            if polycrystal.network.domain().is_periodic() || body[0] < bodies.len() as f64 {
                assert!((body[2] / expected - 1.0).abs() < 1e-12, "{body:?}");
            } else {
                assert_eq!(body[2], 0.0);
            }
        }
        let (area, expected) = (numbers("area")[0][0], energy(polycrystal));
        assert!((area / expected - 1.0).abs() < 1e-12, "{area} {expected}");
        let [later, error] = numbers("later")[0][..] else { panic!("{said}") };
        // Evolver corrects volumes to first order in each step.
        assert!(later < area && error < 1e-3, "{area} {later} {error}");
    }
}
