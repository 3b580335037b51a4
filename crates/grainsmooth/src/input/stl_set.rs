//! The network of a set of STL files: one for each grain, or for each boundary, or one with all boundaries.

mod enclosed;

use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};

use glam::DVec3;

use self::enclosed::enclosed;
use crate::maps::slices::last_number;
use crate::mesh::file::vtk::labelled::LabelledCells;
use crate::mesh::file::{MeshFile, MeshFileProblem, stl};

/// Whether a path leads to STL: a file, or a folder with some.
pub(super) fn is_known(path: &Path) -> bool {
    is_stl(path) || path.is_dir() && files(path).is_ok_and(|files| !files.is_empty())
}

/// The triangles of all files. Where each of several files is closed, it holds the grain with the last number in its name (where a name has none, or two the same, by their order
/// from 0), and other triangles lie between what they enclose, numbered from 0.
///
/// # Errors
/// As of [`stl::read`]; where triangles leave a gap.
pub(super) fn read(path: &Path) -> Result<LabelledCells, MeshFileProblem> {
    let paths = if path.is_dir() { files(path)? } else { vec![path.to_owned()] };
    let mut set = Set::default();
    for path in &paths {
        let bytes = std::fs::read(path).map_err(MeshFileProblem::Unreadable)?;
        set.add(&stl::read(&bytes).map_err(|problem| problem.in_file(path))?)?;
    }
    let (triangles, labels) = if paths.len() > 1 && set.are_closed() {
        set.between_files(&numbers(&paths))
    } else {
        let triangles = set.once();
        let sides = enclosed(&set.points, &triangles).map_err(|gap| {
            let [x, y, z] = gap.to_array();
            MeshFileProblem::corrupt(
                "STL",
                format!("the boundaries leave a gap at the edge in ({x}, {y}, {z})"),
            )
        })?;
        smaller_first(triangles, sides)
    };
    let faces = triangles.into_iter().map(Vec::from).collect();
    Ok(LabelledCells {
        mesh: MeshFile { points: set.points, faces, ..MeshFile::default() },
        labels,
        label_array: "FaceLabels",
        is_single: true,
        ..LabelledCells::default()
    })
}

fn is_stl(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("stl"))
}

/// The STL files of a folder, by their names.
fn files(folder: &Path) -> Result<Vec<PathBuf>, MeshFileProblem> {
    let entries = std::fs::read_dir(folder).map_err(MeshFileProblem::Unreadable)?;
    let mut paths = entries
        .map(|entry| entry.map(|entry| entry.path()))
        .collect::<Result<Vec<_>, _>>()
        .map_err(MeshFileProblem::Unreadable)?;
    paths.retain(|path| is_stl(path));
    paths.sort();
    Ok(paths)
}

/// The grain of each file.
fn numbers(paths: &[PathBuf]) -> Vec<i64> {
    let number = |path: &PathBuf| {
        let number = last_number(&path.file_name()?.to_string_lossy())?;
        u32::try_from(number).ok().map(i64::from)
    };
    let numbers: Option<Vec<i64>> = paths.iter().map(number).collect();
    let are_distinct = |numbers: &Vec<i64>| {
        let mut sorted = numbers.clone();
        sorted.sort_unstable();
        sorted.windows(2).all(|pair| pair[0] != pair[1])
    };
    numbers.filter(are_distinct).unwrap_or_else(|| (0..).take(paths.len()).collect())
}

/// Triangles of several files between points that are there once.
#[derive(Default)]
struct Set {
    points: Vec<DVec3>,
    ids: HashMap<[u64; 3], u32>,
    triangles: Vec<[u32; 3]>,
    /// The triangles before each file.
    starts: Vec<usize>,
}

type Labelled = (Vec<[u32; 3]>, Vec<[i64; 2]>);

impl Set {
    /// Adds a file; points of several files are one where their coordinates are exactly equal.
    fn add(&mut self, mesh: &MeshFile) -> Result<(), MeshFileProblem> {
        self.starts.push(self.triangles.len());
        let mut ids = Vec::with_capacity(mesh.points.len());
        for point in &mesh.points {
            let next = u32::try_from(self.points.len())
                .map_err(|_| MeshFileProblem::corrupt("STL", "it has more points than ids can name"))?;
            let id = *self.ids.entry(point.to_array().map(f64::to_bits)).or_insert(next);
            if id == next {
                self.points.push(*point);
            }
            ids.push(id);
        }
        self.triangles
            .extend(mesh.triangles()?.iter().map(|corners| corners.map(|corner| ids[corner as usize])));
        Ok(())
    }

    /// The triangles of each file.
    fn files(&self) -> impl Iterator<Item = &[[u32; 3]]> {
        let ends = self.starts.iter().skip(1).chain([&self.triangles.len()]).copied().collect::<Vec<_>>();
        self.starts.iter().zip(ends).map(|(start, end)| &self.triangles[*start..end])
    }

    /// Whether each edge of each file is run through as often one way as the other.
    fn are_closed(&self) -> bool {
        self.files().all(|triangles| {
            let mut balance: HashMap<[u32; 2], i64> = HashMap::new();
            for [a, b, c] in triangles {
                for [from, to] in [[a, b], [b, c], [c, a]] {
                    *balance.entry([*from.min(to), *from.max(to)]).or_default() +=
                        if from < to { 1 } else { -1 };
                }
            }
            balance.values().all(|balance| *balance == 0)
        })
    }

    /// Each triangle once, between the grain that it is of and the other that has it too.
    fn between_files(&self, grains: &[i64]) -> Labelled {
        let mut found: BTreeMap<[u32; 3], Vec<(i64, [u32; 3])>> = BTreeMap::new();
        for (triangles, grain) in self.files().zip(grains) {
            for triangle in triangles {
                found.entry(sorted(*triangle)).or_default().push((*grain, *triangle));
            }
        }
        let (mut triangles, mut labels) = (Vec::new(), Vec::new());
        for mut grains in found.into_values() {
            grains.sort_unstable();
            // Of what is there more often than twice, each stands for itself, and the certificate tells.
            for pair in grains.chunks(2) {
                triangles.push(pair[0].1);
                labels.push([pair[0].0, pair.get(1).map_or(-1, |(grain, _)| *grain)]);
            }
        }
        (triangles, labels)
    }

    /// Each triangle once, however often it is there.
    fn once(&self) -> Vec<[u32; 3]> {
        let mut seen = std::collections::HashSet::new();
        self.triangles.iter().copied().filter(|triangle| seen.insert(sorted(*triangle))).collect()
    }
}

fn sorted(mut triangle: [u32; 3]) -> [u32; 3] {
    triangle.sort_unstable();
    triangle
}

/// Turns triangles so that the smaller label comes first and the exterior second.
fn smaller_first(triangles: Vec<[u32; 3]>, sides: Vec<[i64; 2]>) -> Labelled {
    let turned = |([a, b, c], [first, second]): ([u32; 3], [i64; 2])| match (first, second) {
        (0.., 0..) if first <= second => ([a, b, c], [first, second]),
        (0.., ..0) => ([a, b, c], [first, second]),
        _ => ([a, c, b], [second, first]),
    };
    triangles.into_iter().zip(sides).map(turned).unzip()
}
