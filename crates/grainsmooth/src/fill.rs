//! Grains filled with tetrahedra by Gmsh, which is a program of its own.

mod msh;

use std::collections::BTreeSet;
use std::fs::File;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use cancellation::check_cancelled;
use polycrystal::{GrainId, Mesh};
use voronoi::Dimension;

use crate::volume_mesh::VolumeMesh;
use crate::{Error, Output, Polycrystal, Stage};

/// The program, as the shell finds it.
const GMSH: &str = "gmsh";

/// The first version whose options are those that are used here.
const LEAST_VERSION: [u32; 2] = [4, 8];

/// Gmsh's algorithms, the better one first: HXT, then Delaunay, which fills what the first cannot.
const ALGORITHMS: [(&str, &str); 2] = [("10", "HXT"), ("1", "Delaunay")];

/// Gamma below which Gmsh makes tetrahedra better. Of 200 periodic grains with five elements to a diameter, a hundredth had one below 0.405, with Gmsh's own 0.3 below 0.371, in the same time; 0.4
/// gave 0.424 in twice the time, 0.5 gave 0.434 in twenty times.
const OPTIMIZED_BELOW: &str = "0.35";

/// Time that Gmsh may take, and more for each triangle of the surface: a hundred times what HXT takes, which fills what 100 000 triangles enclose in 3 s. Where it takes longer it
/// does not end at all.
const TIME: Duration = Duration::from_secs(60);
const TIME_OF_TRIANGLE: Duration = Duration::from_millis(3);

/// Time between two looks whether it has ended.
const PAUSE: Duration = Duration::from_millis(10);

/// How much of a grain's volume tetrahedra may miss: they have its very triangles.
const VOLUME_TOLERANCE: f64 = 1e-9;

/// Checks that Gmsh is there, and new enough.
///
/// # Errors
/// [`Error::NoGmsh`] with what to do.
pub fn check_gmsh() -> Result<(), Error> {
    let refused = |cause: String| Error::NoGmsh { cause };
    let said = Command::new(GMSH).arg("--version").output().map_err(|cause| refused(cause.to_string()))?;
    let said = String::from_utf8_lossy(&[said.stdout, said.stderr].concat()).trim().to_owned();
    let mut numbers = said.split('.').map(|number| number.parse::<u32>().ok());
    match [numbers.next().flatten(), numbers.next().flatten()] {
        [Some(major), Some(minor)] if [major, minor] >= LEAST_VERSION => Ok(()),
        _ => Err(refused(format!("its version is `{said}`"))),
    }
}

impl Polycrystal {
    /// Fills the grains with tetrahedra between the triangles of their boundaries, which stay as they are. In the plane grains are filled as elements get their size.
    ///
    /// # Errors
    /// [`Error::NoGmsh`]; [`Error::NotFilled`] with the grains that Gmsh could not fill.
    pub fn filled(mut self) -> Result<Self, Error> {
        if self.dimension() == Dimension::Two {
            return Ok(self);
        }
        check_gmsh()?;
        let start = Instant::now();
        let folder = tempfile::tempdir().map_err(|cause| Error::NoGmsh { cause: cause.to_string() })?;
        self.write(&Output::check(folder.path().join("surface.msh"))?)?;
        let mut last = None;
        for (algorithm, name) in ALGORITHMS {
            let triangles = u32::try_from(self.network.finest().element_count()).unwrap_or(u32::MAX);
            let limit = TIME + TIME_OF_TRIANGLE * triangles;
            let filled = run(folder.path(), algorithm, limit).and_then(|text| self.read_filled(&text));
            match filled {
                Ok(mut mesh) => {
                    mesh.repair(&self.edges_of_boundaries());
                    if let Some(middles) = self.middles.clone() {
                        mesh.curve(&self.network, middles);
                    }
                    self.volume_mesh = Some(mesh);
                    self.add_time(Stage::Filling, start.elapsed());
                    return Ok(self);
                }
                Err(cause) => last = Some(Error::NotFilled { cause: format!("with {name}, {cause}") }),
            }
        }
        Err(last.expect("there are algorithms"))
    }

    /// The tetrahedra in a file of Gmsh, which must fill every grain.
    fn read_filled(&self, text: &str) -> Result<VolumeMesh, String> {
        let mesh = msh::read(text, &self.points)?;
        let wanted = self.network.grain_volumes(self.network.finest(), &self.points);
        let volumes = mesh.grain_volumes(wanted.len());
        let is_wrong = |(is, wanted): (&f64, &f64)| (is / wanted - 1.0).abs() > VOLUME_TOLERANCE;
        let both = (0u32..).map(GrainId).zip(volumes.iter().zip(&wanted));
        let wrong: Vec<String> =
            both.filter(|(_, volumes)| is_wrong(*volumes)).map(|(grain, _)| grain.0.to_string()).collect();
        if wrong.is_empty() { Ok(mesh) } else { Err(format!("grains {} are not filled", wrong.join(", "))) }
    }

    /// The edges of all triangles, the lower end first.
    fn edges_of_boundaries(&self) -> BTreeSet<[u32; 2]> {
        let level = self.network.finest_level();
        let Mesh::Triangles(mesh) = &level.mesh else { return BTreeSet::new() };
        let edges = mesh.triangles().iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        edges.map(|[a, b]| [a.min(b), a.max(b)]).collect()
    }
}

/// Runs Gmsh on the script of a surface; returns what it wrote. More threads make it slower, and another mesh.
fn run(folder: &Path, algorithm: &str, limit: Duration) -> Result<String, String> {
    let result = folder.join("volume.msh");
    let options = [
        ("Mesh.Algorithm3D", algorithm),
        ("Mesh.OptimizeThreshold", OPTIMIZED_BELOW),
        ("Mesh.Renumber", "0"),
        ("Mesh.Binary", "0"),
    ];
    let words = folder.join("gmsh.log");
    let refused = |cause: std::io::Error| cause.to_string();
    let said = File::create(&words).map_err(refused)?;
    let gmsh = Command::new(GMSH)
        .current_dir(folder)
        .args(["-3", "-nt", "1", "-v", "1", "-format", "msh41", "-o", "volume.msh", "surface.geo"])
        .args(options.into_iter().flat_map(|(name, value)| ["-setnumber", name, value]))
        .stdin(Stdio::null())
        .stdout(said.try_clone().map_err(refused)?)
        .stderr(said)
        .spawn()
        .map_err(refused)?;
    if !Running(gmsh).ends_within(limit).map_err(refused)? {
        return Err(format!("Gmsh did not end within {} s", limit.as_secs()));
    }
    let said = String::from_utf8_lossy(&std::fs::read(words).map_err(refused)?).into_owned();
    let error = said.lines().find(|line| line.contains("Error"));
    match (std::fs::read_to_string(result), error) {
        (Ok(text), None) => Ok(text),
        (_, Some(error)) => Err(format!("Gmsh says `{}`", error.trim())),
        (Err(cause), None) => Err(format!("Gmsh wrote nothing: {cause}")),
    }
}

/// A program that ends when nobody waits for it any longer.
struct Running(Child);

impl Running {
    /// Waits for the program; whether it has ended by then.
    fn ends_within(mut self, limit: Duration) -> std::io::Result<bool> {
        let start = Instant::now();
        while self.0.try_wait()?.is_none() {
            if start.elapsed() > limit {
                return Ok(false);
            }
            check_cancelled();
            sleep(PAUSE);
        }
        Ok(true)
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        // It may have ended meanwhile.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn programs_end_by_themselves_or_are_ended() {
        let sleeping = |seconds: &str| Running(Command::new("sleep").arg(seconds).spawn().expect("sleep"));
        assert!(sleeping("0").ends_within(Duration::from_secs(60)).expect("waited"));
        assert!(!sleeping("600").ends_within(Duration::ZERO).expect("waited"));
    }
}
