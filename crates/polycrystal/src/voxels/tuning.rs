//! The tuned numbers of networks from voxels.

/// What smoothing of voxels is tuned by. Lengths are in units of the edge of a voxel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VoxelTuning {
    /// How far a point may move from the middle of its eight voxels, along each axis: below 0.5 no voxel changes its grain.
    pub within: f64,
    /// How much bending counts against the distance from the staircase. On two maps of 64^3 voxels with 50 grains, at equilibrium and flat, 300 and 600 everywhere left the same distance from
    /// the true boundaries (0.055 and 0.051 voxel), and normals away from lines off by 1.79 and 1.47, and by 1.68 and 1.35 degrees; 1000 took twice the steps for 0.05 degrees less.
    pub bending: f32,
    /// How much bending counts beside lines, as a share of that elsewhere. On the first of these maps, shares of 1, 0.5 and 0.2 of a bending of 600 left boundaries off by 0.053, 0.052 and
    /// 0.051 voxel, normals away from lines by 1.69, 1.64 and 1.62 degrees, and the means of angles along lines by 7.7, 7.7 and 7.9.
    pub bending_beside_lines: f32,
    /// How much the distance from the staircase counts beside lines: the means that points follow there end at lines. With three quarters of a bending of 750, on 100^3 voxels with 204 grains
    /// at equilibrium, 1 and 7.5 left boundaries off by 0.053 and 0.052 voxel, normals by 3.18 and 3.19 degrees, and the means of angles along lines by 7.7 and 7.4.
    pub pull_beside_lines: f32,
    /// How much the bending of lines counts, in units of that of boundaries. On the first of these maps, 1, 2 and 4 with a bending of 600 left normals off by 3.14, 3.04 and 3.05 degrees, lines
    /// by 0.267, 0.262 and 0.259 voxel, and the means of angles along lines by 7.9, 7.7 and 7.7 degrees; on the second one, these means by 7.7, 8.1 and 8.4.
    pub bending_of_lines: f32,
    /// Steps of the search for least bending. On the first map, 40, 50 and 64 left normals away from lines off by 1.80, 1.74 and 1.69 degrees; 120 with constant momentum instead 1.68. With the weights beside lines, 64 and 72 left them off by 1.705 and 1.698.
    pub bending_steps: usize,
    /// The least curvature that the search reckons with, in units of the true one. With 10, as many steps come nearer to the least sum than with 1, 4 or 24: what is less curved is smooth
    /// from the start.
    pub least_curvature: f32,
    /// How far points that share a place start from it, as a share of the way to the middle of their faces.
    pub apart: f64,
    /// Rounds in which points of elements that cross go back to where they started.
    pub crossing_rounds: usize,
    /// Rounds after which one more ring of points goes back too.
    pub rounds_of_ring: usize,
    /// Rounds of smoothing around folds, with no ring of points around them, with one, and so on.
    pub rounds_of_smoothing: usize,
    /// The most rings.
    pub rings: usize,
    /// Rounds of motions that give grains their volumes.
    pub volume_rounds: usize,
    /// The longest motion of a point in such a round. Grains of one voxel are nearly nothing after bending, and to first order would grow far beyond their volumes.
    pub longest_motion: f64,
    /// The longest edge that collapses, in units of the edge of a cube as large as the smallest grain there.
    pub longest_of_grain: f64,
    /// How far a point that is left may move from its place along each axis, so that grains have their volumes again: chords of curved boundaries take some. With `within`,
    /// edges of three voxels left balls of twelve voxels without theirs.
    pub within_when_decimated: f64,
    /// Edge of the cubes in which edges collapse side by side, in units of the shortest edge asked for: many for all threads, each small enough to stay in the cache, and most of each away from its
    /// sides. With edges of 2, cubes of 20, 40, 60 and 100 voxels took 6.0, 4.8, 5.0 and 6.9 s for 200 voxels an edge.
    pub tile: f64,
    /// Rounds of decimation, each of which leaves the points around faults of the one before; then nothing is decimated.
    pub decimations: usize,
    /// How far around a fault points stay, in units of the shortest edge asked for.
    pub held_around: f64,
}

impl Default for VoxelTuning {
    fn default() -> Self {
        Self {
            within: 0.49,
            bending: 750.0,
            bending_beside_lines: 0.75,
            pull_beside_lines: 7.5,
            bending_of_lines: 1.6,
            bending_steps: 72,
            least_curvature: 10.0,
            apart: 0.3,
            crossing_rounds: 12,
            rounds_of_ring: 3,
            rounds_of_smoothing: 8,
            rings: 4,
            volume_rounds: 60,
            longest_motion: 0.25,
            longest_of_grain: 0.25,
            within_when_decimated: 1.0,
            tile: 25.0,
            decimations: 8,
            held_around: 2.0,
        }
    }
}
