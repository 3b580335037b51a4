//! What `grainsmooth measure` says of a sample, and how to make another like it.

use std::collections::BTreeMap;
use std::fmt;
use std::io::{self, Write};
use std::path::Path;

use glam::DVec3;
use serde::Serialize;
use sizes::LognormalFit;
use texture::{CrystalSymmetry, Kernel, Orientation, texture_index};
use voronoi::Dimension;

use crate::grains::sizes::cdf_distance;
use crate::measure::sample::{MeasuredGrain, MeasuredSample};
use crate::tables::table::{Table, Value};
use crate::{EquivalentDiameters, Error, Output, Spread, TableFormat};

/// Halfwidth in degrees of the kernel with which the texture index is measured: that of 200 random grains is then within 0.3 of 1.
const HALFWIDTH: f64 = 5.0;

/// Grains whose mean lengths along the axes differ by less, in parts of one, are taken for equiaxed.
const EQUIAXED: f64 = 0.05;

/// The same where there are few: by how much the ratio of the lengths of one grain spreads, three times over.
const EQUIAXED_OF_ONE: f64 = 0.7;

/// What a sample is like. Its text is for people; serialized it is for programs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SampleReport {
    /// The file as it was named.
    pub file: String,
    /// 2 or 3.
    pub dimension: u8,
    /// Number of grains.
    pub grains: usize,
    /// Number of those that end at no wall of the sample, as far as is known.
    pub whole_grains: usize,
    /// Volume of all grains (in the plane: area), in the file's unit of length.
    pub volume: f64,
    /// Mean and spread by number.
    pub equivalent_diameter: EquivalentDiameters,
    /// The same spread over the mean.
    pub cv: f64,
    /// The lognormal distribution of the diameters, from all grains alike.
    pub lognormal_by_number: FittedDistribution,
    /// The same, from all grains by their volumes (in the plane: areas).
    pub lognormal_by_volume: FittedDistribution,
    /// Of whole grains where there are some; in the plane circularity.
    pub sphericity: Option<Spread>,
    /// Of the same grains; in the plane sides.
    pub faces: Option<Spread>,
    /// How long the same grains are along x, y and z on average by their second moments, the least being 1; z = 1 in the plane.
    pub axis_ratio: Option<[f64; 3]>,
    /// The texture, where grains have orientations.
    pub texture: Option<MeasuredTexture>,
    /// The phases, where grains have several.
    pub phases: Vec<MeasuredPhase>,
    /// The options of a run that makes grains of the fitted distribution in a box of the sample's size.
    pub twin: Vec<String>,
    /// The same of a run with the measured diameters themselves and, where there are some, orientations; nothing where no table has them.
    pub twin_of_table: Option<Vec<String>>,
}

/// A lognormal distribution of diameters by number, and how near it is.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FittedDistribution {
    /// In words, for `--diameters`.
    pub diameters: String,
    /// Mean diameter.
    pub mean: f64,
    /// Standard deviation over the mean.
    pub cv: f64,
    /// Median diameter.
    pub median: f64,
    /// Standard deviation of the natural logarithm.
    pub sigma: f64,
    /// The largest difference between the share of grains up to any diameter and the distribution's.
    pub cdf_distance: f64,
    /// The same of the shares of the volume (in the plane: of the area).
    pub cdf_distance_by_volume: f64,
}

/// A phase of a sample.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeasuredPhase {
    /// Its number in the file.
    pub number: u32,
    /// Number of its grains.
    pub grains: usize,
    /// Its share of the volume (in the plane: of the area).
    pub fraction: f64,
    /// The lognormal distribution of its diameters, in words, of the two fits the nearer.
    pub diameters: String,
}

impl MeasuredPhase {
    /// As `--phase` takes it: phases are called by their numbers.
    fn option(&self) -> String {
        format!("{}:{:?},diameters={}", self.number, self.fraction, self.diameters)
    }
}

/// The phases of a sample; none where all grains are alike, or one has none.
fn phases(sample: &MeasuredSample) -> Vec<MeasuredPhase> {
    let mut of_phases: BTreeMap<u32, Vec<f64>> = BTreeMap::new();
    for grain in &sample.grains {
        let Some(phase) = grain.phase else { return Vec::new() };
        of_phases.entry(phase).or_default().push(grain.volume);
    }
    if of_phases.len() < 2 {
        return Vec::new();
    }
    let power = sample.dimension.axes().into();
    let phase = |(number, volumes): (u32, Vec<f64>)| {
        let diameters: Vec<f64> =
            volumes.iter().map(|volume| sample.dimension.ball_diameter(*volume)).collect();
        let fits =
            [0, power].map(|by| LognormalFit::new(&diameters, by).expect("volumes are positive and finite"));
        let [distance, by_volume] = fits.map(|fit| cdf_distance(diameters.clone(), &fit.distribution(), 0));
        let [by_number, of_volume] = &fits;
        let nearer = if by_volume < distance { of_volume } else { by_number };
        MeasuredPhase {
            number,
            grains: volumes.len(),
            fraction: volumes.iter().sum::<f64>() / sample.volume(),
            diameters: nearer.spec(),
        }
    };
    of_phases.into_iter().map(phase).collect()
}

/// The orientations of a sample.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeasuredTexture {
    /// The group of rotations that crystals were taken to have.
    pub crystal_symmetry: &'static str,
    /// Number of grains that have one.
    pub orientations: usize,
    /// Halfwidth in degrees of the kernel that spread each.
    pub halfwidth: f64,
    /// The mean density at each grain that the others have, by volume; 1 is random. Nothing where there is only one.
    pub index: Option<f64>,
}

impl SampleReport {
    /// Measures a sample. `symmetry` is that of the crystals, where it is not to be the file's (cubic where that tells none); `table` a
    /// table that [`MeasuredSample::write_table`] writes.
    pub fn new(
        path: &Path,
        sample: &MeasuredSample,
        symmetry: Option<CrystalSymmetry>,
        table: Option<&Path>,
    ) -> Self {
        let diameters = sample.diameters();
        let power = sample.dimension.axes().into();
        let fit = |by: u32| {
            let fit = LognormalFit::new(&diameters, by).expect("volumes are positive and finite");
            let distribution = fit.distribution();
            FittedDistribution {
                diameters: fit.spec(),
                mean: fit.mean(),
                cv: fit.variation(),
                median: fit.median,
                sigma: fit.sigma,
                cdf_distance: cdf_distance(diameters.clone(), &distribution, 0),
                cdf_distance_by_volume: cdf_distance(diameters.clone(), &distribution, power),
            }
        };
        let [by_number, by_volume] = [fit(0), fit(power)];
        let whole: Vec<&MeasuredGrain> = sample.grains.iter().filter(|grain| !grain.is_cut).collect();
        let whole_grains = whole.len();
        let shown = if whole.is_empty() { sample.grains.iter().collect() } else { whole };
        let axis_ratio = axis_ratio(&shown, sample.dimension);
        let equivalent_diameter = EquivalentDiameters::new(sample.dimension, &diameters);
        let roundnesses: Vec<f64> = shown.iter().filter_map(|grain| grain.sphericity).collect();
        let faces: Vec<f64> = shown.iter().filter_map(|grain| Some(grain.faces? as f64)).collect();
        let texture = measured_texture(sample, symmetry);
        // Of two the nearer.
        let nearer = if by_volume.cdf_distance < by_number.cdf_distance { &by_volume } else { &by_number };
        let stretch = axis_ratio.filter(|ratio| is_stretched(*ratio, shown.len()));
        let place = options_of_place(sample, stretch);
        let phases = phases(sample);
        let sizes: Vec<String> = match phases[..] {
            [] => vec!["--diameters".to_owned(), nearer.diameters.clone()],
            _ => phases.iter().flat_map(|phase| ["--phase".to_owned(), phase.option()]).collect(),
        };
        let twin = sizes.into_iter().chain(place.clone());
        let is_list = |path: &&Path| {
            let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
            matches!(extension.to_str(), Some("csv" | "txt"))
        };
        let twin_of_table = table.or(Some(path).filter(is_list)).map(|list| {
            let name = list.display().to_string();
            let mut options = vec!["--diameters".to_owned(), name.clone()];
            if table.is_some()
                && let Some(texture) = &texture
            {
                options.extend(["--texture".to_owned(), name]);
                let symmetry: Option<CrystalSymmetry> = texture.crystal_symmetry.parse().ok();
                let symmetry = symmetry.filter(|symmetry| *symmetry != CrystalSymmetry::default());
                options.extend(
                    symmetry
                        .iter()
                        .flat_map(|symmetry| ["--crystal-symmetry".to_owned(), symmetry.to_string()]),
                );
            }
            options.into_iter().chain(place).collect()
        });
        Self {
            file: path.display().to_string(),
            dimension: sample.dimension.axes(),
            grains: sample.grains.len(),
            whole_grains,
            volume: sample.volume(),
            cv: equivalent_diameter.standard_deviation / equivalent_diameter.mean,
            equivalent_diameter,
            lognormal_by_number: by_number,
            lognormal_by_volume: by_volume,
            sphericity: Spread::of(&roundnesses),
            faces: Spread::of(&faces),
            axis_ratio: axis_ratio.map(|ratio| ratio.to_array()),
            texture,
            phases,
            twin: twin.collect(),
            twin_of_table,
        }
    }
}

impl MeasuredSample {
    /// Writes the grains as a table, one on each line: what `--diameters` reads and, where they have orientations, `--texture`.
    ///
    /// # Errors
    /// [`Error::WriteOutput`].
    pub fn write_table(&self, output: &Output<TableFormat>) -> Result<(), Error> {
        let number = |number: Option<f64>| Value::Number(number.unwrap_or(f64::NAN));
        let (volume, roundness, faces) = match self.dimension {
            Dimension::Two => ("area", "circularity", "sides"),
            Dimension::Three => ("volume", "sphericity", "faces"),
        };
        let mut columns = vec!["id", "diameter", volume, roundness, faces, "at_exterior"];
        let has_orientations = self.grains.iter().all(|grain| grain.orientation.is_some());
        if has_orientations {
            columns.extend(["phi1", "Phi", "phi2", "weight"]);
        }
        let row = |grain: &MeasuredGrain| {
            let mut row = vec![
                Value::Integer(grain.id.into()),
                number(Some(self.dimension.ball_diameter(grain.volume))),
                number(Some(grain.volume)),
                number(grain.sphericity),
                grain.faces.map_or(Value::Number(f64::NAN), |count| {
                    Value::Integer(i64::try_from(count).unwrap_or(i64::MAX))
                }),
                Value::Flag(grain.is_cut),
            ];
            if let Some(orientation) = grain.orientation.filter(|_| has_orientations) {
                row.extend(orientation.euler_degrees().map(Value::Number));
                row.push(number(Some(grain.volume)));
            }
            row
        };
        let table = Table { columns, rows: self.grains.iter().map(row).collect() };
        output.write(|out: &mut dyn Write| -> io::Result<()> { table.write_csv(out) })
    }
}

/// How long grains are along the axes, each grain counting alike, whatever its size.
fn axis_ratio(grains: &[&MeasuredGrain], dimension: Dimension) -> Option<DVec3> {
    let moments = grains
        .iter()
        .filter_map(|grain| Some(grain.second_moment? / dimension.ball_diameter(grain.volume).powi(2)));
    let sum: DVec3 = moments.sum();
    let lengths = DVec3::new(sum.x.sqrt(), sum.y.sqrt(), sum.z.sqrt());
    let (lengths, least) = match dimension {
        Dimension::Two => (lengths, lengths.x.min(lengths.y)),
        Dimension::Three => (lengths, lengths.min_element()),
    };
    let ratio = lengths / least;
    let ratio = if dimension == Dimension::Two { ratio.with_z(1.0) } else { ratio };
    (least > 0.0 && ratio.is_finite()).then_some(ratio)
}

/// Whether some grains are not equiaxed by chance.
fn is_stretched(ratio: DVec3, grains: usize) -> bool {
    ratio.max_element() > 1.0 + EQUIAXED.max(EQUIAXED_OF_ONE / (grains as f64).sqrt())
}

fn measured_texture(sample: &MeasuredSample, symmetry: Option<CrystalSymmetry>) -> Option<MeasuredTexture> {
    let symmetry = symmetry.or(sample.symmetry).unwrap_or_default();
    let oriented = sample.grains.iter().filter_map(|grain| Some((grain.orientation?, grain.volume)));
    let oriented: Vec<(Orientation, f64)> = oriented.collect();
    let kernel = Kernel::new(HALFWIDTH).expect("a good halfwidth");
    (!oriented.is_empty()).then(|| MeasuredTexture {
        crystal_symmetry: symmetry.rotation_group(),
        orientations: oriented.len(),
        halfwidth: HALFWIDTH,
        index: texture_index(&oriented, kernel, symmetry),
    })
}

/// The options that tell a twin's dimension, shape of grains, box and periods. Where the grains fill no box it is a cube of their volume.
fn options_of_place(sample: &MeasuredSample, axis_ratio: Option<DVec3>) -> Vec<String> {
    let axes = usize::from(sample.dimension.axes());
    let mut options = Vec::new();
    let mut add = |name: &str, values: &[String]| {
        options.push(format!("--{name}"));
        options.extend_from_slice(values);
    };
    if sample.dimension == Dimension::Two {
        add("dim", &["2".to_owned()]);
    }
    if let Some(ratio) = axis_ratio {
        add("aspect-ratio", &ratio.to_array().map(|length| format!("{}", digits(length, 3)))[..axes]);
    }
    let cube = || DVec3::splat(sample.dimension.cube_edge(sample.volume()));
    let size = sample.box_size.unwrap_or_else(cube);
    add("box", &size.to_array().map(|length| format!("{}", digits(length, 9)))[..axes]);
    if sample.box_size.is_some() && sample.periodic.any() {
        let names = ["x", "y", "z"].into_iter().zip(<[bool; 3]>::from(sample.periodic));
        let names: Vec<&str> = names.filter(|(_, repeats)| *repeats).map(|(name, _)| name).collect();
        add("periodic", &[names.join(",")]);
    }
    options
}

/// A number to so many digits.
fn digits(number: f64, digits: usize) -> f64 {
    format!("{number:.*e}", digits - 1).parse().expect("a number as it was written")
}

/// A command line as a shell takes it.
fn command(options: &[String]) -> String {
    let is_plain = |character: char| character.is_alphanumeric() || "-_./,:=+".contains(character);
    let word = |word: &String| {
        if !word.is_empty() && word.chars().all(is_plain) {
            word.clone()
        } else {
            format!("'{}'", word.replace('\'', r"'\''"))
        }
    };
    std::iter::once("grainsmooth".to_owned()).chain(options.iter().map(word)).collect::<Vec<_>>().join(" ")
}

impl fmt::Display for SampleReport {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let is_plane = self.dimension == 2;
        let place = if is_plane { "in the plane" } else { "in space" };
        write!(
            out,
            "{}: {} grains {place}, {} that no wall cuts",
            self.file, self.grains, self.whole_grains
        )?;
        let [mean, cv] = [self.equivalent_diameter.mean, self.cv].map(|number| digits(number, 4));
        write!(out, "\n  diameters   mean {mean}, cv {cv}")?;
        let measure = if is_plane { "area" } else { "volume" };
        for (by, fit) in [("number", &self.lognormal_by_number), (measure, &self.lognormal_by_volume)] {
            write!(
                out,
                "\n  fit         {} by {by}; distribution function within {:.4} (by {measure} {:.4})",
                fit.diameters, fit.cdf_distance, fit.cdf_distance_by_volume
            )?;
        }
        let names = if is_plane { ["circularity", "sides"] } else { ["sphericity", "faces"] };
        for (name, spread) in names.into_iter().zip([self.sphericity, self.faces]) {
            if let Some(Spread { mean, standard_deviation }) = spread {
                write!(out, "\n  {name:12}{mean:.4} +- {standard_deviation:.4}")?;
                if self.whole_grains > 0 && self.whole_grains < self.grains {
                    write!(out, " of those that no wall cuts")?;
                }
            }
        }
        if let Some([x, y, z]) = self.axis_ratio {
            write!(out, "\n  lengths     {x:.3} : {y:.3}")?;
            if !is_plane {
                write!(out, " : {z:.3}")?;
            }
            write!(out, " along the axes")?;
        }
        if let Some(MeasuredTexture { crystal_symmetry, orientations, halfwidth, index }) = &self.texture {
            write!(out, "\n  texture     {orientations} orientations of {crystal_symmetry} crystals")?;
            if let Some(index) = index {
                write!(out, ", index {index:.3} with a kernel of {halfwidth} degrees")?;
            }
        }
        for MeasuredPhase { number, grains, fraction, diameters } in &self.phases {
            let share = 100.0 * fraction;
            write!(
                out,
                "\n  phase {number:<6}{share:.4} % of the {measure} in {grains} grains, {diameters}"
            )?;
        }
        write!(out, "\n  twin        {}", command(&self.twin))?;
        if let Some(options) = &self.twin_of_table {
            write!(out, "\n  twin        {}", command(options))?;
        }
        Ok(())
    }
}
