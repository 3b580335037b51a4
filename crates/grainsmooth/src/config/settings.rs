//! A config spelled out: as the options of a command line, and as the TOML text that every file carries.

use std::io::{self, Write};

use glam::DVec3;
use polycrystal::{FaceMesh, Junctions, Relaxation, Volumes};
use texture::{CrystalSymmetry, SampleSymmetry};
use toml::Value;
use voronoi::Dimension;

use crate::vtk::VtkEncoding;
use crate::{
    Config, FileOptions, InsideOptions, LawOptions, PeriodicCut, PhaseOptions, SeedSource, Shape, SizeDraw,
    SizeOptions, SizeSource, StlEncoding, TextureOptions,
};

/// The first words of the text in a file.
pub(crate) const BEGIN: &str = "# grainsmooth configuration";

/// The last line of the text in a file.
pub(crate) const END: &str = "# end of configuration";

/// What stands before each line of the text where a format has its own sign for comments.
pub(crate) const PREFIXES: [&str; 4] = ["comment ", "# ", "// ", "** "];

/// Options that come once for each of their values.
const REPEATED: [&str; 3] = ["inside", "phase", "tension"];

impl Config {
    /// Every setting by the long name of its option, the default ones too.
    ///
    /// What does not change the result (output path, number of threads) is left out, so files can be compared.
    pub fn settings(&self) -> Vec<(&'static str, Value)> {
        let mut settings = match &self.seeds {
            SeedSource::Random { count } => self.random("random", *count),
            SeedSource::PoissonDisc { count } => self.random("poisson-disc", *count),
            SeedSource::Packed { count } => self.random("packed", *count),
            SeedSource::Lattice { lattice, cells } => {
                vec![("lattice", Value::Array(vec![lattice.name().into(), i64::from(*cells).into()]))]
            }
            SeedSource::File(path) => vec![("seeds-file", path.display().to_string().into())],
        };
        if matches!(self.sizes.source, Some(SizeSource::VolumeFile(_))) {
            // The file tells how many.
            settings.retain(|(name, _)| *name != "seeds");
        }
        settings.extend(self.sizes.settings());
        if !self.phases.is_empty() {
            settings.push(("phase", texts(self.phases.iter().map(PhaseOptions::text))));
        }
        if !self.inside.is_empty() {
            settings.push(("inside", texts(self.inside.iter().map(InsideOptions::text))));
        }
        let mut add = |name, value: Value| settings.push((name, value));
        if self.drop_empty {
            add("drop-empty", true.into());
        }
        if self.min_diameter > 0.0 {
            add("min-diameter", self.min_diameter.into());
        }
        add("lloyd", i64::from(self.centroid_steps()).into());
        let DVec3 { x, y, z } = self.box_size;
        let sides = match self.dimension {
            Dimension::Two => {
                add("dim", 2.into());
                vec![x, y]
            }
            Dimension::Three => {
                add("dim", 3.into());
                vec![x, y, z]
            }
        };
        if !self.shape.is_from_file() {
            add("box", sides.into());
        }
        if self.aspect_ratio != DVec3::ONE {
            let axes = usize::from(self.dimension.axes());
            add("aspect-ratio", self.aspect_ratio.to_array()[..axes].to_vec().into());
        }
        if let Some(shapes) = &self.grain_shapes {
            add("grain-shapes", shapes.to_string().into());
        }
        match &self.shape {
            Shape::Box => {}
            Shape::Sphere { chord_error } => {
                add("domain", "sphere".into());
                add("chord-error", (*chord_error).into());
            }
            Shape::Cylinder { chord_error } => {
                add("domain", "cylinder".into());
                add("chord-error", (*chord_error).into());
            }
            Shape::Disc { chord_error } => {
                add("domain", "disc".into());
                add("chord-error", (*chord_error).into());
            }
            Shape::Surface(path) => add("domain", path.display().to_string().into()),
            Shape::HalfSpaces(path) => add("half-spaces", path.display().to_string().into()),
        }
        let axes = ["x", "y", "z"].into_iter().zip(<[bool; 3]>::from(self.periodic));
        let axes: Vec<&str> = axes.filter(|(_, is_periodic)| *is_periodic).map(|(axis, _)| axis).collect();
        add("periodic", if axes.is_empty() { "none".into() } else { axes.join(",").into() });
        if self.periodic_cut == PeriodicCut::Box {
            add("periodic-cut", "box".into());
        }
        match self.face_mesh {
            FaceMesh::Fan | FaceMesh::SparseFan => add("faces", "fan".into()),
            FaceMesh::Plain => add("faces", "plain".into()),
            FaceMesh::Refined { edge_length } => add("edge-length", edge_length.into()),
        }
        match self.relaxation {
            Relaxation::Time(time) => add("relax", time.into()),
            Relaxation::Equilibrium => add("relax", "equilibrium".into()),
        }
        add("wall-tension", self.wall_tension.into());
        if !self.tensions.is_empty() {
            add("tension", texts(self.tensions.iter().map(LawOptions::text)));
        }
        if !self.mobilities.is_empty() {
            add("mobility", texts(self.mobilities.iter().map(LawOptions::text)));
        }
        if self.volumes == Volumes::Free {
            add("free", true.into());
        }
        if let Some(length) = self.regularize {
            add("regularize", length.into());
        }
        add("levels", i64::from(self.levels).into());
        let junctions = match self.junctions {
            Junctions::Crease => "crease",
            Junctions::Corner => "corner",
        };
        add("junctions", junctions.into());
        settings.extend(self.texture.settings());
        settings.extend(self.file.settings(self.dimension));
        settings
    }

    fn random(&self, seeding: &str, count: usize) -> Vec<(&'static str, Value)> {
        vec![
            ("seeds", number(count as u64)),
            ("seeding", seeding.into()),
            ("rng-seed", number(self.random_seed)),
        ]
    }

    /// The command line that makes the same result, all settings spelled out.
    pub fn command_line(&self) -> String {
        let mut line = String::from("grainsmooth");
        for (name, value) in self.settings() {
            if let (true, Value::Array(values)) = (REPEATED.contains(&name), &value) {
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
            SeedSource::File(_) => Vec::new(),
            _ => {
                // What the command line takes where nothing is said.
                let relaxation = self.usual_relaxation();
                Self { relaxation, ..Self::default() }.settings()
            }
        };
        let settings = self.settings().into_iter().filter(|setting| !defaults.contains(setting));
        let settings: Vec<String> = settings.map(|(name, value)| format!("{name}={value}")).collect();
        format!("{{{}}}", settings.join(","))
    }

    /// Writes [`to_toml`](Self::to_toml) with a format's sign for comments before each line.
    pub(crate) fn write_comments(&self, sign: &str, out: &mut dyn Write) -> io::Result<()> {
        debug_assert!(PREFIXES.contains(&sign), "embedded_config knows the sign");
        self.to_toml().lines().try_for_each(|line| writeln!(out, "{sign}{line}"))
    }
}

impl SizeOptions {
    fn settings(&self) -> Vec<(&'static str, Value)> {
        let mut settings = Vec::new();
        if let Some(source) = &self.source {
            let (name, text) = source.setting();
            settings.push((name, text.into()));
        }
        if self.draw != SizeDraw::default() {
            settings.push(("draw", self.draw.name().into()));
        }
        if let Some(gradient) = &self.gradient {
            settings.push(("gradient", gradient.text().into()));
        }
        settings
    }
}

impl TextureOptions {
    fn settings(&self) -> Vec<(&'static str, Value)> {
        let mut settings = Vec::new();
        if let Some(source) = &self.source {
            settings.push(("texture", source.text().into()));
        }
        if self.symmetry != CrystalSymmetry::default() {
            settings.push(("crystal-symmetry", self.symmetry.to_string().into()));
        }
        if self.sample_symmetry != SampleSymmetry::default() {
            settings.push(("sample-symmetry", self.sample_symmetry.name().into()));
        }
        if let Some(path) = &self.misorientations {
            settings.push(("misorientations", path.display().to_string().into()));
        }
        settings
    }
}

impl FileOptions {
    fn settings(&self, dimension: Dimension) -> Vec<(&'static str, Value)> {
        let mut settings = vec![("names", self.names.name().into())];
        if let Some([x, y, z]) = self.voxels.map(|counts| counts.map(|count| i64::from(count.get()))) {
            let counts = if dimension == Dimension::Two { vec![x, y] } else { vec![x, y, z] };
            settings.push(("voxels", counts.into()));
        }
        if self.stl == StlEncoding::Ascii {
            settings.push(("ascii", true.into()));
        }
        if self.arrays {
            settings.push(("arrays", true.into()));
        }
        if self.encoding != VtkEncoding::Raw {
            settings.push(("vtk-encoding", self.encoding.name().into()));
        }
        settings
    }
}

/// A number of any size: TOML's own end at 2^63, from where on it is a text.
fn number(number: u64) -> Value {
    i64::try_from(number).map_or_else(|_| number.to_string().into(), Value::Integer)
}

fn texts(texts: impl Iterator<Item = String>) -> Value {
    Value::Array(texts.map(Value::from).collect())
}

/// A value as a word of the command line.
fn word(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Float(number) => number.to_string(),
        value => value.to_string(),
    }
}
