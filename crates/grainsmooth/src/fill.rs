//! Grains filled with tetrahedra by Gmsh, which is a program of its own.

mod batch;
mod msh;

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use cancellation::check_cancelled;
use glam::DVec3;
use polycrystal::{GrainId, validate};
use rayon::prelude::*;
use voronoi::Dimension;

use crate::formats::connected::ConnectedParts;
use crate::run::elements_reached::TrianglesNarrow;
use crate::volume_mesh::VolumeMesh;
use crate::{Error, Polycrystal, Stage};
use batch::Batch;

/// The program, as the shell finds it.
const GMSH: &str = "gmsh";

/// The first version whose options are those that are used here.
const LEAST_VERSION: [u32; 2] = [4, 8];

/// Gmsh's algorithms, the better one first: HXT, then Delaunay, which fills what the first cannot.
const ALGORITHMS: [(&str, &str); 2] = [("10", "HXT"), ("1", "Delaunay")];

/// Gamma below which Gmsh makes tetrahedra better. Of 200 periodic grains with five elements to a diameter, a hundredth had one below 0.405, with Gmsh's own 0.3 below 0.371, in the same time; 0.4
/// gave 0.424 in twice the time, 0.5 gave 0.434 in twenty times.
const OPTIMIZED_BELOW: &str = "0.35";

/// Triangles around the grains that Gmsh fills at a time, those between two of them counted for both. Where they are more, several runs share the processors. 10 000 grains with 1.26 million
/// triangles took Gmsh 21.5 s of processor time and 3.0 GB in one run, 19.7 s and 0.26 GB a run in 16, 18.9 s and 0.16 GB in 32, 16.9 s and 0.11 GB in 64.
const TRIANGLES: usize = 100_000;

/// Files in the folder of a run.
const SURFACE: &str = "surface.msh";
const SCRIPT: &str = "surface.geo";
const RESULT: &str = "volume.msh";

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
    let said = Command::new(GMSH).arg("--version").output().map_err(no_gmsh)?;
    let said = String::from_utf8_lossy(&[said.stdout, said.stderr].concat()).trim().to_owned();
    let mut numbers = said.split('.').map(|number| number.parse::<u32>().ok());
    match [numbers.next().flatten(), numbers.next().flatten()] {
        [Some(major), Some(minor)] if [major, minor] >= LEAST_VERSION => Ok(()),
        _ => Err(no_gmsh(format!("its version is `{said}`"))),
    }
}

fn no_gmsh(cause: impl ToString) -> Error {
    Error::NoGmsh { cause: cause.to_string() }
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
        let mut mesh = self.filled_in_batches(TRIANGLES)?;
        self.slide(&mut mesh)?;
        if let Some(curved) = self.curved.clone() {
            mesh.curve(&self.network, curved);
        }
        self.volume_mesh = Some(mesh);
        self.add_time(Stage::Filling, start.elapsed());
        Ok(self)
    }

    /// Slides points of boundaries for tetrahedra beside them, unless boundaries fold there.
    fn slide(&mut self, mesh: &mut VolumeMesh) -> Result<(), Error> {
        let pairs = self.network.periodic_vertices(&self.points, self.axes_cut_at_box())?;
        let start = mesh.points.clone();
        if !mesh.slide(&self.network, &pairs) {
            return Ok(());
        }
        let count = mesh.surface_points;
        let Ok(certificate) = validate(&self.network, &mesh.points[..count]) else {
            mesh.points = start;
            return Ok(());
        };
        let motions: Vec<DVec3> =
            start.iter().zip(&mesh.points).take(count).map(|(from, to)| *to - *from).collect();
        mesh.slid = motions.iter().filter(|by| **by != DVec3::ZERO).count();
        if let Some(curved) = &mut self.curved {
            curved.slide(&self.network, &motions);
        }
        self.points.copy_from_slice(&mesh.points[..count]);
        if let Some(reached) = &mut self.elements {
            reached.narrow = self.network.narrow_triangles(&self.points).map(TrianglesNarrow::from);
        }
        self.validation.triangles = certificate.triangles;
        self.validation.largest_volume_error = certificate.largest_volume_error;
        Ok(())
    }

    /// The tetrahedra of all grains, filled batch by batch.
    fn filled_in_batches(&self, limit: usize) -> Result<VolumeMesh, Error> {
        let surface = self.surface().map_err(no_gmsh)?;
        let connected = ConnectedParts::of(&surface).surface;
        let grain_count = self.network.grain_count();
        let batches = Batch::all(&connected, grain_count, limit);
        let tried = batches.into_par_iter().flat_map_iter(|batch| filled_or_pieces(batch, grain_count));
        let tried: Vec<Result<FilledBatch<'_>, Error>> = tried.collect();
        let (mut all_filled, mut causes) = (Vec::new(), BTreeMap::new());
        for result in tried {
            match result {
                Ok(filled) => all_filled.push(filled),
                Err(Error::NotFilled { grains, cause }) => {
                    causes.extend(grains.into_iter().map(|grain| (grain, cause.clone())));
                }
                Err(error) => return Err(error),
            }
        }
        match causes.first_key_value() {
            None => Ok(joined(&self.points, all_filled)),
            Some((_, cause)) => {
                let cause = cause.clone();
                Err(Error::NotFilled { grains: causes.into_keys().collect(), cause })
            }
        }
    }
}

/// A batch with the tetrahedra between its own points.
type FilledBatch<'a> = (Batch<'a>, VolumeMesh);

/// A batch that Gmsh fills. Where it cannot, its pieces one by one: so it is known which grains cannot be filled.
fn filled_or_pieces(batch: Batch<'_>, grain_count: usize) -> Vec<Result<FilledBatch<'_>, Error>> {
    match filled(&batch, grain_count) {
        Err(Error::NotFilled { .. }) if batch.grains().len() > 1 => {
            let pieces = batch.into_pieces();
            pieces.map(|piece| filled(&piece, grain_count).map(|mesh| (piece, mesh))).collect()
        }
        result => vec![result.map(|mesh| (batch, mesh))],
    }
}

/// The tetrahedra of a batch, between its own points.
fn filled(batch: &Batch<'_>, grain_count: usize) -> Result<VolumeMesh, Error> {
    let folder = tempfile::tempdir().map_err(no_gmsh)?;
    let write = |name: &str, write: &dyn Fn(&mut dyn Write) -> io::Result<()>| {
        let mut out = BufWriter::new(File::create(folder.path().join(name))?);
        write(&mut out)?;
        out.flush()
    };
    write(SURFACE, &|out| batch.write_surface(out)).map_err(no_gmsh)?;
    write(SCRIPT, &|out| batch.write_script(SURFACE, out)).map_err(no_gmsh)?;
    let limit = TIME + TIME_OF_TRIANGLE * u32::try_from(batch.count()).unwrap_or(u32::MAX);
    let mut last = String::new();
    for (algorithm, name) in ALGORITHMS {
        match run(folder.path(), algorithm, limit).and_then(|text| read_filled(&text, batch, grain_count)) {
            Ok(mut mesh) => {
                mesh.repair(&batch.edges());
                return Ok(mesh);
            }
            Err(cause) => last = format!("with {name}, {cause}"),
        }
    }
    let grains = batch.grains().iter().map(|grain| grain.0).collect();
    Err(Error::NotFilled { grains, cause: last })
}

/// The tetrahedra in a file of Gmsh, which must fill every grain.
fn read_filled(text: &str, batch: &Batch<'_>, grain_count: usize) -> Result<VolumeMesh, String> {
    let mesh = msh::read(text, batch.points(), &batch.grains())?;
    let volumes = mesh.grain_volumes(grain_count).into_iter().zip(batch.grain_volumes(grain_count));
    let is_wrong = |(is, wanted): &(f64, f64)| (is - wanted).abs() > VOLUME_TOLERANCE * wanted;
    let wrong = (0u32..).map(GrainId).zip(volumes).filter(|(_, volumes)| is_wrong(volumes));
    let wrong: Vec<String> = wrong.map(|(grain, _)| grain.0.to_string()).collect();
    if wrong.is_empty() { Ok(mesh) } else { Err(format!("grains {} are not filled", wrong.join(", "))) }
}

/// The tetrahedra of all batches between the points of the network, which each batch has by these numbers.
fn joined(network: &[DVec3], batches: Vec<FilledBatch<'_>>) -> VolumeMesh {
    let (surface_points, points) = (network.len(), network.to_vec());
    let mut all = VolumeMesh { surface_points, points, ..VolumeMesh::default() };
    for (batch, mesh) in batches {
        let numbers = batch.numbers();
        let first = all.points.len();
        all.points.extend(&mesh.points[numbers.len()..]);
        let number = |corner: u32| match numbers.get(corner as usize) {
            Some(number) => *number,
            None => u32::try_from(first + corner as usize - numbers.len()).expect("ids fit 32 bits"),
        };
        all.tetrahedra.extend(mesh.tetrahedra.into_iter().map(|corners| corners.map(number)));
        all.grains.extend(mesh.grains);
    }
    all.sort_by_grain();
    all
}

/// Runs Gmsh on the script of a surface; returns what it wrote. More threads make it slower, and another mesh.
fn run(folder: &Path, algorithm: &str, limit: Duration) -> Result<String, String> {
    let result = folder.join(RESULT);
    let options = [
        ("Mesh.Algorithm3D", algorithm),
        ("Mesh.OptimizeThreshold", OPTIMIZED_BELOW),
        ("Mesh.Renumber", "0"),
        ("Mesh.Binary", "0"),
    ];
    let words = folder.join("gmsh.log");
    let refused = |cause: io::Error| cause.to_string();
    let said = File::create(&words).map_err(refused)?;
    let gmsh = Command::new(GMSH)
        .current_dir(folder)
        .args(["-3", "-nt", "1", "-v", "1", "-format", "msh41", "-o", RESULT, SCRIPT])
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
    fn ends_within(mut self, limit: Duration) -> io::Result<bool> {
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

    use crate::{Config, SeedSource, make_polycrystal};

    #[test]
    fn grains_filled_in_several_runs_are_filled_as_in_one() {
        if let Err(error) = check_gmsh() {
            assert!(
                std::env::var("CI").as_deref() != Ok("true"),
                "this test cannot be skipped in CI: {error}"
            );
            return;
        }
        let config = Config { seeds: SeedSource::Random { count: 12 }, levels: 1, ..Config::default() };
        let made = make_polycrystal(&config, &|_, _, _| ()).expect("a polycrystal");
        let wanted = made.network.grain_volumes(made.network.finest(), &made.points);
        let [all, each] = [usize::MAX, 0].map(|limit| made.filled_in_batches(limit).expect("filled"));
        for mesh in [&all, &each] {
            assert_eq!(mesh.points[..mesh.surface_points], made.points[..]);
            let volumes = mesh.grain_volumes(wanted.len());
            assert!(volumes.iter().zip(&wanted).all(|(is, wanted)| (is / wanted - 1.0).abs() < 1e-12));
        }
        assert_eq!(each, made.filled_in_batches(0).expect("filled"), "runs end in any order");
    }

    #[test]
    fn programs_end_by_themselves_or_are_ended() {
        let sleeping = |seconds: &str| Running(Command::new("sleep").arg(seconds).spawn().expect("sleep"));
        assert!(sleeping("0").ends_within(Duration::from_secs(60)).expect("waited"));
        assert!(!sleeping("600").ends_within(Duration::ZERO).expect("waited"));
    }
}
