//! Boundaries with triangles of a size that is asked for.

use std::time::Instant;

use polycrystal::{ElementSize, Remeshed};
use voronoi::Dimension;

use super::elements_reached::{ElementsReached, LineMerged, TrianglesNarrow};
use super::polycrystal::Polycrystal;
use super::stage::{Progress, Stage};
use crate::volume_mesh::filled_plane::FilledPlane;
use crate::{ElementOptions, Error, SmallFeatures};

/// Length of edges of the smooth network, in units of the size of elements, beyond which it is too coarse: with 0.8 there were four times as many
/// bad tetrahedra as with 0.4.
const LONGEST: f64 = 0.5;

impl Polycrystal {
    /// What the config asks for after subdivision: grains cut at a periodic box, stretched, with elements of a size.
    ///
    /// # Errors
    /// As of [`Self::cut_if_asked`] and [`Self::remeshed_if_asked`].
    pub fn completed(self, progress: Progress<'_>) -> Result<Self, Error> {
        let polycrystal = self.cut_if_asked()?.stretched_if_asked();
        let elements = polycrystal.synthesis().map(|synthesis| synthesis.config.elements);
        if elements.is_some_and(|options| options != ElementOptions::default()) {
            progress(Stage::Remeshing, 0, 1);
        }
        polycrystal.remeshed_if_asked()
    }

    /// Remeshes boundaries where the config's [`ElementOptions`] ask for it; others stay as they are.
    ///
    /// # Errors
    /// [`Error::CoarseReference`] where the finest level has too long edges for elements of that size; [`Error::WorksWithShortLines`] where it is short lines that cannot become points;
    /// as of [`Network::remeshed`](polycrystal::Network::remeshed).
    pub fn remeshed_if_asked(self) -> Result<Self, Error> {
        match self.synthesis().map(|synthesis| synthesis.config.elements) {
            Some(options) => self.remeshed(&options),
            None => Ok(self),
        }
    }

    /// Remeshes boundaries where `options` ask for it; others stay as they are. Triangles of a network that was not made from cells are the smooth surface: they are divided where they
    /// are too large to put points on.
    ///
    /// # Errors
    /// As of [`Self::remeshed_if_asked`].
    pub fn remeshed(mut self, options: &ElementOptions) -> Result<Self, Error> {
        let diameter = self.diameter_statistics().mean;
        let per_grain = options.elements_per_grain.map(|count| diameter / count);
        let Some(length) = options.element_size.or(per_grain) else { return Ok(self) };
        let start = Instant::now();
        let mean = self.network.mean_edge_length(&self.points);
        // Lines in the plane are straight between their points, or as fine as they curve.
        if self.dimension() == Dimension::Three && mean > LONGEST * length {
            let more = more_levels(mean / (LONGEST * length));
            if self.synthesis().is_some() {
                return Err(Error::CoarseReference { mean, length, levels: self.level() + more });
            }
            let divided = self.network.divided(more as usize)?;
            self.points = divided.divide(&self.points);
            self.network = divided;
        }
        let growth = options.size_growth.unwrap_or(ElementSize::GROWTH);
        let has_middles = self.file().volume.order == Some(2);
        let merges_short_lines = options.small_features == SmallFeatures::Merge;
        let of_radius = options.adapt_curvature;
        let size = ElementSize { length, growth, of_radius, has_middles, merges_short_lines };
        let cut = self.axes_cut_at_box();
        match self.network.remeshed(&self.points, &size, cut) {
            Ok(Remeshed { network, points, certificate, refinements, merged, curved, triangles }) => {
                let mean_edge = network.mean_edge_length(&points);
                self.plane_mesh = match (triangles, &curved) {
                    (Some(mesh), Some(curved)) => Some(FilledPlane::curved(mesh, &network, curved.clone())),
                    (Some(mesh), None) => Some(FilledPlane { mesh, curved: None }),
                    (None, _) => None,
                };
                let names = self.file().names;
                let merged_lines = merged.iter().map(|line| LineMerged::new(line, names)).collect();
                let narrow = network.narrow_triangles(&points).map(TrianglesNarrow::from);
                self.elements =
                    Some(ElementsReached { size: length, mean_edge, refinements, narrow, merged_lines });
                // Angles stay those of the smooth boundaries, as they were before they were stretched.
                self.validation.triangles = certificate.triangles;
                self.validation.largest_volume_error = certificate.largest_volume_error;
                (self.network, self.points, self.curved) = (network, points, curved);
            }
            Err(error) => {
                let kept = ElementSize { merges_short_lines: false, ..size };
                let works = merges_short_lines && self.network.remeshed(&self.points, &kept, cut).is_ok();
                return Err(if works { Error::WorksWithShortLines(error) } else { self.failure(error) });
            }
        }
        self.add_time(Stage::Remeshing, start.elapsed());
        Ok(self)
    }
}

/// How many more levels have edges so many times as short.
fn more_levels(times: f64) -> u32 {
    (1..).find(|more| 0.5f64.powi(*more) * times <= 1.0).map_or(0, i32::unsigned_abs)
}
