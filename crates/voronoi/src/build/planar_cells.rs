//! Cells in the plane, without weights and periods: the dual of a Delaunay triangulation.
//!
//! The seeds are triangulated square by square, each square with the seeds around it, in parallel. A triangle whose circumcircle lies where
//! all seeds are known is one of the whole triangulation. Cells that touch a wall are cut from the rectangle with their neighbours
//! in the triangulation. What needs more than that goes another way: cells with more than three neighbours at a vertex, and seeds spread so
//! unevenly that a square would have to look far around.

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use spade::handles::DirectedEdgeHandle;
use spade::{DelaunayTriangulation, HasPosition, Point2, Triangulation};

use crate::build::planar_merge::{PlanarKey, SquareCells, merge_squares};
use crate::build::planar_squares::{Known, SEEDS_PER_SQUARE, Square, Squares};
use crate::clip::clipping::Clipping;
use crate::clip::convex_polygon::{ConvexPolygon, circumcentre};
use crate::exact::generator::Generator;
use crate::exact::image::ImageTable;
use crate::exact::input::ExactInput;
use crate::{Domain, Tessellation};

/// Distance of two corners, relative to the size of the cell, below which they may be one point: far above the 1e-12 to which
/// coordinates are known.
const POSSIBLY_COINCIDENT: f64 = 1e-9;

/// Seeds that may be looked at for each seed of a square, and for each that it would have if they were spread evenly.
const MOST_KNOWN: usize = 8;

/// A seed as the triangulation knows it.
#[derive(Clone, Copy)]
struct Site {
    position: Point2<f64>,
    /// Place among the seeds that the square knows.
    place: u32,
}

impl HasPosition for Site {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        self.position
    }
}

type Delaunay = DelaunayTriangulation<Site>;
type Edge<'a> = DirectedEdgeHandle<'a, Site, (), (), ()>;

/// Why a square's cells could not be found.
enum Failure {
    /// Seeds further away matter.
    Unknown,
    /// This is not the way to find them.
    Special,
}

/// The tessellation of the domain, if it has no special places.
pub(crate) fn tessellate(domain: &Domain, seeds: &[DVec3]) -> Option<Tessellation> {
    let squares = Squares::new(domain, seeds);
    let images = ImageTable::default();
    let input = ExactInput { frame: &domain.frame, seeds: &squares.seeds, weights: None, images: &images };
    let cells: Option<Vec<SquareCells>> =
        squares.all().par_iter().map(|square| square_cells(input, &squares, square)).collect();
    Some(merge_squares(domain, seeds, &squares.ids, &cells?))
}

fn square_cells(input: ExactInput, squares: &Squares, square: &Square) -> Option<SquareCells> {
    for rings in [1, 2, 4, 8] {
        let known = squares.around(square, rings);
        if known.seeds.len() > MOST_KNOWN * (known.own + SEEDS_PER_SQUARE) {
            return None;
        }
        match Finder::new(input, known).and_then(Finder::find) {
            Ok(cells) => return Some(cells),
            Err(Failure::Unknown) => {}
            Err(Failure::Special) => return None,
        }
    }
    None
}

/// Finds the cells of a square.
struct Finder<'a> {
    input: ExactInput<'a>,
    known: Known,
    delaunay: Delaunay,
    /// Per triangle, the number of its vertex.
    numbers: Vec<Number>,
    /// Per edge of the triangulation, the number of the edge across it; [`NONE`] if it has none yet.
    edge_numbers: Vec<u32>,
    cells: SquareCells,
}

/// No number.
const NONE: u32 = u32::MAX;

/// The vertex of a triangle.
#[derive(Clone, Copy, PartialEq)]
enum Number {
    Unasked,
    /// It lies outside the domain, or so near a wall that rounding cannot tell.
    NotInside,
    Inside(u32),
}

impl<'a> Finder<'a> {
    fn new(input: ExactInput<'a>, known: Known) -> Result<Self, Failure> {
        let site = |(place, id): (u32, &u32)| {
            let DVec2 { x, y } = input.seeds[*id as usize].truncate();
            Site { position: Point2::new(x, y), place }
        };
        let sites = (0..).zip(&known.seeds).map(site).collect();
        let delaunay = Delaunay::bulk_load(sites).map_err(|_| Failure::Special)?;
        // Seeds at one place are one in the triangulation, and seeds on a line have none.
        if delaunay.num_vertices() < known.seeds.len() || delaunay.all_vertices_on_line() {
            return Err(Failure::Special);
        }
        let numbers = vec![Number::Unasked; delaunay.num_all_faces()];
        let edge_numbers = vec![NONE; delaunay.num_undirected_edges()];
        Ok(Self { input, known, delaunay, numbers, edge_numbers, cells: SquareCells::default() })
    }

    fn find(mut self) -> Result<SquareCells, Failure> {
        let delaunay = std::mem::take(&mut self.delaunay);
        let mut first_edges = vec![None; self.known.own];
        for vertex in delaunay.vertices() {
            if let Some(edge) = first_edges.get_mut(vertex.data().place as usize) {
                *edge = vertex.out_edge();
            }
        }
        let (mut outgoing, mut corners) = (Vec::new(), Vec::new());
        for (place, first) in first_edges.into_iter().enumerate() {
            let first: Edge = first.ok_or(Failure::Special)?;
            outgoing.clear();
            outgoing.push(first);
            let turned = std::iter::successors(Some(first.ccw()), |edge| Some(edge.ccw()));
            outgoing.extend(turned.take_while(|edge| *edge != first));
            let (seed, before) = (self.known.seeds[place], self.cells.cell_edges.len());
            self.add_cell(seed, &outgoing, &mut corners)?;
            let count = self.cells.cell_edges.len() - before;
            self.cells.edge_counts.push((seed, u32::try_from(count).expect("edges fit 32 bits")));
        }
        Ok(self.cells)
    }

    /// Adds the cell of a seed, given the edges that leave it, counter-clockwise.
    fn add_cell(&mut self, seed: u32, outgoing: &[Edge], corners: &mut Vec<u32>) -> Result<(), Failure> {
        corners.clear();
        for (edge, next) in outgoing.iter().zip(outgoing.iter().cycle().skip(1)) {
            match self.vertex(seed, *edge, *next)? {
                Some(number) => corners.push(number),
                None => return self.add_cell_at_wall(seed, outgoing),
            }
        }
        let mut start = corners[corners.len() - 1];
        for (edge, end) in outgoing.iter().zip(corners) {
            self.push_edge_across(seed, *edge, [start, *end])?;
            start = *end;
        }
        Ok(())
    }

    /// Adds the cell of a seed that touches a wall, or may.
    fn add_cell_at_wall(&mut self, seed: u32, outgoing: &[Edge]) -> Result<(), Failure> {
        let mut polygon = ConvexPolygon::new(seed, self.input);
        for edge in outgoing {
            polygon.cut(Generator::site(self.id(*edge)), self.input);
        }
        let mut corners = Vec::new();
        for ([before, after], position) in polygon.corners() {
            corners.push(match (before.as_site(), after.as_site()) {
                (Some(before), Some(after)) => {
                    let mut pairs = outgoing.iter().zip(outgoing.iter().cycle().skip(1));
                    let is_there =
                        |(edge, next): &(&Edge, &Edge)| [self.id(**edge), self.id(**next)] == [before, after];
                    let (edge, next) = pairs.find(is_there).ok_or(Failure::Special)?;
                    self.vertex(seed, *edge, *next)?.ok_or(Failure::Special)?
                }
                _ => {
                    let corner = self.position(seed) + position;
                    self.check_known(corner, position.length())?;
                    self.push_vertex(corner, [Generator::site(seed), before, after], true)
                }
            });
        }
        for (k, ([_, beyond], _)) in polygon.corners().enumerate() {
            let ends = [corners[k], corners[(k + 1) % corners.len()]];
            if let Some(other) = beyond.as_site() {
                let edge = outgoing.iter().find(|edge| self.id(**edge) == other);
                self.push_edge_across(seed, *edge.ok_or(Failure::Special)?, ends)?;
            } else {
                self.push_edge(seed, beyond, ends)?;
            }
        }
        Ok(())
    }

    /// The number of the vertex of the triangle between two edges that leave a seed, if it certainly lies in the domain.
    fn vertex(&mut self, seed: u32, edge: Edge, next: Edge) -> Result<Option<u32>, Failure> {
        let Some(triangle) = edge.face().as_inner() else { return Ok(None) };
        let triangle = triangle.index();
        if self.numbers[triangle] == Number::Unasked {
            let others = [edge, next].map(|edge| self.id(edge));
            let from_seed = circumcentre(seed, others, self.input);
            let (centre, radius) = (self.position(seed) + from_seed, from_seed.length());
            let margin = uncertainty(centre, radius);
            let [lower, upper] = [self.input.frame.lower, self.input.frame.upper].map(DVec3::truncate);
            self.numbers[triangle] =
                if (centre - margin).cmpgt(lower).all() && (centre + margin).cmplt(upper).all() {
                    self.check_known(centre, radius)?;
                    let is_own = |edge: Edge| (edge.to().data().place as usize) < self.known.own;
                    let is_shared = !(is_own(edge) && is_own(next));
                    let generators = [seed, others[0], others[1]].map(Generator::site);
                    Number::Inside(self.push_vertex(centre, generators, is_shared))
                } else {
                    Number::NotInside
                };
        }
        Ok(match self.numbers[triangle] {
            Number::Inside(number) => Some(number),
            Number::Unasked | Number::NotInside => None,
        })
    }

    /// Checks that all seeds are known that may lie in a circle.
    fn check_known(&self, centre: DVec2, radius: f64) -> Result<(), Failure> {
        let [lower, upper] = self.known.bounds;
        let extent = DVec2::splat(radius * (1.0 + POSSIBLY_COINCIDENT));
        let is_known = (centre - extent).cmpge(lower).all() && (centre + extent).cmple(upper).all();
        if is_known { Ok(()) } else { Err(Failure::Unknown) }
    }

    fn push_vertex(&mut self, position: DVec2, mut generators: PlanarKey, is_shared: bool) -> u32 {
        let number = u32::try_from(self.cells.vertices.len()).expect("a square has fewer than 2^32 vertices");
        self.cells.vertices.push(position);
        if is_shared {
            generators.sort_unstable();
            self.cells.shared_vertices.push((generators, number));
        }
        number
    }

    /// Adds the edge of a cell across an edge of the triangulation.
    fn push_edge_across(&mut self, seed: u32, edge: Edge, ends: [u32; 2]) -> Result<(), Failure> {
        let across = edge.as_undirected().index();
        if self.edge_numbers[across] != NONE {
            self.cells.cell_edges.push(self.edge_numbers[across]);
            return Ok(());
        }
        let other = self.id(edge);
        let number = self.push_edge(seed, Generator::site(other), ends)?;
        self.edge_numbers[across] = number;
        if edge.to().data().place as usize >= self.known.own {
            let key = [seed.min(other), seed.max(other)].map(Generator::site);
            self.cells.shared_edges.push((key, number));
        }
        Ok(())
    }

    /// Adds an edge of a cell, unless its ends may be one point.
    fn push_edge(&mut self, seed: u32, beyond: Generator, ends: [u32; 2]) -> Result<u32, Failure> {
        let [start, end] = ends.map(|end| self.cells.vertices[end as usize]);
        if start.distance(end) <= uncertainty(start, start.distance(self.position(seed))) {
            return Err(Failure::Special);
        }
        let number = u32::try_from(self.cells.edges.len()).expect("a square has fewer than 2^32 edges");
        self.cells.edges.push(([Generator::site(seed), beyond], ends));
        self.cells.cell_edges.push(number);
        Ok(number)
    }

    fn position(&self, seed: u32) -> DVec2 {
        self.input.seeds[seed as usize].truncate()
    }

    /// The seed to which an edge leads.
    fn id(&self, edge: Edge) -> u32 {
        self.known.seeds[edge.to().data().place as usize]
    }
}

/// How far the centre of a circle may be from where it was computed, with a wide margin.
fn uncertainty(centre: DVec2, radius: f64) -> f64 {
    POSSIBLY_COINCIDENT * radius + 4.0 * f64::EPSILON * centre.abs().max_element()
}
