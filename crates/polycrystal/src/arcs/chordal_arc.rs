//! A circular arc as a polyline of equal chords.
//!
//! Among polylines of a given number of segments between two points, with a given area beside them, the shortest is of this
//! kind: a boundary in equilibrium has two degrees of freedom per end, and its turning.

use glam::DVec2;

/// Turning below which an arc is as good as a parabola, in radians: what is left out is of second order.
const STRAIGHT: f64 = 1e-5;

/// Half of a turning below which differences of nearly equal numbers are expanded in powers, in radians.
const SMALL: f64 = 0.1;

/// A function and its first two derivatives.
pub(crate) type Jet = [f64; 3];

/// Length and area of an arc of chords whose ends are one unit apart, by its turning: the angle at the centre.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ChordalArc {
    pub(crate) length: Jet,
    /// To the right of the line from start to end, for a positive turning: the arc turns left.
    pub(crate) area: Jet,
}

impl ChordalArc {
    /// Of a turning between -2 pi and 2 pi.
    pub(crate) fn new(turning: f64, chords: u32) -> Self {
        let q = 1.0 / f64::from(chords);
        let (u, x) = (turning, 0.5 * turning);
        if u.abs() < STRAIGHT {
            let lack = 1.0 - q * q;
            let area = [u * lack / 12.0, lack / 12.0, 0.0];
            return Self { length: [1.0 + u * u * lack / 24.0, u * lack / 12.0, lack / 12.0], area };
        }
        let [sine, cotangent] = [x.sin(), 1.0 / x.tan()];
        // length = sin(q x) / (q sin x), whose logarithm has the derivative
        let slope = 0.5 * (cotangent_lack(x) - q * cotangent_lack(q * x));
        let slope_rate = 0.25 * (cotangent_lack_rate(x) - q * q * cotangent_lack_rate(q * x));
        let length = (q * x).sin() / (q * sine);
        // area = n / (8 sin^2 x) with n = sin(q u) / q - sin u.
        let n = sine_lack(u, q);
        let n1 = 2.0 * (x * (1.0 + q)).sin() * (x * (1.0 - q)).sin();
        let n2 = u.sin() - q * (q * u).sin();
        let rate = n1 - n * cotangent;
        let rate_rate = n2 - n1 * cotangent + n / (2.0 * sine * sine);
        let unit = 1.0 / (8.0 * sine * sine);
        Self {
            length: [length, length * slope, length * (slope * slope + slope_rate)],
            area: [n * unit, rate * unit, (rate_rate - rate * cotangent) * unit],
        }
    }
}

/// The point after so many chords of an arc between two ends.
pub(crate) fn point_on_arc([start, end]: [DVec2; 2], turning: f64, done: u32, chords: u32) -> DVec2 {
    let part = f64::from(done) / f64::from(chords);
    let x = 0.5 * turning;
    let share = if x.abs() < STRAIGHT { part } else { (part * x).sin() / x.sin() };
    start + share * DVec2::from_angle((part - 1.0) * x).rotate(end - start)
}

/// `sin(q u) / q - sin u`, which is of third order in u.
fn sine_lack(u: f64, q: f64) -> f64 {
    let (square, q2) = (u * u, q * q);
    let (mut term, mut power, mut sum, mut k) = (u, 1.0, 0.0, 1.0);
    while term.abs() > f64::EPSILON * f64::EPSILON * u.abs() {
        term *= -square / (2.0 * k * (2.0 * k + 1.0));
        power *= q2;
        sum -= term * (1.0 - power);
        k += 1.0;
    }
    sum
}

/// `1 / x - cot x`.
fn cotangent_lack(x: f64) -> f64 {
    if x.abs() > SMALL {
        return 1.0 / x - 1.0 / x.tan();
    }
    let s = x * x;
    x * (1.0 / 3.0 + s * (1.0 / 45.0 + s * (2.0 / 945.0 + s * (1.0 / 4725.0 + s * 2.0 / 93555.0))))
}

/// The derivative of that.
fn cotangent_lack_rate(x: f64) -> f64 {
    if x.abs() > SMALL {
        return 1.0 / x.sin().powi(2) - 1.0 / (x * x);
    }
    let s = x * x;
    1.0 / 3.0 + s * (1.0 / 15.0 + s * (2.0 / 189.0 + s * (1.0 / 675.0 + s * 2.0 / 10395.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arcs_have_the_length_and_area_of_their_points() {
        let ends = [DVec2::ZERO, DVec2::X];
        for turning in [-3.0, -0.4, -1e-3, -2e-6, 0.0, 3e-6, 0.02, 0.199, 0.201, 1.5, 4.0] {
            for chords in [2, 3, 16, 500] {
                let points: Vec<DVec2> =
                    (0..=chords).map(|k| point_on_arc(ends, turning, k, chords)).collect();
                let length: f64 = points.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
                let area: f64 = points.windows(2).map(|pair| 0.5 * pair[0].perp_dot(pair[1])).sum();
                let chordal_arc = ChordalArc::new(turning, chords);
                assert!((chordal_arc.length[0] - length).abs() < 1e-13, "{turning} {chords}");
                assert!((chordal_arc.area[0] - area).abs() < 1e-13, "{turning} {chords}");
            }
        }
    }

    #[test]
    fn derivatives_are_those_of_the_values() {
        let h = 1e-4;
        for turning in [-3.0, -0.4, -1e-3, 0.0, 0.02, 0.2, 1.5, 4.0] {
            for chords in [2, 16] {
                let [before, at, after] = [-h, 0.0, h].map(|by| ChordalArc::new(turning + by, chords));
                let jets = |chordal_arc: &ChordalArc| [chordal_arc.length, chordal_arc.area];
                for ((before, at), after) in jets(&before).into_iter().zip(jets(&at)).zip(jets(&after)) {
                    for order in [0, 1] {
                        let slope = (after[order] - before[order]) / (2.0 * h);
                        assert!(
                            (slope - at[order + 1]).abs() < 1e-6,
                            "{turning} {chords}: {slope}, not {}",
                            at[order + 1]
                        );
                    }
                }
            }
        }
    }
}
