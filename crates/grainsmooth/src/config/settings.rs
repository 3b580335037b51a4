//! A config spelled out: as the options of a command line, and as the TOML text that every file carries.

use glam::{BVec3, DVec3};
use polycrystal::{FaceMesh, Junctions, Relaxation};
use serde::ser::{Serialize, SerializeMap, Serializer};
use toml::{Table, Value};
use voronoi::Dimension;

use super::spelling::Named;
use super::{Config, SeedSource, Shape};

/// The first words of the text in a file.
pub(crate) const BEGIN: &str = "# grainsmooth configuration";

/// The last line of the text in a file.
pub(crate) const END: &str = "# end of configuration";

/// What stands before each line of the text where a format has its own sign for comments.
pub(crate) const PREFIXES: [&str; 5] = ["comment ", "# ", "// ", "** ", "$ "];

/// Options that come once for each of their values.
const REPEATED: [&str; 3] = ["inside", "phase", "tension"];

impl Config {
    /// Every setting by the long name of its option, the default ones too, in the order of the fields.
    ///
    /// What does not change the result (output path, number of threads) is left out, so files can be compared.
    pub fn settings(&self) -> Table {
        let resolved = Self { lloyd_steps: Some(self.centroid_steps()), ..self.clone() };
        let mut settings = Table::try_from(resolved).expect("settings are numbers, texts and lists of them");
        let has_random_seeds = settings.contains_key("seeding");
        if !has_random_seeds {
            settings.remove("rng-seed");
        }
        if settings.contains_key("volumes") {
            // The file tells how many.
            settings.remove("seeds");
        }
        if self.shape.is_from_file() {
            settings.remove("box");
        }
        if self.dimension == Dimension::Two {
            for along_axes in ["box", "aspect-ratio", "voxels"] {
                if let Some(Value::Array(values)) = settings.get_mut(along_axes) {
                    values.truncate(2);
                }
            }
        }
        settings
    }

    /// The command line that makes the same result, all settings spelled out.
    pub fn command_line(&self) -> String {
        let mut line = String::from("grainsmooth");
        for (name, value) in self.settings() {
            if let (true, Value::Array(values)) = (REPEATED.contains(&name.as_str()), &value) {
                line.extend(values.iter().map(|value| format!(" --{name} {}", word(value))));
                continue;
            }
            line += &format!(" --{name}");
            match value {
                Value::Boolean(_) => {}
                Value::Array(values) => line.extend(values.iter().map(|value| format!(" {}", word(value)))),
                value => line += &format!(" {}", word(&value)),
            }
        }
        line
    }

    /// All settings as TOML, which [`embedded_config`](crate::embedded_config()) finds in any file.
    pub fn to_toml(&self) -> String {
        let lines = self.settings().into_iter().map(|(name, value)| format!("{name} = {value}\n"));
        format!(
            "{BEGIN}: `grainsmooth --config` with this file runs it again\n{}{END}\n",
            lines.collect::<String>()
        )
    }

    /// The settings that are not the default ones, as a TOML table in one line.
    pub(crate) fn differences(&self) -> String {
        let defaults = match self.seeds {
            // The file may give box and periods of its own, which become defaults where they are not named.
            SeedSource::File(_) => Table::new(),
            _ => {
                // What the command line takes where nothing is said.
                let relaxation = Some(self.usual_relaxation());
                Self { relaxation, ..Self::default() }.settings()
            }
        };
        let settings = self.settings().into_iter().filter(|(name, value)| defaults.get(name) != Some(value));
        let settings: Vec<String> = settings.map(|(name, value)| format!("{name}={value}")).collect();
        format!("{{{}}}", settings.join(","))
    }
}

/// A value as a word of the command line.
fn word(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Float(number) => number.to_string(),
        value => value.to_string(),
    }
}

impl Serialize for SeedSource {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let (count, seeding) = match self {
            Self::Random { count } => (*count, "random"),
            Self::PoissonDisc { count } => (*count, "poisson-disc"),
            Self::Packed { count } => (*count, "packed"),
            Self::Lattice { lattice, cells } => {
                return serializer.collect_map([("lattice", (lattice.name(), cells))]);
            }
            Self::File(path) => return serializer.collect_map([("seeds-file", path)]),
        };
        let mut settings = serializer.serialize_map(None)?;
        settings.serialize_entry("seeds", &count)?;
        settings.serialize_entry("seeding", seeding)?;
        settings.end()
    }
}

impl Serialize for Shape {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut settings = serializer.serialize_map(None)?;
        let mut round = |name: &str, chord_error: &f64| {
            settings.serialize_entry("domain", name)?;
            settings.serialize_entry("chord-error", chord_error)
        };
        match self {
            Self::Box => {}
            Self::Sphere { chord_error } => round("sphere", chord_error)?,
            Self::Cylinder { chord_error } => round("cylinder", chord_error)?,
            Self::Disc { chord_error } => round("disc", chord_error)?,
            Self::Surface(path) => settings.serialize_entry("domain", path)?,
            Self::HalfSpaces(path) => settings.serialize_entry("half-spaces", path)?,
        }
        settings.end()
    }
}

/// The number of axes.
pub(super) fn as_axes<S: Serializer>(dimension: &Dimension, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_u8(dimension.axes())
}

pub(super) fn as_lengths<S: Serializer>(lengths: &DVec3, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(lengths.to_array())
}

pub(super) fn is_equiaxed(ratio: &DVec3) -> bool {
    *ratio == DVec3::ONE
}

/// The names of some axes, or `none`.
pub(super) fn as_axis_names<S: Serializer>(axes: &BVec3, serializer: S) -> Result<S::Ok, S::Error> {
    let named = ["x", "y", "z"].into_iter().zip(<[bool; 3]>::from(*axes));
    let names: Vec<&str> = named.filter(|(_, is_one)| *is_one).map(|(name, _)| name).collect();
    match &names[..] {
        [] => serializer.serialize_str("none"),
        names => serializer.collect_str(&names.join(",")),
    }
}

/// `--faces` or `--edge-length`.
pub(super) fn by_option<S: Serializer>(mesh: &FaceMesh, serializer: S) -> Result<S::Ok, S::Error> {
    match mesh {
        FaceMesh::Fan | FaceMesh::SparseFan => serializer.collect_map([("faces", "fan")]),
        FaceMesh::Plain => serializer.collect_map([("faces", "plain")]),
        FaceMesh::Refined { edge_length } => serializer.collect_map([("edge-length", edge_length)]),
    }
}

/// Reads `--relax`.
pub(crate) fn parse_relaxation(text: &str) -> Result<Relaxation, String> {
    if text == EQUILIBRIUM {
        return Ok(Relaxation::Equilibrium);
    }
    let time = text.parse().ok().filter(|time: &f64| time.is_finite() && *time >= 0.0);
    let time = time.ok_or_else(|| {
        "the relaxation time is 0 (off), a positive, finite number, or equilibrium".to_owned()
    });
    time.map(Relaxation::Time)
}

pub(super) fn as_time<S: Serializer>(
    relaxation: &Option<Relaxation>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    match relaxation {
        Some(Relaxation::Time(time)) => serializer.serialize_f64(*time),
        Some(Relaxation::Equilibrium) => serializer.serialize_str(EQUILIBRIUM),
        None => serializer.serialize_none(),
    }
}

/// What `--relax` calls equilibrium.
const EQUILIBRIUM: &str = "equilibrium";

/// The names of `--junctions`.
pub(super) const JUNCTIONS: [Named<Junctions>; 2] =
    [("crease", "", Junctions::Crease), ("corner", "", Junctions::Corner)];

pub(super) fn as_rule<S: Serializer>(rule: &Junctions, serializer: S) -> Result<S::Ok, S::Error> {
    let named = JUNCTIONS.into_iter().find(|(.., known)| known == rule);
    serializer.collect_str(named.map_or("", |(name, ..)| name))
}
