//! An order to eliminate the unknowns of a network in the plane in.
//!
//! Halves of the plane know each other through the cells and edges between them only. What lies there is eliminated after
//! both halves, and so on within each (nested dissection, George 1973): factors of a matrix over n cells then have some n log n
//! entries.

use glam::DVec2;

/// Vertices of a part that is not divided: its dense factors cost no more than those of its halves.
const UNDIVIDED: usize = 12;

/// Where unknowns come in the order, two for each vertex and one for each cell.
pub(crate) struct Dissection {
    /// Of each vertex, the first of its two unknowns; none for those without edges.
    vertices: Vec<Option<usize>>,
    cells: Vec<usize>,
    pub(crate) whole: Part,
}

/// A part of the plane.
pub(crate) struct Part {
    /// Two or none.
    pub(crate) halves: Vec<Self>,
    /// The first unknown of all within.
    pub(crate) start: usize,
    /// The first unknown of what lies between the halves, or of all that is not divided ...
    pub(crate) own: usize,
    /// ... and the one after the last.
    pub(crate) end: usize,
}

/// What knows what.
struct Graph {
    positions: Vec<DVec2>,
    /// Of each vertex and then each cell, the vertices ...
    vertices: Vec<Vec<u32>>,
    /// ... and the cells that share an edge with it.
    cells: Vec<Vec<u32>>,
    /// Of each vertex and then each cell, where it lies as a part is divided.
    sides: Vec<Side>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    Elsewhere,
    Half(bool),
    Between,
}

impl Dissection {
    /// For vertices at these positions and so many cells; edges have two ends and one or two cells beside them.
    pub(crate) fn new(
        positions: Vec<DVec2>,
        cell_count: usize,
        edges: impl Iterator<Item = ([usize; 2], [Option<usize>; 2])>,
    ) -> Self {
        let count = positions.len();
        let mut graph = Graph {
            vertices: vec![Vec::new(); count + cell_count],
            cells: vec![Vec::new(); count + cell_count],
            sides: vec![Side::Elsewhere; count + cell_count],
            positions,
        };
        let id = |node: usize| u32::try_from(node).expect("vertices and cells have 32-bit numbers");
        for (ends, cells) in edges {
            let cells = cells.into_iter().flatten().map(|cell| count + cell);
            let around = || ends.into_iter().chain(cells.clone());
            for node in around() {
                graph.vertices[node].extend(ends.into_iter().filter(|end| *end != node).map(id));
                graph.cells[node].extend(cells.clone().filter(|cell| *cell != node).map(id));
            }
        }
        let nodes = (0..id(count + cell_count)).filter(|node| {
            let is_cell = *node as usize >= count;
            is_cell || !graph.vertices[*node as usize].is_empty() || !graph.cells[*node as usize].is_empty()
        });
        let nodes: Vec<u32> = nodes.collect();
        let mut order = Vec::with_capacity(nodes.len());
        let mut next = 0;
        let whole = graph.divide(nodes, &mut order, &mut next);
        let mut own = Self { vertices: vec![None; count], cells: vec![0; cell_count], whole };
        for (node, unknown) in order {
            match (node as usize).checked_sub(count) {
                Some(cell) => own.cells[cell] = unknown,
                None => own.vertices[node as usize] = Some(unknown),
            }
        }
        own
    }

    /// How many unknowns there are.
    pub(crate) fn len(&self) -> usize {
        self.whole.end
    }

    /// A vertex's first unknown, before its second; none where it has no edges.
    pub(crate) fn vertex(&self, vertex: usize) -> Option<usize> {
        self.vertices[vertex]
    }

    /// A cell's unknown.
    pub(crate) fn cell(&self, cell: usize) -> usize {
        self.cells[cell]
    }
}

impl Graph {
    /// Divides a part and lists its nodes with their unknowns.
    fn divide(&mut self, nodes: Vec<u32>, order: &mut Vec<(u32, usize)>, next: &mut usize) -> Part {
        let start = *next;
        let [first, second, between] = self.halves(nodes);
        let divided = [first, second].into_iter().filter(|half| !half.is_empty());
        let halves: Vec<Part> = divided.map(|half| self.divide(half, order, next)).collect();
        let own = *next;
        for node in between {
            order.push((node, *next));
            *next += if (node as usize) < self.positions.len() { 2 } else { 1 };
        }
        Part { halves, start, own, end: *next }
    }

    /// The nodes of two halves, and those between them; no halves where there are few.
    fn halves(&mut self, nodes: Vec<u32>) -> [Vec<u32>; 3] {
        let count = self.positions.len();
        let mut vertices: Vec<u32> = nodes.iter().copied().filter(|node| (*node as usize) < count).collect();
        if vertices.len() <= UNDIVIDED {
            return [Vec::new(), Vec::new(), nodes];
        }
        let position = |node: &u32| self.positions[*node as usize];
        let least = vertices.iter().map(position).reduce(DVec2::min).expect("there are vertices");
        let most = vertices.iter().map(position).reduce(DVec2::max).expect("there are vertices");
        let axis = usize::from((most - least).y > (most - least).x);
        let middle = vertices.len() / 2;
        vertices.select_nth_unstable_by(middle, |a, b| {
            position(a)[axis].total_cmp(&position(b)[axis]).then(a.cmp(b))
        });
        for (number, vertex) in vertices.iter().enumerate() {
            self.sides[*vertex as usize] = Side::Half(number >= middle);
        }
        // Cells first, which have one unknown each: what then still lies across are edges between vertices.
        let cells = || nodes.iter().copied().filter(|node| *node as usize >= count);
        for cell in cells() {
            let own = &self.vertices[cell as usize];
            let mut sides = own.iter().map(|vertex| self.sides[*vertex as usize]);
            let mut known = sides.clone().filter(|side| matches!(side, Side::Half(_)));
            let first = known.next().unwrap_or(Side::Half(false));
            let is_across = sides.any(|side| matches!(side, Side::Half(_)) && side != first);
            self.sides[cell as usize] = if is_across { Side::Between } else { first };
        }
        let mut part = |own: u32, others: fn(&Self) -> &[Vec<u32>]| {
            let Side::Half(half) = self.sides[own as usize] else { return };
            let mut others = others(self)[own as usize].iter();
            if others.any(|other| self.sides[*other as usize] == Side::Half(!half)) {
                self.sides[own as usize] = Side::Between;
            }
        };
        cells().for_each(|cell| part(cell, |graph| &graph.cells));
        vertices.sort_unstable();
        vertices.iter().for_each(|vertex| part(*vertex, |graph| &graph.vertices));
        let sides = &self.sides;
        let parts = [Side::Half(false), Side::Half(true), Side::Between].map(|side| {
            nodes.iter().copied().filter(|node| sides[*node as usize] == side).collect::<Vec<u32>>()
        });
        nodes.iter().for_each(|node| self.sides[*node as usize] = Side::Elsewhere);
        parts
    }
}
