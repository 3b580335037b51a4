//! Networks from files, of this program or of others.

use std::collections::BTreeMap;
use std::path::Path;

use clap::ValueEnum;
use glam::DVec3;
use polycrystal::{BoundaryId, Elements, Expected, GrainId, NodeType, Side, Surface, outward_sides};
use texture::{CrystalSymmetry, Orientation};
use toml::{Table, Value};
use voronoi::Dimension;

use super::{evolver, polygons, stl_set, tess_network};
use crate::error::map_file::MapProblem;
use crate::maps::hdf5;
use crate::mesh::file::vtk::labelled::{LabelledCells, read_legacy, read_xml};
use crate::mesh::file::{MeshFileProblem, check_lengths};
use crate::names::{CONFIG, CRYSTAL_SYMMETRIES, EULER_ANGLES, PERIODS, PHASE, PHASE_NAMES, SEED_ID, VOLUMES};
use crate::{Config, Error, Names};

/// A labelled surface (in the plane: lines) from a file.
#[derive(Debug, Clone, PartialEq)]
pub struct LabelledFile {
    /// Coordinates.
    pub points: Vec<DVec3>,
    /// Triangles or segments.
    pub elements: FileElements,
    /// The boundary of each element: one for each pair of labels in the file, and in those of this program for each number of a boundary.
    pub boundary_of: Vec<BoundaryId>,
    /// The two sides of each boundary, in the order in which normals point from first to second.
    pub sides: Vec<[Side; 2]>,
    /// Whether each boundary has a periodic image, where the file tells it.
    pub comes_again: Vec<bool>,
    /// Types of points; nothing where the file has none, or a code that means nothing.
    pub node_types: Option<Vec<Option<NodeType>>>,
    /// How many grains meet at each point, if the file says so.
    pub grain_counts: Option<Vec<u8>>,
    /// In a periodic network, the point that each point is a copy of, or itself.
    pub originals: Option<Vec<u32>>,
    /// The cell array that the labels are from.
    pub label_array: &'static str,
    /// The volumes of all grains (in the plane: areas) as the file states them, if this program wrote it.
    pub volumes: Option<Vec<(GrainId, f64)>>,
    /// The orientations of all grains, if this program wrote the file and they have some.
    pub orientations: Option<Vec<(GrainId, Orientation)>>,
    /// The numbers of the phases of all grains, if this program wrote the file and they have some.
    pub phases: Option<Vec<(GrainId, u32)>>,
    /// The names of the phases, from number 1.
    pub phase_names: Vec<String>,
    /// The symmetries of the crystals of all phases, or, without phases, of all grains.
    pub symmetries: Vec<CrystalSymmetry>,
    /// The numbers of the seeds of all grains, or what they were called in the map that they come from, if this program wrote the file.
    pub seed_ids: Option<Vec<(GrainId, u32)>>,
    /// The periods along the axes, 0 where nothing repeats; nothing where nothing does along any.
    pub periods: Option<DVec3>,
    /// What coordinates in the file are those of `points` multiplied by.
    pub stretch: DVec3,
    /// Whether the file has its points in single precision.
    pub is_single: bool,
    /// The settings by the long names of their options, if this program wrote it.
    pub settings: Option<Table>,
}

/// The elements of a [`LabelledFile`].
#[derive(Debug, Clone, PartialEq)]
pub enum FileElements {
    /// In space.
    Triangles(Vec<[u32; 3]>),
    /// In the plane; polylines are cut into their segments.
    Segments(Vec<[u32; 2]>),
}

impl LabelledFile {
    /// Reads a network from a .vtp, .vtu, .vtk, .tess, .fe, .dmp or .dream3d file, from polygons in the plane as .json or .csv, or from a .stl file or a folder of them.
    ///
    /// Cells of a .tess file (Neper) are taken as they are, convex or not, and numbered from 0, as are polygons. Bodies of Surface Evolver (.fe, .dmp) keep their numbers. Several .stl files that are
    /// closed are a grain each, with the last number in its name; others are boundaries between grains that they enclose. Files of DREAM.3D (.dream3d) are read by their triangle geometry; label 0 is none there.
    ///
    /// In files of VTK, the sides are those of the cell array `FaceLabels` (grains and, below 0, the exterior; where nothing is below 0, it is
    /// 0), else of `boundary_labels` or `BoundaryLabels` (where 0 is the exterior too). Programs differ in which way triangles wind: the two ways, inside and
    /// at the exterior, that close most grains are taken for the file's.
    ///
    /// ```
    /// use std::path::Path;
    ///
    /// use grainsmooth::LabelledFile;
    /// use grainsmooth::polycrystal::certify;
    ///
    /// let file = LabelledFile::read(Path::new("data/network.vtp"))?;
    /// assert_eq!(file.surface().grains().len(), 4);
    /// assert!(certify(&file.surface(), &file.expected()).is_good());
    /// # Ok::<(), grainsmooth::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::MeshFile`] when the file cannot be read, is corrupt, has no labels, or cells that are not triangles.
    pub fn read(path: &Path) -> Result<Self, Error> {
        Self::try_read(path).map_err(|problem| Error::MeshFile { path: path.to_owned(), problem })
    }

    /// Whether files of such a name are read; of DREAM.3D those that hold boundaries and no voxels.
    pub fn is_known(path: &Path) -> bool {
        if is_dream3d(path) {
            return std::fs::read(path).is_ok_and(|bytes| hdf5::is_network(&bytes));
        }
        reader(path).is_some() || stl_set::is_known(path)
    }

    fn try_read(path: &Path) -> Result<Self, MeshFileProblem> {
        let cells = if stl_set::is_known(path) {
            stl_set::read(path)?
        } else {
            let unknown = || match path.extension() {
                Some(extension) if extension.eq_ignore_ascii_case("xdmf") => {
                    MeshFileProblem::ElementsOnlyWritten
                }
                _ => MeshFileProblem::NotANetworkFormat,
            };
            let read = reader(path).ok_or_else(unknown)?;
            read(&std::fs::read(path).map_err(MeshFileProblem::Unreadable)?)?
        };
        check_lengths(&cells.mesh.points)?;
        let mut file = Self::of_cells(cells)?;
        file.sides = outward_sides(&file.surface());
        Ok(file)
    }

    fn of_cells(cells: LabelledCells) -> Result<Self, MeshFileProblem> {
        let LabelledCells {
            mesh,
            is_plane,
            labels,
            label_array,
            boundary_ids,
            node_types,
            grain_counts,
            originals,
            is_single,
            notes,
        } = cells;
        let settings: Option<Table> = notes.text(CONFIG).and_then(|text| text.parse().ok());
        let seed_ids = notes.ids(SEED_ID);
        let periods = notes.numbers(PERIODS);
        let unsigned = |ids: &[i32]| ids.iter().map(|id| id.cast_unsigned()).collect();
        let listed = |name| notes.text(name).into_iter().flat_map(|names: &str| names.split(','));
        // Without an exterior the volumes of all grains would sum to nothing.
        let zero_is_exterior =
            label_array != "FaceLabels" || !labels.iter().flatten().any(|label| *label < 0);
        // The label of the first grain, where this program wrote the file.
        let first = match &settings {
            Some(settings) => Some(first_label(settings)),
            // Without settings all grains are there.
            None if seed_ids.is_some() => {
                let grains =
                    labels.iter().flatten().filter(|label| **label > 0 || **label == 0 && !zero_is_exterior);
                grains.min().and_then(|label| u32::try_from(*label).ok())
            }
            None => None,
        };
        // With the names of other tools, all that a periodic grain has beyond the box has the same labels; so have a pore's surface and the sides of the box.
        let boundary_ids = boundary_ids.filter(|_| first.is_some());
        let mut boundaries: BTreeMap<([i64; 2], Option<i64>), BoundaryId> = BTreeMap::new();
        let (mut sides, mut comes_again) = (Vec::new(), Vec::new());
        let mut of_cell = Vec::with_capacity(labels.len());
        for (cell, labels) in labels.iter().enumerate() {
            let side = |label: i64| match label {
                // This program's labels below -1 tell periodic boundaries apart.
                ..0 => Some(Side::Exterior),
                0 if zero_is_exterior => Some(Side::Exterior),
                _ => u32::try_from(label).ok().map(|grain| Side::Grain(GrainId(grain))),
            };
            let side = |label| side(label).ok_or(MeshFileProblem::BadLabel { cell, label });
            let pair = [side(labels[0])?, side(labels[1])?];
            let next = u32::try_from(sides.len()).map(BoundaryId);
            let next = next.map_err(|_| MeshFileProblem::Corrupt {
                format: "VTK",
                what: "more boundaries than ids can name".to_owned(),
            })?;
            let id = boundary_ids.as_ref().map(|ids| ids[cell]);
            of_cell.push(*boundaries.entry((*labels, id)).or_insert_with(|| {
                sides.push(pair);
                comes_again.push(labels.iter().any(|label| *label < -1));
                next
            }));
        }
        let (elements, boundary_of) = if is_plane {
            let mut segments = Vec::new();
            let mut boundary_of = Vec::new();
            for (cell, boundary) in mesh.faces.iter().zip(of_cell) {
                segments.extend(cell.windows(2).map(|ends| [ends[0], ends[1]]));
                boundary_of.resize(segments.len(), boundary);
            }
            (FileElements::Segments(segments), boundary_of)
        } else {
            let triangle = |(cell, corners): (usize, &Vec<u32>)| {
                <[u32; 3]>::try_from(corners.as_slice())
                    .map_err(|_| MeshFileProblem::NotTriangulated { cell, corners: corners.len() })
            };
            let triangles = mesh.faces.iter().enumerate().map(triangle).collect::<Result<_, _>>()?;
            (FileElements::Triangles(triangles), of_cell)
        };
        // In a periodic network they count periodic images of grains, which are not at the point.
        let is_periodic = labels.iter().flatten().any(|label| *label < -1)
            || settings.as_ref().is_some_and(sticks_out_of_the_box)
            || periods.is_some() && originals.is_some();
        let node_types =
            node_types.filter(|_| !is_periodic).map(|codes| codes.into_iter().map(node_type).collect());
        let mut points = mesh.points;
        let at_rest = settings.as_ref().filter(|settings| !is_remeshed(settings));
        let stretch = at_rest.map_or(DVec3::ONE, stretch);
        if stretch != DVec3::ONE {
            points.iter_mut().for_each(|point| *point /= stretch);
        }
        Ok(Self {
            points,
            elements,
            boundary_of,
            sides,
            comes_again,
            node_types,
            // Without their copies points of a periodic network lack grains.
            grain_counts: grain_counts.filter(|_| !is_periodic || originals.is_some()),
            originals: originals.filter(|_| is_periodic),
            label_array,
            volumes: settings
                .as_ref()
                .and_then(|settings| numbered(notes.numbers(VOLUMES)?.to_vec(), first_label(settings))),
            orientations: first.and_then(|first| {
                let (angles, []) = notes.numbers(EULER_ANGLES)?.as_chunks() else { return None };
                let orientations = angles.iter().map(|angles| Orientation::from_euler_degrees(*angles));
                numbered(orientations.collect(), first)
            }),
            phases: first.and_then(|first| numbered(unsigned(notes.ids(PHASE)?), first)),
            phase_names: listed(PHASE_NAMES).map(str::to_owned).collect(),
            symmetries: listed(CRYSTAL_SYMMETRIES).map(|name| name.parse().unwrap_or_default()).collect(),
            seed_ids: first.and_then(|first| numbered(unsigned(seed_ids?), first)),
            periods: periods.and_then(|periods| Some(DVec3::from_array(periods.try_into().ok()?))),
            stretch,
            is_single,
            settings,
        })
    }

    /// The surface, for the library to look at.
    pub fn surface(&self) -> Surface<'_> {
        let elements = match &self.elements {
            FileElements::Triangles(triangles) => Elements::Triangles(triangles),
            FileElements::Segments(segments) => Elements::Segments(segments),
        };
        Surface { points: &self.points, elements, boundary_of: &self.boundary_of, sides: &self.sides }
    }

    /// The label of each grain, from that of number 0: in files of this program also those of grains that vanished.
    pub fn labels_of_grains(&self) -> Vec<GrainId> {
        let grains = self.surface().grains();
        match (&self.settings, grains.last()) {
            (Some(settings), Some(last)) => (first_label(settings)..=last.0).map(GrainId).collect(),
            _ => grains,
        }
    }

    /// What the file says about its network.
    pub fn expected(&self) -> Expected<'_> {
        Expected {
            node_types: self.node_types.as_deref(),
            grain_counts: self.grain_counts.as_deref(),
            originals: self.originals.as_deref(),
            grain_volumes: self.volumes.as_deref(),
            domain_volume: self.settings.as_ref().and_then(domain_volume),
            rounding: if self.is_single { self.single_rounding() } else { self.surface().last_place() },
        }
    }

    /// Half a last place of the largest coordinate in single precision.
    fn single_rounding(&self) -> f64 {
        let largest = self.points.iter().map(|point| point.abs().max_element()).fold(0.0, f64::max);
        0.5 * f64::from(f32::EPSILON) * largest
    }
}

type Reader = fn(&[u8]) -> Result<LabelledCells, MeshFileProblem>;

/// What reads files of a name.
fn reader(path: &Path) -> Option<Reader> {
    match path.extension()?.to_ascii_lowercase().to_str()? {
        "vtk" => Some(read_legacy),
        "vtp" | "vtu" => Some(read_xml),
        "tess" => Some(tess_network::read),
        "fe" | "dmp" => Some(evolver::read),
        "json" => Some(polygons::read_json),
        "csv" => Some(polygons::read_csv),
        _ if is_dream3d(path) => Some(read_dream3d),
        _ => None,
    }
}

fn is_dream3d(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("dream3d"))
}

fn read_dream3d(bytes: &[u8]) -> Result<LabelledCells, MeshFileProblem> {
    let found = hdf5::read_triangles(bytes).map_err(|problem| match problem {
        MapProblem::Damaged { format, what } => MeshFileProblem::Corrupt { format, what },
        other => MeshFileProblem::Corrupt { format: "HDF5", what: other.to_string() },
    })?;
    found.ok_or(MeshFileProblem::NoFaceLabels)
}

fn node_type(code: i64) -> Option<NodeType> {
    // Surface nets count up to eight grains.
    let code = match code {
        5..=8 => 4,
        15..=18 => 14,
        code => i8::try_from(code).ok()?,
    };
    NodeType::of_code(code)
}

/// Whether grains of these settings are whole although the box repeats.
fn sticks_out_of_the_box(settings: &Table) -> bool {
    let has = |key: &str, value: &str| settings.get(key).and_then(Value::as_str) == Some(value);
    !has("periodic", "none") && !has("periodic-cut", "box")
}

/// What is known of all grains with their labels.
fn numbered<T>(of_grains: Vec<T>, first: u32) -> Option<Vec<(GrainId, T)>> {
    (of_grains.len() < u32::MAX as usize).then(|| (first..).map(GrainId).zip(of_grains).collect())
}

/// The label of the first grain: 0 by our own names, 1 by those of other tools.
fn first_label(settings: &Table) -> u32 {
    let names = settings.get("names").and_then(Value::as_str).map(|names| Names::from_str(names, false));
    u32::from(names.is_some_and(|names| names != Ok(Names::default())))
}

/// Whether the settings ask for elements of a size. Their triangles were made of stretched boundaries, and are as good as they can be there.
fn is_remeshed(settings: &Table) -> bool {
    ["element-size", "elements-per-grain"].iter().any(|key| settings.contains_key(*key))
}

/// By what the settings multiplied coordinates in the end.
fn stretch(settings: &Table) -> DVec3 {
    let factors = settings.get("aspect-ratio").and_then(Value::as_array);
    let factors: Option<Vec<f64>> = factors.and_then(|all| all.iter().map(Value::as_float).collect());
    let (aspect_ratio, dimension) = match factors.as_deref() {
        Some(&[x, y]) => (DVec3::new(x, y, 1.0), Dimension::Two),
        Some(&[x, y, z]) => (DVec3::new(x, y, z), Dimension::Three),
        _ => return DVec3::ONE,
    };
    let stretch = Config { aspect_ratio, dimension, ..Config::default() }.stretch();
    if stretch.is_finite() && stretch.min_element() > 0.0 { stretch } else { DVec3::ONE }
}

/// The volume (in the plane: area) of the box, where grains fill that.
fn domain_volume(settings: &Table) -> Option<f64> {
    // A sphere or another convex body in the box is smaller.
    if settings.contains_key("domain") || settings.contains_key("half-spaces") {
        return None;
    }
    settings.get("box")?.as_array()?.iter().map(Value::as_float).product()
}
