//! What eight voxels around a point of the lattice leave of it: one point, or one for each sheet of boundaries there.

/// The label of all that is outside: of voxels beyond the grid, and of those that belong to no grain.
pub(super) const OUTSIDE: u32 = u32::MAX;

/// The faces between voxels at a point of the lattice, a quarter of each: by axis, four for each.
pub(super) const QUARTERS: usize = 12;

/// The quarter face across an axis whose lower octant is this one. Octants have a bit for each axis, set where they lie above the point.
pub(super) fn quarter(axis: usize, octant: usize) -> usize {
    let below = octant & ((1 << axis) - 1);
    let above = octant >> (axis + 1);
    4 * axis + (below | above << axis)
}

/// The two octants beside a quarter face, the lower first.
fn octants(quarter: usize) -> [usize; 2] {
    let (axis, place) = (quarter / 4, quarter % 4);
    let below = place & ((1 << axis) - 1);
    let lower = below | (place >> axis) << (axis + 1);
    [lower, lower | 1 << axis]
}

/// The four octants around half an edge of the lattice, in order, and the quarter faces between each and the next.
fn around(axis: usize, side: usize) -> ([usize; 4], [usize; 4]) {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let base = side << axis;
    let octants = [base, base | 1 << u, base | 1 << u | 1 << v, base | 1 << v];
    (octants, [quarter(u, base), quarter(v, octants[1]), quarter(u, octants[3]), quarter(v, base)])
}

/// How the four voxels around an edge of the lattice (in the plane, the pixels around a point) meet there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Meeting {
    /// All boundaries in one line.
    Together,
    /// The first and third hang together, so that there are two sheets: around the second, and around the fourth.
    FirstJoined,
    /// The second and fourth hang together: sheets around the third, and around the first.
    SecondJoined,
}

impl Meeting {
    /// Of two grains that both touch themselves, the larger one hangs together, of equal ones that of the smaller number: so both ends of an edge agree.
    pub(super) fn of(labels: [u32; 4], volume: &impl Fn(u32) -> u64) -> Self {
        let [a, b, c, d] = labels;
        let (first, second) = (a == c && a != b && a != d, b == d && b != a && b != c);
        match (first, second) {
            (true, true) if (volume(a), b) > (volume(b), a) => Self::FirstJoined,
            (true, false) => Self::FirstJoined,
            (_, true) => Self::SecondJoined,
            (false, false) => Self::Together,
        }
    }

    /// The sheet that the face between each voxel and the next is part of.
    pub(super) fn sheets(self) -> [u8; 4] {
        match self {
            Self::Together => [0, 0, 0, 0],
            Self::FirstJoined => [0, 0, 1, 1],
            Self::SecondJoined => [0, 1, 1, 0],
        }
    }
}

/// The copies of a point of the lattice.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct SplitPoint {
    /// The copy that each quarter face belongs to, of those between different labels.
    pub(super) of_quarters: [u8; QUARTERS],
    pub(super) count: u8,
}

/// What is wrong at a point.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Touching {
    /// The octants of the two parts of a grain that touch each other, those of the smaller part first.
    pub(super) octants: Vec<usize>,
}

/// The copies of a point between octants with these labels.
pub(super) fn copies(labels: [u32; 8], volume: &impl Fn(u32) -> u64) -> SplitPoint {
    let mut parents: [usize; QUARTERS] = std::array::from_fn(|quarter| quarter);
    for_half_edges(|axis, side| {
        let (octants, quarters) = around(axis, side);
        let around = octants.map(|octant| labels[octant]);
        let sheets = Meeting::of(around, volume).sheets();
        let mut first = [None; 2];
        for place in 0..4 {
            if around[place] == around[(place + 1) % 4] {
                continue;
            }
            let first = first[usize::from(sheets[place])].get_or_insert(quarters[place]);
            join(&mut parents, *first, quarters[place]);
        }
    });
    let mut numbers = [None; QUARTERS];
    let mut count = 0;
    let of_quarters = std::array::from_fn(|quarter| {
        let [lower, upper] = octants(quarter).map(|octant| labels[octant]);
        if lower == upper {
            return 0;
        }
        *numbers[root(&parents, quarter)].get_or_insert_with(|| {
            count += 1;
            count - 1
        })
    });
    SplitPoint { of_quarters, count }
}

/// Where a grain touches itself in one copy of a point: two parts of it stand there that hang together nowhere around it.
pub(super) fn touching(
    labels: [u32; 8],
    copies: &SplitPoint,
    volume: &impl Fn(u32) -> u64,
) -> Option<Touching> {
    let mut parents: [usize; 8] = std::array::from_fn(|octant| octant);
    for quarter in 0..QUARTERS {
        let [lower, upper] = octants(quarter);
        if labels[lower] == labels[upper] {
            join(&mut parents, lower, upper);
        }
    }
    for_half_edges(|axis, side| {
        let (octants, _) = around(axis, side);
        match Meeting::of(octants.map(|octant| labels[octant]), volume) {
            Meeting::Together => {}
            Meeting::FirstJoined => join(&mut parents, octants[0], octants[2]),
            Meeting::SecondJoined => join(&mut parents, octants[1], octants[3]),
        }
    });
    // The copies that each part of a grain stands at, a bit for each.
    let mut at = [0u16; 8];
    let mut sizes = [0; 8];
    for octant in 0..8 {
        sizes[root(&parents, octant)] += 1;
    }
    for quarter in 0..QUARTERS {
        let [lower, upper] = octants(quarter);
        if labels[lower] != labels[upper] {
            for octant in [lower, upper] {
                at[root(&parents, octant)] |= 1 << copies.of_quarters[quarter];
            }
        }
    }
    let is_part = |octant: &usize| root(&parents, *octant) == *octant && labels[*octant] != OUTSIDE;
    for one in (0..8).filter(is_part) {
        for other in (one + 1..8).filter(is_part) {
            if labels[one] == labels[other] && at[one] & at[other] != 0 {
                let parts = if sizes[other] <= sizes[one] { [other, one] } else { [one, other] };
                let of_part = |part: usize| (0..8).filter(move |octant| root(&parents, *octant) == part);
                return Some(Touching { octants: parts.into_iter().flat_map(of_part).collect() });
            }
        }
    }
    None
}

/// The sheets of an edge of the lattice that goes up from a point along an axis, each as the copy of the point that it stands at; nothing where there is one sheet.
pub(super) fn two_sheets(
    labels: [u32; 8],
    copies: &SplitPoint,
    axis: usize,
    side: usize,
    volume: &impl Fn(u32) -> u64,
) -> Option<[u8; 2]> {
    let (octants, quarters) = around(axis, side);
    match Meeting::of(octants.map(|octant| labels[octant]), volume) {
        Meeting::Together => None,
        Meeting::FirstJoined => Some([copies.of_quarters[quarters[0]], copies.of_quarters[quarters[2]]]),
        Meeting::SecondJoined => Some([copies.of_quarters[quarters[1]], copies.of_quarters[quarters[3]]]),
    }
}

/// The octants around an edge that goes up from a point along an axis.
pub(super) fn octants_around(axis: usize) -> [usize; 4] {
    around(axis, 1).0
}

fn for_half_edges(mut each: impl FnMut(usize, usize)) {
    for axis in 0..3 {
        each(axis, 0);
        each(axis, 1);
    }
}

fn root<const COUNT: usize>(parents: &[usize; COUNT], mut member: usize) -> usize {
    while parents[member] != member {
        member = parents[member];
    }
    member
}

fn join<const COUNT: usize>(parents: &mut [usize; COUNT], a: usize, b: usize) {
    let (a, b) = (root(parents, a), root(parents, b));
    parents[a.max(b)] = a.min(b);
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALIKE: fn(u32) -> u64 = |_| 1;

    #[test]
    fn quarters_have_the_octants_that_name_them() {
        for number in 0..QUARTERS {
            let [lower, upper] = octants(number);
            assert_eq!((quarter(number / 4, lower), upper - lower), (number, 1 << (number / 4)));
        }
    }

    #[test]
    fn a_plane_an_edge_and_a_corner_leave_one_point() {
        for labels in [
            [0, 0, 0, 0, 1, 1, 1, 1],
            [0, 1, 0, 1, 0, 2, 0, 2],
            [0, 1, 2, 3, 4, 5, 6, 7],
            [0, 1, 1, 1, 1, 1, 1, 1],
        ] {
            let copies = copies(labels, &ALIKE);
            assert_eq!((copies.count, touching(labels, &copies, &ALIKE)), (1, None), "{labels:?}");
        }
    }

    /// Two voxels that meet in an edge alone, of a grain in another one: the larger one hangs together.
    #[test]
    fn where_two_parts_meet_in_an_edge_the_point_is_there_twice_or_once() {
        // Octants 1 and 2 below, all else another grain: the edge goes down from the point.
        let labels = [0, 1, 1, 0, 0, 0, 0, 0];
        let apart = copies(labels, &|label| u64::from(label == 0));
        assert_eq!(apart.count, 2);
        assert_eq!(touching(labels, &apart, &|label| u64::from(label == 0)), None);
        let joined = copies(labels, &|label| u64::from(label == 1));
        assert_eq!(joined.count, 1);
        assert_eq!(touching(labels, &joined, &|label| u64::from(label == 1)), None);
    }

    /// Two voxels that meet in a point alone have surfaces apart.
    #[test]
    fn where_two_parts_meet_in_a_point_it_is_there_twice() {
        let labels = [1, 0, 0, 0, 0, 0, 0, 1];
        let copies = copies(labels, &ALIKE);
        assert_eq!((copies.count, touching(labels, &copies, &ALIKE)), (2, None));
    }

    /// With a third grain between them, which meets both in faces, they touch in one point.
    #[test]
    fn where_another_boundary_leads_from_one_part_to_the_other_the_grain_touches_itself() {
        let labels = [1, 2, 0, 0, 0, 2, 0, 1];
        let copies = copies(labels, &ALIKE);
        assert!(touching(labels, &copies, &ALIKE).is_some());
    }
}
