//! What was asked for, beside what came of it.

use crate::figures::asked::AskedAndReached;
use crate::{ComponentShare, PhaseShare, Polycrystal, Synthesis};

impl Polycrystal {
    /// Every figure that was asked for: of sizes, phases, divided grains, shapes, tensions, textures and disorientations. Lengths are in the unit of
    /// the box.
    pub fn asked_and_reached(&self) -> Vec<AskedAndReached> {
        let Some(Synthesis { cells, .. }) = self.synthesis() else { return Vec::new() };
        let phases: Vec<&str> = cells.grains.phases.iter().flat_map(|phases| phases.names()).collect();
        let sizes = self.sizes_reached();
        let mut rows = sizes.map_or_else(Vec::new, |sizes| sizes.asked_and_reached(&phases));
        let mut add = |what: String, asked: f64, reached: f64| {
            rows.push(AskedAndReached { what, asked, reached });
        };
        let volumes = self.network.cell_volumes();
        if let Some(phases) = &cells.grains.phases {
            for PhaseShare { name, fraction_asked, fraction, .. } in phases.shares(&cells.volumes(), volumes)
            {
                if let Some(asked) = fraction_asked {
                    add(format!("share of the volume, {name}"), asked, fraction);
                }
            }
        }
        if let Some(shapes) = self.shapes_reached() {
            let reached = shapes.ratio.unwrap_or(shapes.ratio_of_cells);
            add("length of grains over their width, median".to_owned(), shapes.ratio_asked, reached);
        }
        if let Some(tensions) = &self.tensions {
            let without = tensions.without_equilibrium.len() as f64;
            add("lines where one tension exceeds the sum of the others".to_owned(), 0.0, without);
            if let Some(residual) = self.residual {
                add("residual of Herring's condition, rms".to_owned(), 0.0, residual.rms);
            }
        }
        for divided in cells.grains.parents.iter().flat_map(|parents| parents.patterns()) {
            let what = format!("{}, {}", divided.length_name(), divided.asked);
            add(what, divided.length_asked, divided.length);
        }
        let Some(texture) = &cells.grains.texture else { return rows };
        for number in 0..texture.texture_count() {
            let of = phases.get(number).map_or_else(String::new, |phase| format!(", {phase}"));
            for ComponentShare { name, asked, reached } in texture.shares(number, volumes) {
                add(format!("share of the volume, {name}{of}"), asked, reached);
            }
        }
        if let Some(fit) = texture.fit() {
            add("sum of differences from the histogram of disorientations".to_owned(), 0.0, fit.after);
        }
        rows
    }
}
