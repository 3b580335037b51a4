use colorous::VIRIDIS;
use glam::DVec3;
use polycrystal::Boundary;

use super::color::{Color, channels, differing, kind};
use super::legend::Legend;
use crate::Polycrystal;
use crate::figures::significant::significant;

/// What the colours of grains mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Coloring {
    /// Nothing, but that no neighbours are alike.
    #[default]
    Grain,
    /// The equivalent diameter, from the smallest (violet) to the largest grain (yellow).
    Diameter,
    /// The number of boundaries, from the fewest (violet) to the most (yellow).
    Neighbors,
    /// The phase: orange, sky blue, green, yellow, blue and on, in the order of their numbers.
    Phase,
    /// The crystal's direction along the sample's x, in inverse pole figure colours.
    IpfX,
    /// The same along y.
    IpfY,
    /// The same along z.
    IpfZ,
    /// Of each boundary, the disorientation of its grains, from none (violet) to the largest (yellow).
    Disorientation,
}

/// Of the outer surface where boundaries are coloured: light grey.
const WALL: Color = [0.85; 3];

/// The colours of a picture.
pub(crate) struct Paint {
    /// Of each grain.
    pub(crate) grains: Vec<Color>,
    /// Of each boundary, where these are shown and not the grains.
    pub(crate) boundaries: Option<Vec<Color>>,
    /// What they mean.
    pub(crate) legend: Option<Legend>,
}

impl Coloring {
    /// Every way with its name on the command line, the default first.
    pub const ALL: [(Self, &'static str); 8] = [
        (Self::Grain, "grain"),
        (Self::Diameter, "diameter"),
        (Self::Neighbors, "neighbors"),
        (Self::Phase, "phase"),
        (Self::IpfX, "ipf-x"),
        (Self::IpfY, "ipf-y"),
        (Self::IpfZ, "ipf-z"),
        (Self::Disorientation, "disorientation"),
    ];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        Self::ALL.into_iter().find(|(one, _)| *one == self).map_or("", |(_, name)| name)
    }

    /// Whether it shows orientations, which grains may not have.
    pub fn needs_texture(self) -> bool {
        self.sample_axis().is_some() || self == Self::Disorientation
    }

    fn sample_axis(self) -> Option<DVec3> {
        match self {
            Self::IpfX => Some(DVec3::X),
            Self::IpfY => Some(DVec3::Y),
            Self::IpfZ => Some(DVec3::Z),
            _ => None,
        }
    }

    /// The colours of a polycrystal, whose grains have orientations where the colours need them.
    pub(crate) fn paint(self, polycrystal: &Polycrystal) -> Paint {
        if let (Some(axis), Some(texture)) = (self.sample_axis(), &polycrystal.grains().texture) {
            let grains = texture.colors(axis).map(|color| color.map(|channel| f64::from(channel) / 255.0));
            let legend =
                Legend::Directions { title: self.name().to_owned(), symmetries: texture.symmetries() };
            return Paint { grains: grains.collect(), boundaries: None, legend: Some(legend) };
        }
        match self {
            Self::Diameter => viridis("diameter", polycrystal.equivalent_diameters()),
            Self::Neighbors => {
                let counts = polycrystal.boundary_counts();
                viridis("boundaries", counts.into_iter().map(|count| count as f64).collect())
            }
            Self::Phase => phases(polycrystal),
            Self::Disorientation => disorientations(polycrystal),
            Self::Grain | Self::IpfX | Self::IpfY | Self::IpfZ => {
                let sides = polycrystal.network.boundaries().iter().map(|boundary| boundary.sides);
                let pairs = sides.filter_map(|[a, b]| Some([a.grain()?.index(), b.grain()?.index()]));
                let kinds = differing(polycrystal.network.grain_count(), pairs);
                Paint { grains: kinds.into_iter().map(kind).collect(), boundaries: None, legend: None }
            }
        }
    }
}

/// Colours of grains by numbers.
fn viridis(title: &str, values: Vec<f64>) -> Paint {
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let greatest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let range = greatest - least;
    let place = |value: f64| if range > 0.0 { (value - least) / range } else { 0.5 };
    let ends = [least, greatest].map(|value| significant(value, 4));
    Paint {
        grains: values.into_iter().map(|value| channels(VIRIDIS.eval_continuous(place(value)))).collect(),
        boundaries: None,
        legend: Some(Legend::Bar { title: title.to_owned(), ends }),
    }
}

fn phases(polycrystal: &Polycrystal) -> Paint {
    let grains = polycrystal.grains();
    let names = grains.phases.iter().flat_map(|phases| phases.names());
    Paint {
        grains: grains.phase_of().into_iter().map(kind).collect(),
        boundaries: None,
        legend: Some(Legend::Names((0..).map(kind).zip(names.map(str::to_owned)).collect())),
    }
}

/// Colours of boundaries by the angles between the grains' crystals; grains are white, outer surfaces grey.
fn disorientations(polycrystal: &Polycrystal) -> Paint {
    let network = &polycrystal.network;
    let angle = |boundary: &Boundary| {
        let found = polycrystal.grains().texture.as_ref()?.disorientation(boundary.sides)?;
        Some(found.angle)
    };
    let angles: Vec<Option<f64>> = network.boundaries().iter().map(angle).collect();
    let largest = angles.iter().flatten().copied().fold(0.0, f64::max);
    let color = |angle: &Option<f64>| {
        angle.map_or(WALL, |angle| channels(VIRIDIS.eval_continuous(angle / largest.max(f64::MIN_POSITIVE))))
    };
    Paint {
        grains: vec![[1.0; 3]; network.grain_count()],
        boundaries: Some(angles.iter().map(color).collect()),
        legend: Some(Legend::Bar {
            title: "disorientation".to_owned(),
            ends: ["0\u{b0}".to_owned(), format!("{largest:.1}\u{b0}")],
        }),
    }
}
