//! Cells one after another, without the complex that they make up.
//!
//! A cell is known once its tile is cut: of each tile only the sums over the faces of its cells and the lists of their neighbours
//! are kept, a fifth of what the vertices and faces of a complex take.

use std::collections::HashMap;

use foldhash::fast::FixedState;
use glam::DVec3;

use crate::build::check;
use crate::build::tile::{Tile, map_whole_cells};
use crate::diagram::cell_sum::CellSum;
use crate::diagram::united_vertices::UnitedVertices;
use crate::exact::face_end::FaceEnd;
use crate::exact::generator::Generator;
use crate::sites::search::{Names, Search};
use crate::{
    CellId, CellMeasure, Dimension, Domain, PeriodicVertex, Side, Tessellation, Translation, VoronoiError,
};

/// A cell by itself.
#[derive(Debug, Clone, PartialEq)]
pub struct SingleCell {
    /// The number of its seed.
    pub cell: CellId,
    /// Where the seed is.
    pub seed: DVec3,
    /// Size and counts.
    pub measure: CellMeasure,
    /// As of [`Tessellation::neighbors`].
    pub neighbors: Vec<Side>,
}

impl SingleCell {
    /// A cell of a complex, whose measure is one of [`Tessellation::cell_measures`].
    ///
    /// # Panics
    /// When there is no such cell.
    pub fn of(tessellation: &Tessellation, cell: CellId, measure: CellMeasure) -> Self {
        Self {
            cell,
            seed: tessellation.seeds()[cell.index()],
            measure,
            neighbors: tessellation.neighbors(cell),
        }
    }
}

/// The cells of all seeds, one after another: see [`Tessellation::stream`].
#[derive(Debug)]
pub struct CellStream(Cells);

#[derive(Debug)]
enum Cells {
    /// In space.
    Tiles(TiledCells),
    /// In the plane.
    Whole(Tessellation, Vec<CellMeasure>),
}

impl Tessellation {
    /// The cells of seeds one after another, in the order of the seeds, where their complex is not needed or too large: in space they
    /// take about 140 bytes each, a sixth of what a tessellation takes. With weights, the cells are those of [`Self::power`].
    ///
    /// All cells are cut, in parallel, before the first one comes. In the plane their complex is made.
    ///
    /// ```
    /// use glam::DVec3;
    /// use voronoi::{Domain, Tessellation};
    ///
    /// let seeds = [DVec3::new(0.25, 0.5, 0.5), DVec3::new(0.75, 0.5, 0.5)];
    /// let cells = Tessellation::stream(&Domain::unit_cube(), &seeds, None)?;
    /// for cell in cells.iter() {
    ///     assert!((cell.measure.volume - 0.5).abs() < 1e-15);
    ///     assert_eq!(cell.neighbors.len(), 6, "the other cell and five walls");
    /// }
    /// # Ok::<(), voronoi::VoronoiError>(())
    /// ```
    ///
    /// # Errors
    /// As of [`Self::new`] and [`Self::power`].
    ///
    /// # Panics
    /// When there are weights, but not as many as seeds.
    pub fn stream(
        domain: &Domain,
        seeds: &[DVec3],
        weights: Option<&[f64]>,
    ) -> Result<CellStream, VoronoiError> {
        if domain.dimension() == Dimension::Two {
            let tessellation = match weights {
                Some(weights) => Self::power(domain, seeds, weights)?,
                None => Self::new(domain, seeds)?,
            };
            let measures = tessellation.cell_measures();
            return Ok(CellStream(Cells::Whole(tessellation, measures)));
        }
        check(domain, seeds, weights)?;
        Ok(CellStream(Cells::Tiles(TiledCells::new(Search::new(domain, seeds, weights)?)?)))
    }
}

impl CellStream {
    /// Number of cells.
    #[expect(clippy::len_without_is_empty, reason = "there is always a seed")]
    pub fn len(&self) -> usize {
        match &self.0 {
            Cells::Tiles(cells) => cells.indices.len(),
            Cells::Whole(tessellation, _) => tessellation.cell_count(),
        }
    }

    /// One of the cells.
    ///
    /// # Panics
    /// When there is no such cell.
    pub fn cell(&self, cell: CellId) -> SingleCell {
        match &self.0 {
            Cells::Tiles(cells) => cells.cell(cell),
            Cells::Whole(tessellation, measures) => {
                SingleCell::of(tessellation, cell, measures[cell.index()])
            }
        }
    }

    /// Size and counts of every cell, in the order of the seeds: quicker than with neighbours.
    pub fn measures(&self) -> impl ExactSizeIterator<Item = CellMeasure> + '_ {
        let cells = (0..u32::try_from(self.len()).expect("cell ids fit 32 bits")).map(CellId);
        cells.map(|cell| match &self.0 {
            Cells::Tiles(cells) => cells.place(cell).measure(),
            Cells::Whole(_, measures) => measures[cell.index()],
        })
    }

    /// All cells in the order of the seeds.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = SingleCell> + '_ {
        (0..u32::try_from(self.len()).expect("cell ids fit 32 bits")).map(|cell| self.cell(CellId(cell)))
    }
}

/// The cells of tiles, in space.
#[derive(Debug)]
struct TiledCells {
    /// In the order of the tiles.
    seeds: Vec<DVec3>,
    names: Names,
    /// Of each seed in the user's order, its index in that of the tiles.
    indices: Vec<u32>,
    tiles: Vec<TileCells>,
    /// Of each cell without volume that symbolically has a thickness, by the number of its seed, what its two faces touch.
    flat: HashMap<u32, [FaceEnd; 2], FixedState>,
}

/// What is kept of a cell.
struct Place<'a> {
    seed: DVec3,
    sum: CellSum,
    beyond: &'a [u32],
}

impl Place<'_> {
    fn measure(&self) -> CellMeasure {
        self.sum.measure(self.seed)
    }
}

/// What is kept of the cells of a tile.
#[derive(Debug)]
struct TileCells {
    first_seed: u32,
    sums: Vec<CellSum>,
    /// What lies beyond the faces of the tile's cell c is `beyond[starts[c]..starts[c + 1]]`, as [`Search::code`] has it, in order.
    starts: Vec<u32>,
    beyond: Vec<u32>,
}

impl TiledCells {
    fn new(mut search: Search<'_>) -> Result<Self, VoronoiError> {
        let tiles = map_whole_cells(&mut search, TileCells::new)?;
        let indices = search.indices();
        let (seeds, names) = search.into_names();
        let mut flat = HashMap::default();
        for tile in &tiles {
            for (index, starts) in (tile.first_seed..).zip(tile.starts.windows(2)) {
                if let &[a, b] = &tile.beyond[starts[0] as usize..starts[1] as usize] {
                    flat.insert(names.ids[index as usize], [a, b].map(|code| names.end_of(code)));
                }
            }
        }
        Ok(Self { seeds, names, indices, tiles, flat })
    }

    fn cell(&self, cell: CellId) -> SingleCell {
        let place = self.place(cell);
        let own = FaceEnd::cell(cell.0);
        let touched =
            |code: &u32| Side::of(self.behind_flat_cells(own, self.names.end_of(*code)), Translation::ZERO);
        let mut neighbors: Vec<Side> = place.beyond.iter().map(touched).collect();
        neighbors.sort_unstable();
        SingleCell { cell, seed: place.seed, measure: place.measure(), neighbors }
    }

    fn place(&self, cell: CellId) -> Place<'_> {
        let index = self.indices[cell.index()];
        let seed = self.seeds[index as usize];
        if self.flat.contains_key(&cell.0) {
            return Place { seed, sum: CellSum::default(), beyond: &[] };
        }
        let tile = &self.tiles[self.tiles.partition_point(|tile| tile.first_seed <= index) - 1];
        let place = (index - tile.first_seed) as usize;
        let beyond = tile.starts[place] as usize..tile.starts[place + 1] as usize;
        Place { seed, sum: tile.sums[place], beyond: &tile.beyond[beyond] }
    }

    /// What a cell touches where it meets some end of a face: behind a cell without volume, what lies on the other side of that.
    fn behind_flat_cells(&self, mut from: FaceEnd, mut to: FaceEnd) -> FaceEnd {
        while let FaceEnd::Cell(image) = to
            && let Some(ends) = self.flat.get(&image.seed)
        {
            let [a, b] = ends.map(|end| end.moved(image.translation));
            (from, to) = (to, if a == from { b } else { a });
        }
        to
    }
}

impl TileCells {
    fn new(search: &Search<'_>, tile: &mut Tile) -> Self {
        if !tile.coincident.is_empty() {
            let mut vertices = UnitedVertices::new(tile.positions.len());
            for [v, w] in tile
                .coincident
                .iter()
                .map(|pair| pair.map(|vertex| PeriodicVertex { vertex, translation: Translation::ZERO }))
            {
                vertices.unite(v, w);
            }
            let roots = vertices.roots();
            tile.drop_repeated_corners(
                |corner| roots[corner as usize].vertex,
                Dimension::Three.fewest_corners(),
            );
        }
        let first_seed = tile.seeds.start;
        let count = tile.seeds.len();
        // Of a face, the tile's cells that it is a face of, and what lies beyond.
        let of_cells = |[own, beyond]: [Generator; 2]| {
            let other = tile.seeds.contains(&beyond.0).then_some((beyond, own));
            let sides = [Some((own, beyond)), other];
            sides.into_iter().flatten().map(|(own, beyond)| ((own.0 - first_seed) as usize, beyond))
        };
        let mut starts = vec![0; count + 1];
        let mut corner_counts = vec![0; count];
        for (sides, corners) in tile.faces.iter().zip(tile.corner_starts.windows(2)) {
            for (cell, _) in of_cells(*sides) {
                starts[cell + 1] += 1;
                corner_counts[cell] += corners[1] - corners[0];
            }
        }
        let mut sums = tile.sums.clone();
        for (cell, sum) in sums.iter_mut().enumerate() {
            sum.set_counts(starts[cell + 1], corner_counts[cell]);
            starts[cell + 1] += starts[cell];
        }
        let mut beyond = vec![0; starts[count] as usize];
        let mut ends = starts.clone();
        for sides in &tile.faces {
            for (cell, generator) in of_cells(*sides) {
                beyond[ends[cell] as usize] = search.code(generator);
                ends[cell] += 1;
            }
        }
        starts.windows(2).for_each(|ends| beyond[ends[0] as usize..ends[1] as usize].sort_unstable());
        Self { first_seed, sums, starts, beyond }
    }
}
