//! How large a network becomes, known before it is computed.

use std::path::Path;

use sysinfo::{MemoryRefreshKind, System};

/// Bytes that a run in space holds at its peak. Fitted to peak resident memory, in millions of bytes and brackets what comes of it: 200 grains took 42 (43),
/// 50 (51) and 109 (102) at levels 1, 3 and 4, 300 grains 475 (465) at level 5, 500 grains 106 (100) and 250 (234) at levels 3 and 4, 1000 grains 151 (141), 225 (238),
/// 196 (183) and 439 (454) at levels 1 to 4, 2000 grains 93 (93), 255 (268), 470 (466) and 354 (353) at levels 0 to 3, 20 000 grains 754 (781), 2437 (2592) and
/// 2970 (3350) at levels 0, 1 and 3, 100 000 grains 3650 (3873) at level 0.
///
/// The program itself ...
const PROGRAM: u128 = 20_000_000;

/// ... in relaxation, for each edge of the control mesh: the cells, and the matrices and patches of what moves, level 1 where there is one ...
const RELAXED_PER_CONTROL_EDGE: u128 = 420;
const RELAXED_PER_CONTROL_EDGE_MOVED: u128 = 850;
const RELAXED_PER_CONTROL_EDGE_REFINED: u128 = 1420;

/// ... and for each triangle of level 1, where that carries energy, or of level 2.
const RELAXED_PER_TRIANGLE_MOVED: u128 = 190;
const RELAXED_PER_TRIANGLE_REFINED: u128 = 94;
const ENERGY_LEVEL: u32 = 2;

/// To equilibrium, where level 2 moves too and level 3 carries its energy, for each edge of the control mesh at levels 1, 2 and further ones. 500 grains took 84 (88),
/// 259 (251), 357 (352) and 370 (352) at levels 1 to 4, 200 grains 102 (109) at level 2, 1000 grains 671 (696) at level 3, 2000 grains 312 (304) at level 1.
const AT_REST_PER_CONTROL_EDGE: [u128; 3] = [1620, 5500, 7900];

/// Where nothing moves, through level 2: for each edge of the control mesh, and each triangle of the last level if that is another. 5000 grains took 125 (109),
/// 244 (242) and 690 (642) at levels 0 to 2, 20 000 grains 916 (926) at level 1, 100 000 grains 1870 (1855) at level 0.
const STILL_PER_CONTROL_EDGE: u128 = 200;
const STILL_PER_TRIANGLE: u128 = 100;

/// From level 3 on, the certificate takes the most: for each edge of the control mesh the levels that are held, with those of relaxation where points move (still, 5000
/// grains took 618 (617) at level 3) ...
const CERTIFIED_PER_CONTROL_EDGE: u128 = 850;
const CERTIFIED_PER_CONTROL_EDGE_STILL: u128 = 290;

/// ... and for each triangle of the last level its points.
const CERTIFIED_PER_TRIANGLE: u128 = 22;

/// Bytes that a run in the plane holds at its peak for each point and segment of its last level, and each segment of the first. Up to 5 % above peak resident
/// memory: 20 000 grains took 1862 MB at level 6, and in equilibrium at level 3 1196 MB, 2000 grains 128 MB.
const PLANE_PER_POINT: u128 = 220;
const PLANE_PER_SEGMENT: u128 = 50;
const PLANE_PER_CONTROL_SEGMENT: u128 = 600;
const PLANE_PER_CONTROL_SEGMENT_REFINED: u128 = 1600;

/// Segments of a boundary in the plane that bends to an arc in equilibrium, on average: 200 to 2000 random grains had 59 to 66.
const SEGMENTS_OF_ARC: u128 = 60;

/// Bytes that cells without a network take for each seed: a million random ones took 1.46 GB.
const BYTES_PER_CELL: u128 = 1600;

/// The same for cells that are listed without their complex: ten million random ones took 2.19 GB, a million 0.31.
const BYTES_PER_LISTED_CELL: u128 = 270;

/// Voxels that are labelled at the same time: few enough for little memory (32 MB), and many enough for all threads.
pub(crate) const SLAB_VOXELS: usize = 1 << 22;

/// Bytes that a slab takes while it is labelled and written: its labels, its crossings and what is written of them.
pub(crate) const LABEL_BYTES: u128 = 32 * SLAB_VOXELS as u128;

/// Taken to be available where the system does not tell: 8 GiB.
const AVAILABLE_WHERE_UNKNOWN: u64 = 8 << 30;

/// The size of a network after some levels of subdivision.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LevelSize {
    /// Number of points.
    pub points: u128,
    /// Number of edges.
    pub edges: u128,
    /// Number of triangles; 0 in 2D.
    pub triangles: u128,
}

impl LevelSize {
    /// The size after `levels` subdivisions. Each keeps the points and adds one on
    /// every edge, halves the edges, adds three inside every triangle, and makes four of each triangle.
    /// Numbers beyond `u128::MAX` stay there.
    pub fn after(self, levels: u32) -> Self {
        let mut size = self;
        // After 128 doublings any number is either 0 or at its end.
        for _ in 0..levels.min(128) {
            size = Self {
                points: size.points.saturating_add(size.edges),
                edges: size.edges.saturating_mul(2).saturating_add(size.triangles.saturating_mul(3)),
                triangles: size.triangles.saturating_mul(4),
            };
        }
        size
    }

    /// Whether 32-bit ids can name every point, both directions of every edge, and every corner of a
    /// triangle.
    fn fits_ids(&self) -> bool {
        let most = self.points.max(self.edges.saturating_mul(2)).max(self.triangles.saturating_mul(3));
        most <= u128::from(u32::MAX)
    }
}

/// What does not fit. Each message is one line that names the numbers and the remedy.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MemoryError {
    /// So many cells need more memory than there is.
    #[error(
        "{count} cells would take {} of memory and {} are available; use fewer seeds",
        in_words(*needed), in_words(u128::from(*available))
    )]
    CellsExceedMemory {
        /// Number of seeds asked for.
        count: usize,
        /// Bytes that they would take.
        needed: u128,
        /// Bytes that there are.
        available: u64,
    },
    /// So many parts of grains need more memory than there is.
    #[error(
        "{count} parts of grains would take {} of memory and {} are available; make the parts wider",
        in_words(*needed), in_words(u128::from(*available))
    )]
    PartsExceedMemory {
        /// Number of parts asked for.
        count: usize,
        /// Bytes that they would take.
        needed: u128,
        /// Bytes that there are.
        available: u64,
    },
    /// So many voxels, all held at once, need more memory than there is.
    #[error(
        "with so many voxels, the run would take {} of memory and {} are available; give fewer with --voxels",
        in_words(*needed), in_words(u128::from(*available))
    )]
    VoxelsExceedMemory {
        /// Bytes that they would take, and the network as far as it is known.
        needed: u128,
        /// Bytes that there are.
        available: u64,
    },
    /// So many levels of subdivision need more memory than there is.
    #[error(
        "{levels} levels would take {} of memory and {} are available; {}",
        in_words(*needed), in_words(u128::from(*available)), remedy(*largest)
    )]
    LevelsExceedMemory {
        /// Number of levels asked for.
        levels: u32,
        /// Bytes that they would take.
        needed: u128,
        /// Bytes that there are.
        available: u64,
        /// The most levels that would fit, if any.
        largest: Option<u32>,
    },
    /// So many levels of subdivision make more points, edges or triangles than 32-bit ids can name.
    #[error(
        "{levels} levels would make {} triangles on {} points, more than ids can name; {}",
        size.triangles, size.points, remedy(*largest)
    )]
    LevelsExceedIds {
        /// Number of levels asked for.
        levels: u32,
        /// What they would make.
        size: LevelSize,
        /// The most levels that would fit, if any.
        largest: Option<u32>,
    },
}

/// What the last level comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ControlMesh {
    /// Its points, edges and triangles.
    pub size: LevelSize,
    /// Boundaries in the plane, of two segments each, that are to bend to arcs: they are divided as often as makes the last level look
    /// smooth.
    pub arcs: u128,
    /// Bytes that are taken besides the network, for voxels.
    pub besides: u128,
    /// How far its points move.
    pub motion: Motion,
}

/// How far the points of a network move.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Motion {
    /// Not at all.
    Still,
    /// For a time.
    Timed,
    /// Until they are at rest.
    ToRest,
}

impl From<LevelSize> for ControlMesh {
    fn from(size: LevelSize) -> Self {
        Self { size, arcs: 0, besides: 0, motion: Motion::Timed }
    }
}

impl ControlMesh {
    /// The size after `levels` subdivisions.
    pub fn after(self, levels: u32) -> LevelSize {
        let whole = 1_u128.checked_shl(levels).unwrap_or(u128::MAX);
        let more = self.arcs.saturating_mul(SEGMENTS_OF_ARC.div_ceil(whole).max(2) - 2);
        let [points, edges] = [self.size.points, self.size.edges].map(|count| count.saturating_add(more));
        LevelSize { points, edges, ..self.size }.after(levels)
    }

    /// Bytes that a run takes at its peak through `levels` subdivisions to the file, as an estimate.
    pub fn bytes_after(self, levels: u32) -> u128 {
        let sum = |parts: &[(u128, u128)]| {
            parts
                .iter()
                .fold(self.besides, |sum, (count, bytes)| sum.saturating_add(count.saturating_mul(*bytes)))
        };
        let (size, edges) = (self.after(levels), self.size.edges);
        if self.size.triangles == 0 {
            let of_control =
                if levels == 0 { PLANE_PER_CONTROL_SEGMENT } else { PLANE_PER_CONTROL_SEGMENT_REFINED };
            return sum(&[
                (size.points, PLANE_PER_POINT),
                (size.edges, PLANE_PER_SEGMENT),
                (edges, of_control),
            ]);
        }
        let peak = |of_edge, of_triangle| sum(&[(edges, of_edge), (size.triangles, of_triangle)]);
        let [rest_1, rest_2, rest] = AT_REST_PER_CONTROL_EDGE;
        let certified = |of_edge| peak(of_edge, CERTIFIED_PER_TRIANGLE);
        let bytes = match (self.motion, levels) {
            (Motion::Still, 0) => peak(STILL_PER_CONTROL_EDGE, 0),
            (Motion::Still, 1..=ENERGY_LEVEL) => peak(STILL_PER_CONTROL_EDGE, STILL_PER_TRIANGLE),
            (Motion::Still, _) => certified(CERTIFIED_PER_CONTROL_EDGE_STILL),
            (Motion::Timed | Motion::ToRest, 0) => peak(RELAXED_PER_CONTROL_EDGE, 0),
            (Motion::Timed, 1) => peak(RELAXED_PER_CONTROL_EDGE_MOVED, RELAXED_PER_TRIANGLE_MOVED),
            (Motion::Timed, ENERGY_LEVEL) => {
                peak(RELAXED_PER_CONTROL_EDGE_REFINED, RELAXED_PER_TRIANGLE_REFINED)
            }
            (Motion::Timed, _) => certified(CERTIFIED_PER_CONTROL_EDGE),
            (Motion::ToRest, 1) => peak(rest_1, 0),
            (Motion::ToRest, ENERGY_LEVEL) => peak(rest_2, 0),
            (Motion::ToRest, _) => peak(rest, 0).max(certified(CERTIFIED_PER_CONTROL_EDGE)),
        };
        bytes.saturating_add(PROGRAM)
    }
}

/// Checks that the network of a control mesh after `levels` subdivisions can be held in `available` bytes and
/// named with 32-bit ids.
///
/// # Errors
/// [`MemoryError::VoxelsExceedMemory`] where the network would fit without its voxels, otherwise [`MemoryError::LevelsExceedMemory`] or
/// [`MemoryError::LevelsExceedIds`], with the most levels that would fit.
pub fn check_levels(
    control_mesh: impl Into<ControlMesh>,
    levels: u32,
    available: u64,
) -> Result<(), MemoryError> {
    let control_mesh = control_mesh.into();
    let needed = |levels| control_mesh.bytes_after(levels);
    let fits = |levels| control_mesh.after(levels).fits_ids() && needed(levels) <= u128::from(available);
    if fits(levels) {
        return Ok(());
    }
    let without_voxels = ControlMesh { besides: 0, ..control_mesh }.bytes_after(levels);
    if control_mesh.after(levels).fits_ids() && without_voxels <= u128::from(available) {
        return Err(MemoryError::VoxelsExceedMemory { needed: needed(levels), available });
    }
    // Sizes grow with the level, and from 128 on they stand still.
    let largest = (0..levels.min(128)).rev().find(|&level| fits(level));
    if needed(levels) > u128::from(available) {
        Err(MemoryError::LevelsExceedMemory { levels, needed: needed(levels), available, largest })
    } else {
        Err(MemoryError::LevelsExceedIds { levels, size: control_mesh.after(levels), largest })
    }
}

/// Checks that voxels of so many bytes can be held in `available` ones.
///
/// # Errors
/// [`MemoryError::VoxelsExceedMemory`].
pub fn check_voxels(needed: u128, available: u64) -> Result<(), MemoryError> {
    if needed <= u128::from(available) {
        return Ok(());
    }
    Err(MemoryError::VoxelsExceedMemory { needed, available })
}

/// Checks that so many cells can be held in `available` bytes.
///
/// # Errors
/// [`MemoryError::CellsExceedMemory`].
pub fn check_cells(count: usize, available: u64) -> Result<(), MemoryError> {
    check_cells_of(BYTES_PER_CELL, count, available)
}

/// The same for cells that are listed without their complex.
///
/// # Errors
/// [`MemoryError::CellsExceedMemory`].
pub fn check_listed_cells(count: usize, available: u64) -> Result<(), MemoryError> {
    check_cells_of(BYTES_PER_LISTED_CELL, count, available)
}

fn check_cells_of(bytes: u128, count: usize, available: u64) -> Result<(), MemoryError> {
    let needed = (count as u128).saturating_mul(bytes);
    if needed <= u128::from(available) {
        return Ok(());
    }
    Err(MemoryError::CellsExceedMemory { count, needed, available })
}

/// Bytes of memory that the system can give without swapping, and a container this process; 8 GiB where neither is known.
pub fn available_memory() -> u64 {
    let mut system = System::new();
    system.refresh_memory_specifics(MemoryRefreshKind::nothing().with_ram());
    let of_system = system.available_memory();
    if of_system == 0 {
        // As without /proc, where asking for the container's limits panics.
        return AVAILABLE_WHERE_UNKNOWN;
    }
    // What files keep in the cache is given back when it is needed, so it does not count as taken.
    let of_container = system.cgroup_limits().map(|limits| limits.total_memory.saturating_sub(limits.rss));
    of_container.map_or(of_system, |bytes| bytes.min(of_system))
}

/// Bytes that new files can take in a directory; nothing where the system does not tell.
pub(crate) fn free_space(directory: &Path) -> Option<u64> {
    #[cfg(unix)]
    return rustix::fs::statvfs(directory).ok().map(|disk| disk.f_bavail.saturating_mul(disk.f_frsize));
    #[cfg(not(unix))]
    return None;
}

/// A number of bytes in words, such as `3.2 GB`.
pub(crate) fn in_words(bytes: u128) -> String {
    let units = ["kB", "MB", "GB", "TB", "PB", "EB"];
    let mut amount = bytes as f64 / 1e3;
    for unit in units {
        // What would be printed as 1000.0 takes the next unit.
        if amount < 999.95 {
            return format!("{amount:.1} {unit}");
        }
        amount /= 1e3;
    }
    "over 1000 EB".to_owned()
}

/// What would fit instead of too many levels.
fn remedy(largest: Option<u32>) -> String {
    match largest {
        Some(1) => "1 level would fit".to_owned(),
        Some(levels) => format!("{levels} levels would fit"),
        None => "not even 0 levels would fit; use fewer seeds".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use subzero::MeshCounts;

    use super::*;

    const TETRAHEDRON: ControlMesh = ControlMesh {
        size: LevelSize { points: 4, edges: 6, triangles: 4 },
        arcs: 0,
        besides: 0,
        motion: Motion::Timed,
    };

    #[test]
    fn sizes_are_those_of_the_refined_mesh() {
        let mut counts = MeshCounts { vertices: 7, edges: 20, triangles: 13 };
        for level in 0..6 {
            let size = LevelSize {
                points: counts.vertices.into(),
                edges: counts.edges.into(),
                triangles: counts.triangles.into(),
            };
            assert_eq!(LevelSize { points: 7, edges: 20, triangles: 13 }.after(level), size);
            counts = counts.refined().unwrap();
        }
        let line = LevelSize { points: 4, edges: 3, triangles: 0 };
        assert_eq!(line.after(3), LevelSize { points: 25, edges: 24, triangles: 0 });
    }

    #[test]
    fn arcs_have_as_many_segments_on_any_level() {
        let lines = LevelSize { points: 500, edges: 600, triangles: 0 };
        let arcs = ControlMesh { size: lines, arcs: 300, besides: 0, motion: Motion::Timed };
        assert_eq!(arcs.after(0), LevelSize { points: 500 + 300 * 58, edges: 300 * 60, triangles: 0 });
        assert_eq!(arcs.after(3).edges, 300 * 64);
        for level in [5, 20, u32::MAX] {
            assert_eq!(arcs.after(level), lines.after(level));
        }
        assert_eq!(arcs.bytes_after(8), ControlMesh::from(lines).bytes_after(8));
    }

    #[test]
    fn any_level_has_a_size() {
        for level in [63, 64, 200, u32::MAX] {
            assert!(TETRAHEDRON.bytes_after(level) >= TETRAHEDRON.bytes_after(62));
            assert!(matches!(
                check_levels(TETRAHEDRON, level, u64::MAX),
                Err(MemoryError::LevelsExceedMemory { .. })
            ));
        }
        let nothing = LevelSize { points: 0, edges: 0, triangles: 0 };
        assert!(check_levels(nothing, u32::MAX, 0).is_ok());
    }

    #[test]
    fn largest_level_is_the_last_that_fits_exactly() {
        let needed = |level| u64::try_from(TETRAHEDRON.bytes_after(level)).unwrap();
        assert!(check_levels(TETRAHEDRON, 5, needed(5)).is_ok());
        for (available, expected) in [(needed(5) - 1, Some(4)), (needed(0), Some(0)), (needed(0) - 1, None)] {
            match check_levels(TETRAHEDRON, 5, available) {
                Err(MemoryError::LevelsExceedMemory {
                    levels: 5,
                    needed: bytes,
                    available: given,
                    largest,
                }) => {
                    assert_eq!((bytes, given, largest), (needed(5).into(), available, expected));
                }
                other => panic!("{other:?}"),
            }
        }
    }

    #[test]
    fn voxels_are_the_cause_where_the_network_fits_without_them() {
        let needed = u64::try_from(TETRAHEDRON.bytes_after(5)).unwrap();
        let with_voxels = ControlMesh { besides: 1000, ..TETRAHEDRON };
        assert!(check_levels(with_voxels, 5, needed + 1000).is_ok());
        let available = needed + 999;
        assert_eq!(
            check_levels(with_voxels, 5, available),
            Err(MemoryError::VoxelsExceedMemory { needed: u128::from(needed) + 1000, available })
        );
        // Fewer voxels would not be enough.
        assert!(matches!(
            check_levels(with_voxels, 5, needed - 1),
            Err(MemoryError::LevelsExceedMemory { .. })
        ));
        assert!(check_voxels(1000, 1000).is_ok());
        assert_eq!(
            check_voxels(1001, 1000),
            Err(MemoryError::VoxelsExceedMemory { needed: 1001, available: 1000 })
        );
    }

    #[test]
    fn ids_are_the_limit_where_memory_is_not() {
        // 3 * 4 * 4^14 corners are below 2^32, and 4^15 times as many are not.
        assert!(check_levels(TETRAHEDRON, 14, u64::MAX).is_ok());
        assert!(matches!(
            check_levels(TETRAHEDRON, 15, u64::MAX),
            Err(MemoryError::LevelsExceedIds { levels: 15, largest: Some(14), .. })
        ));
        let mut counts = MeshCounts { vertices: 4, edges: 6, triangles: 4 };
        let refinable = (0..20).take_while(|_| counts.refined().map(|finer| counts = finer).is_ok()).count();
        assert_eq!(refinable, 14, "the mesh agrees on what ids can name");
    }

    #[test]
    fn messages_say_bytes_and_remedy() {
        let mesh = LevelSize { points: 5000, edges: 20_000, triangles: 14_000 };
        let message = |levels, available| check_levels(mesh, levels, available).unwrap_err().to_string();
        assert_eq!(
            message(9, 8_000_000_000),
            "9 levels would take 80.8 GB of memory and 8.0 GB are available; 7 levels would fit"
        );
        assert_eq!(
            message(200, 8_000_000_000),
            "200 levels would take over 1000 EB of memory and 8.0 GB are available; 7 levels would fit"
        );
        assert_eq!(
            message(3, 1_000_000),
            "3 levels would take 56.7 MB of memory and 1.0 MB are available; not even 0 levels would fit; use fewer seeds"
        );
        assert_eq!(
            message(9, u64::MAX),
            "9 levels would make 3670016000 triangles on 1834495000 points, more than ids can name; 8 levels would fit"
        );
        assert_eq!(in_words(999_949), "999.9 kB");
        assert_eq!(in_words(999_950), "1.0 MB");
        assert_eq!(in_words(0), "0.0 kB");
    }

    #[test]
    fn available_memory_is_read_from_the_system() {
        let megabytes = available_memory() / 1_000_000;
        assert!((10..100_000_000).contains(&megabytes), "{megabytes} MB");
    }
}
