//! The tuned numbers of remeshing.

/// What remeshing is tuned by.
///
/// Each number but those of the volumes was chosen on 200 random grains, `--rng-seed` 1 to 5, by the angles of the triangles and the quality of the tetrahedra that Gmsh made
/// between them; `benches/finite_elements.py` measures such networks again.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RemeshTuning {
    /// Mean length of the edges of the reference, in units of the size asked for, up to which it is fine enough. With 0.8, four times as many tetrahedra
    /// were bad; 0.2 gave triangles as good as 0.4 does, in three times the time.
    pub longest_of_reference: f64,
    /// The smallest size as a share of the one asked for, where lines come near each other without meeting. Smaller triangles in narrow
    /// corners made tetrahedra worse.
    pub smallest_share: f64,
    /// Length of an edge, in units of the size there, beyond which it is halved.
    pub longest: f64,
    /// The same below which it collapses.
    pub shortest: f64,
    /// Length of a line, in units of the size asked for, below which it may become a point. With 0.8, as of edges, ends of lines in cut boxes moved farther than what is near them is wide.
    pub short_line: f64,
    /// Length of the shortest line that may stay one, in units of the size asked for. Elements grow from such lines by 0.4 from ring to ring, here in 41 of them, and the volume of
    /// those beside it is 1e-18 of that of others. From lines of 1e-11 in nearly a lattice, 49 grains took minutes.
    pub shortest_line: f64,
    /// Rounds of halving, collapsing, flipping and moving within boundaries.
    pub rounds: usize,
    /// Cosine of the angle between a triangle and the smooth surface there, and between a triangle before and after a change (60 degrees).
    pub least_cosine: f64,
    /// Cosine of an angle that is wide enough (35 degrees): a point whose triangles have none below need not move.
    pub wide: f64,
    /// Rounds of searching places where the least angle is larger.
    pub searches: usize,
    /// Angle in radians (25 degrees) between lines of one boundary at a node, below which their points stand opposite each other. Without that, 8 tetrahedra of 20 cut boxes at
    /// equilibrium had a gamma below 0.1 (least 0.091), otherwise none.
    pub narrow_corner: f64,
    /// How far from each other points of two such lines are, in units of their spacing, beyond which they need not stand opposite each other. With 0.6, a sixth more triangles are narrow.
    pub apart: f64,
    /// By how much of their spacing the first points of such lines that are apart are at other distances: triangles between points that are not opposite each other are wider. Without that,
    /// a fifth more triangles are narrow.
    pub stagger: f64,
    /// Radius around a fault in which elements become half as large, and short lines stay, in units of the size there. Of 99 cut boxes of 20 grains with short lines as points, in
    /// elements of two thirds of a diameter, 2 had no valid mesh with 3, and 6 with 1.5; in elements of a third, none and 1.
    pub halving_radius: f64,
    /// How often elements become smaller where something is wrong, before remeshing gives up.
    pub refinements: usize,
}

impl Default for RemeshTuning {
    fn default() -> Self {
        Self {
            longest_of_reference: 0.4,
            smallest_share: 0.1,
            longest: 4.0 / 3.0,
            shortest: 4.0 / 5.0,
            short_line: 0.5,
            shortest_line: 1e-6,
            rounds: 10,
            least_cosine: 0.5,
            wide: 0.819_152,
            searches: 12,
            narrow_corner: 0.436,
            apart: 0.3,
            stagger: 0.3,
            halving_radius: 3.0,
            refinements: 6,
        }
    }
}
