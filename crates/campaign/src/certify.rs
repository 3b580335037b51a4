//! Certifies what a good run left behind, independently of the run.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use glam::DVec3;
use grainsmooth::{FileElements, LabelledFile};
use polycrystal::Side;
use serde_json::Value;

use crate::case::{Case, MapPromise};
use crate::outputs::{CELLS, SUMMARY};
use crate::process;

/// The largest relative error of a grain's volume.
const VOLUME_TOLERANCE: f64 = 1e-9;

/// The largest relative difference of the volume of all grains that are measured, also in files of single precision.
const MEASURED_TOLERANCE: f64 = 1e-5;

/// What was found of a result.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Certificate {
    /// All that is wrong.
    pub faults: Vec<String>,
    /// Least angle of a triangle and the angle that a hundredth of them are below, in degrees.
    pub angles: Option<[f64; 2]>,
    /// Largest relative difference of a grain's volume to that of its cell, beyond what rounding of coordinates makes.
    pub volume_error: Option<f64>,
}

/// Looks at all that a good run promised.
///
/// # Errors
/// When the checking program cannot be run.
pub fn certify(case: &Case, program: &Path, directory: &Path, out: &[u8]) -> anyhow::Result<Certificate> {
    let mut certificate = Certificate::default();
    for name in &case.promise.files {
        let path = directory.join(name);
        let is_there = match fs::read_dir(&path) {
            Ok(mut files) => files.next().is_some(),
            Err(_) => fs::metadata(&path).is_ok_and(|found| found.len() > 0),
        };
        if !is_there {
            certificate.faults.push(format!("{name} is promised and not there, or empty"));
        }
    }
    if case.promise.prints == out.is_empty() {
        let fault =
            if out.is_empty() { "nothing on standard output" } else { "something on standard output" };
        certificate.faults.push(fault.to_owned());
    }
    let mesh =
        case.promise.mesh.as_ref().map(|name| check(name, None, program, directory, &mut certificate.faults));
    let mesh = mesh.transpose()?;
    if let Some(name) = &case.promise.surface {
        let network = check(name, case.map.as_ref(), program, directory, &mut certificate.faults)?;
        if let Some(map) = &case.map {
            let summary = json(&directory.join(SUMMARY)).unwrap_or_default();
            agree(map, &network["map"], &summary["relabelled_voxels"], &mut certificate.faults);
        }
        certificate.angles = angles(&network["triangle_angles"]);
        measure(name, &network, program, directory, &mut certificate.faults)?;
        if let Some(mesh) = mesh.filter(|mesh| mesh["grains"] != network["grains"]) {
            let [filled, all] = [&mesh["grains"], &network["grains"]];
            certificate.faults.push(format!("{filled} of {all} grains are filled"));
        }
        if case.keeps_volumes {
            let cells = directory.join(CELLS);
            let error = match cells.exists() {
                true => volume_error(&directory.join(name), &cells),
                // Grains of several cells have no table of cells: what the run itself says.
                false => said_volume_error(&directory.join(SUMMARY)),
            };
            match error {
                Ok(error) => {
                    certificate.volume_error = Some(error);
                    // Not a number is no good error either.
                    if error.is_nan() || error > VOLUME_TOLERANCE {
                        certificate.faults.push(format!("a volume is off by {error:e} of its cell's"));
                    }
                }
                Err(problem) => certificate.faults.push(problem),
            }
        }
    } else if case.promise.files.iter().any(|name| name == SUMMARY) {
        // No file to look at: what the run itself says.
        let summary = json(&directory.join(SUMMARY)).unwrap_or_default();
        certificate.angles = angles(&summary["triangle_angles"]);
        certificate.volume_error = summary["largest_relative_volume_error"].as_f64();
    }
    Ok(certificate)
}

/// What `grainsmooth check` says about a file, beside the map that it shows.
fn check(
    name: &str,
    map: Option<&MapPromise>,
    program: &Path,
    directory: &Path,
    faults: &mut Vec<String>,
) -> anyhow::Result<Value> {
    let mut words = ["check", "--json", name].map(str::to_owned).to_vec();
    if let Some(map) = map {
        words.extend([["--labels".to_owned(), map.name.clone()].to_vec(), map.options.clone()].concat());
    }
    let ended = process::run(program, &words, directory)?;
    let mut report: Value = serde_json::from_slice(&ended.out).unwrap_or_default();
    let mut report = report["files"][0].take();
    let none = Vec::new();
    let found = report["faults"].as_array().unwrap_or(&none);
    let said = json(&directory.join(SUMMARY)).unwrap_or_default()["folds"].as_u64();
    // Thin grains of maps are folded, and the run says so.
    let is_as_said = map.is_some()
        && said == u64::try_from(found.len()).ok()
        && found.iter().all(|fault| fault["kind"] == "folded");
    if is_as_said {
        report["good"] = true.into();
    } else if ended.code != 0 || report["good"] != true {
        let fault = report["faults"][0]["message"].as_str().unwrap_or(ended.err.trim());
        let count = report["faults"].as_array().map_or(0, Vec::len);
        faults.push(format!("check of {name} ends with {}: {count} faults, first: {fault}", ended.code));
    }
    Ok(report)
}

/// Whether a network has the volumes of its map, and where that is promised all voxels. Those that were relabelled are excused.
fn agree(map: &MapPromise, found: &Value, relabelled: &Value, faults: &mut Vec<String>) {
    let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
    let [differing, error] = [&found["differing_voxels"], &found["largest_volume_error"]].map(number);
    let relabelled = number(relabelled);
    let has_all = differing <= relabelled || !map.is_exact;
    let has_volumes = error <= VOLUME_TOLERANCE || relabelled > 0.0;
    if !(has_all && has_volumes) {
        faults.push(format!(
            "{differing} voxels of the map differ, {relabelled} were relabelled, and a volume is off by {error:e}"
        ));
    }
}

/// Whether `grainsmooth measure` finds the grains of a good network.
fn measure(
    name: &str,
    report: &Value,
    program: &Path,
    directory: &Path,
    faults: &mut Vec<String>,
) -> anyhow::Result<()> {
    if report["good"] != true {
        return Ok(());
    }
    let words = ["measure", "--json", name].map(str::to_owned);
    let ended = process::run(program, &words, directory)?;
    let measured: Value = serde_json::from_slice(&ended.out).unwrap_or_default();
    let [whole, of_grains] =
        [&report["volume"], &measured["volume"]].map(|volume| volume.as_f64().unwrap_or(f64::NAN));
    let is_same = (of_grains / whole - 1.0).abs() <= MEASURED_TOLERANCE;
    if ended.code != 0 || measured["grains"] != report["grains"] || !is_same {
        let said = ended.err.trim();
        faults.push(format!(
            "measure ends with {}: {} grains of volume {of_grains} where {} have {whole} {said}",
            ended.code, measured["grains"], report["grains"]
        ));
    }
    Ok(())
}

fn angles(triangles: &Value) -> Option<[f64; 2]> {
    Some([triangles["least"].as_f64()?, triangles["first_percentile"].as_f64()?])
}

fn json(path: &Path) -> Option<Value> {
    serde_json::from_slice(&fs::read(path).ok()?).ok()
}

/// The largest relative error of a grain's volume that a summary tells.
fn said_volume_error(summary: &Path) -> Result<f64, String> {
    let summary = json(summary).ok_or_else(|| format!("{} cannot be read", summary.display()))?;
    let error = summary["largest_relative_volume_error"].as_f64();
    error.ok_or_else(|| "the summary tells no volume error".to_owned())
}

/// The largest relative difference between the volumes (in the plane: areas) in a surface file and in the table of cells,
/// without what rounding its coordinates to doubles makes: half a last place of the largest coordinate, times the surface.
fn volume_error(surface: &Path, cells: &Path) -> Result<f64, String> {
    let table = json(cells).ok_or_else(|| format!("{} cannot be read", cells.display()))?;
    let rows = table["cells"].as_array().ok_or("the table of cells has none")?;
    let name = if rows.iter().all(|row| row["volume"].is_null()) { "area" } else { "volume" };
    let file = LabelledFile::read(surface).map_err(|error| error.to_string())?;
    let measured = volumes(&file);
    if measured.len() != rows.len() {
        return Err(format!("{} grains in the surface file and {} cells", measured.len(), rows.len()));
    }
    let largest = file.points.iter().map(|point| point.abs().max_element()).fold(0.0, f64::max);
    let differences = measured.values().zip(rows).map(|([volume, area], row)| {
        let wanted = row[name].as_f64().unwrap_or(f64::NAN);
        let rounding = f64::EPSILON * largest * area;
        (((volume - wanted).abs() - rounding) / wanted).max(0.0)
    });
    // The order of floats that puts what is no number last.
    Ok(differences.max_by(f64::total_cmp).unwrap_or(0.0))
}

/// Volume and surface (in the plane: area and perimeter) of each grain. Volumes are measured about the grain's first point, so
/// that no digits cancel.
fn volumes(file: &LabelledFile) -> BTreeMap<u32, [f64; 2]> {
    let corners: Vec<&[u32]> = match &file.elements {
        FileElements::Triangles(all) => all.iter().map(|corners| &corners[..]).collect(),
        FileElements::Segments(all) => all.iter().map(|ends| &ends[..]).collect(),
    };
    let mut grains: BTreeMap<u32, ([f64; 2], DVec3)> = BTreeMap::new();
    for (corners, boundary) in corners.iter().zip(&file.boundary_of) {
        let at = |corner: &u32| file.points[*corner as usize];
        for (side, sign) in file.sides[boundary.index()].iter().zip([1.0, -1.0]) {
            let Side::Grain(grain) = side else { continue };
            let ([volume, area], origin) = grains.entry(grain.0).or_insert(([0.0; 2], at(&corners[0])));
            let from = |corner: &u32| at(corner) - *origin;
            match corners {
                [a, b, c] => {
                    let normal = (at(b) - at(a)).cross(at(c) - at(a));
                    *volume += sign * from(a).dot(normal) / 6.0;
                    *area += normal.length() / 2.0;
                }
                // A grain on the first side has it on its left.
                [a, b] => {
                    *volume += sign * from(a).cross(from(b)).z / 2.0;
                    *area += at(a).distance(at(b));
                }
                _ => {}
            }
        }
    }
    grains.into_iter().map(|(grain, (measures, _))| (grain, measures)).collect()
}
