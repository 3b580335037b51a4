//! Orientations in memory, as another program measured or simulated them.

use glam::DVec3;
use texture::CrystalSymmetry;

use super::ebsd::grains::grains;
use super::label_map::MeasuredMap;
use super::options::MapOptions;
use crate::error::map_file::MapProblem;
use crate::maps::orientation_map::{HeadGrid, MapPhase, MapPoint, PointList};

/// Orientations on a square grid in the plane, x fastest, y upward.
#[derive(Debug, Clone, PartialEq)]
pub struct OrientationMap {
    /// Number of points along x and y.
    pub shape: [u32; 2],
    /// The phases by name, and the symmetry of their crystals.
    pub phases: Vec<(String, CrystalSymmetry)>,
    /// Index of each point's phase; nothing where the pattern has no solution.
    pub phase_of: Vec<Option<u32>>,
    /// Bunge's Euler angles of each point in degrees, with an axis of trigonal and hexagonal crystals along x.
    pub angles: Vec<[f64; 3]>,
}

impl MeasuredMap {
    /// The grains of orientations in memory, found, cropped and cleaned as options say. Voxels are 1 wide where the options tell no spacing.
    ///
    /// # Errors
    /// [`MapProblem`] where orientations and options do not go together; a point is called the line of its number, from 1.
    ///
    /// # Panics
    /// When there is not one phase and one orientation for each point.
    pub fn of_orientations(map: &OrientationMap, options: &MapOptions) -> Result<Self, MapProblem> {
        let [columns, rows] = map.shape;
        let count = columns as usize * rows as usize;
        assert_eq!([map.phase_of.len(), map.angles.len()], [count; 2], "one of each for each point");
        let spacing = options.spacing().unwrap_or(DVec3::ONE);
        // As in files, rows count from the top.
        let place = |column: u32, row: u32| {
            [(f64::from(column) + 0.5) * spacing.x, (f64::from(rows - row) - 0.5) * spacing.y]
        };
        let places = (0..rows).flat_map(|row| (0..columns).map(move |column| place(column, row)));
        let points =
            places.zip(&map.phase_of).zip(&map.angles).zip(1..).map(|(((place, phase), angles), line)| {
                MapPoint {
                    line,
                    place,
                    phase: phase.map(i64::from),
                    angles: *angles,
                    quality: 0.0,
                    confidence: None,
                }
            });
        let phase = |(number, (name, symmetry)): (i64, &(String, CrystalSymmetry))| MapPhase {
            number,
            name: name.clone(),
            symmetry: Some(*symmetry),
        };
        let phases = (0..).zip(&map.phases).map(phase).collect();
        let list = PointList::of_plane(phases, points.collect(), HeadGrid::default());
        grains(&list, options)
    }
}
