//! Histograms as SVG.

use std::fmt::Write;

/// Histograms of one quantity, before and after, with the curve that random cells follow.
pub(super) struct Chart {
    pub(super) title: String,
    /// What the horizontal axis counts.
    pub(super) unit: &'static str,
    /// What the shares are of.
    pub(super) of: &'static str,
    pub(super) bins: Bins,
    /// Values with their weights; none where nothing changes.
    pub(super) before: Vec<(f64, f64)>,
    pub(super) after: Vec<(f64, f64)>,
    /// What both are, where there are both.
    pub(super) names: [&'static str; 2],
    /// Places with shares a bin.
    pub(super) exact: Vec<(f64, f64)>,
    /// What these belong to.
    pub(super) exact_name: &'static str,
}

/// Bins of one width, without end.
#[derive(Clone, Copy)]
pub(super) struct Bins {
    /// Lower end of the first.
    pub(super) start: f64,
    pub(super) width: f64,
}

impl Bins {
    /// The share of each bin; smaller values than the first bin's are counted there.
    fn shares(self, values: &[(f64, f64)]) -> Vec<f64> {
        let total: f64 = values.iter().map(|(_, weight)| weight).sum();
        let mut shares = Vec::new();
        for (value, weight) in values {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates: 0 below")]
            let bin = ((value - self.start) / self.width) as usize;
            if shares.len() <= bin {
                shares.resize(bin + 1, 0.0);
            }
            shares[bin] += weight / total;
        }
        shares
    }

    fn place(self, bin: usize) -> f64 {
        self.start + self.width * bin as f64
    }
}

// The picture and the part of it within the axes, in SVG units, which are pixels at the usual width of a column.
const WIDTH: f64 = 400.0;
const HEIGHT: f64 = 250.0;
const LEFT: f64 = 42.0;
const RIGHT: f64 = 390.0;
const TOP: f64 = 30.0;
const BOTTOM: f64 = 205.0;

/// Most ticks of an axis: more than that, and their numbers touch.
const MOST_TICKS: f64 = 8.0;

impl Chart {
    /// The chart with its caption.
    pub(super) fn figure(&self) -> String {
        let (before, after) = (self.bins.shares(&self.before), self.bins.shares(&self.after));
        let key = |color: &str, name: &str| {
            format!(
                "<span class=\"entry\"><span class=\"key\" style=\"background: var(--{color})\"></span>{name}</span> "
            )
        };
        let mut keys = if before.is_empty() {
            key("after", "this run")
        } else {
            key("before", self.names[0]) + &key("after", self.names[1])
        };
        if !self.exact.is_empty() {
            keys += &key("exact", self.exact_name);
        }
        let svg = self.svg(&before, &after);
        format!("<figure>{svg}<figcaption>Share of {} in %. {keys}</figcaption></figure>", self.of)
    }

    fn svg(&self, before: &[f64], after: &[f64]) -> String {
        let drawn = || {
            [before, after]
                .into_iter()
                .flat_map(|shares| shares.iter().enumerate())
                .filter(|(_, share)| **share > 0.0)
        };
        let curve = || self.exact.iter().filter(|(_, share)| *share > 1e-4);
        let ends = drawn()
            .flat_map(|(bin, _)| [self.bins.place(bin), self.bins.place(bin + 1)])
            .chain(curve().map(|(x, _)| *x));
        let (low, high) =
            ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        let top =
            drawn().map(|(_, share)| *share).chain(curve().map(|(_, share)| *share)).fold(0.0, f64::max);
        let x = |value: f64| LEFT + (RIGHT - LEFT) * (value - low) / (high - low);
        let y = |share: f64| BOTTOM - (BOTTOM - TOP) * share / top;

        let mut svg =
            format!("<svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{}\">", self.title);
        let mut add = |element: std::fmt::Arguments<'_>| {
            svg.write_fmt(element).expect("strings take all that is written")
        };
        add(format_args!("<text class=\"title\" x=\"{LEFT}\" y=\"16\">{}</text>", self.title));
        for tick in ticks(0.0, 100.0 * top) {
            let at = y(tick / 100.0);
            add(format_args!(
                "<line class=\"axis\" x1=\"{LEFT}\" x2=\"{RIGHT}\" y1=\"{at:.1}\" y2=\"{at:.1}\"/>"
            ));
            add(format_args!(
                "<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{tick}</text>",
                LEFT - 5.0,
                at + 4.0
            ));
        }
        for tick in ticks(low, high) {
            add(format_args!(
                "<text x=\"{:.1}\" y=\"{}\" text-anchor=\"middle\">{tick}</text>",
                x(tick),
                BOTTOM + 16.0
            ));
        }
        let center = LEFT.midpoint(RIGHT);
        add(format_args!(
            "<text x=\"{center}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
            BOTTOM + 34.0,
            self.unit
        ));
        for (bin, share) in after.iter().enumerate().filter(|(_, share)| **share > 0.0) {
            let (start, end, at) = (x(self.bins.place(bin)), x(self.bins.place(bin + 1)), y(*share));
            let (width, height) = (end - start - 1.0, BOTTOM - at);
            add(format_args!(
                "<rect class=\"after\" x=\"{start:.1}\" y=\"{at:.1}\" width=\"{width:.1}\" height=\"{height:.1}\"/>"
            ));
        }
        if !before.is_empty() {
            let steps =
                before.iter().enumerate().skip_while(|(_, share)| **share == 0.0).map(|(bin, share)| {
                    format!(
                        "H{:.1}V{:.1}H{:.1}",
                        x(self.bins.place(bin)),
                        y(*share),
                        x(self.bins.place(bin + 1))
                    )
                });
            let steps: String = steps.collect();
            let (start, end) = (x(low), BOTTOM);
            add(format_args!("<path class=\"before\" d=\"M{start:.1} {end}{steps}V{end}\"/>"));
        }
        let points: Vec<String> =
            curve().map(|(value, share)| format!("{:.1} {:.1}", x(*value), y(*share))).collect();
        add(format_args!("<polyline class=\"exact\" points=\"{}\"/>", points.join(" ")));
        svg + "</svg>"
    }
}

/// Round numbers in a range, not too many: multiples of 1, 2 or 5 times a power of ten.
fn ticks(low: f64, high: f64) -> impl Iterator<Item = f64> {
    let power = 10_f64.powf(((high - low) / MOST_TICKS).log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0]
        .map(|factor| factor * power)
        .into_iter()
        .find(|step| (high - low) / step <= MOST_TICKS);
    let step = step.unwrap_or(10.0 * power);
    let first = (low / step).ceil();
    // Rounded to the digits that a tick has, for 3 * 0.1 is not 0.3.
    let rounded = move |tick: f64| (tick * step * 1e6).round() / 1e6;
    (0..).map(move |number| rounded(first + f64::from(number))).take_while(move |tick| *tick <= high)
}
