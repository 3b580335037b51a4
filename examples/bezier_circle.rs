//! A cubic Bezier curve that looks like a quarter of a circle, and how far it is from being one: 2.7e-4 of the radius.
//!
//!     cargo run --release --example bezier_circle
#![allow(clippy::print_stdout, reason = "an example shows its result")]

use glam::DVec2;
use subzero::{BezierCurve, BezierError};

fn main() -> Result<(), BezierError> {
    // The inner control points are placed so that the middle lies on the circle.
    let k = 4.0 / 3.0 * (2.0_f64.sqrt() - 1.0);
    let control = [(1.0, 0.0), (1.0, k), (k, 1.0), (0.0, 1.0)].map(DVec2::from);
    let quarter = BezierCurve::new(control.to_vec())?;
    println!("degree {}, middle at a distance of {:.12}", quarter.degree(), quarter.point(0.5).length());

    let farthest = quarter.sample(1000).iter().map(|point| point.length()).fold(0.0, f64::max);
    println!("farthest from the circle: {:.2e}", farthest - 1.0);

    // De Casteljau's scheme splits the curve too; the halves meet with the same direction.
    let [first, second] = quarter.split(0.5);
    let turn = first.derivative(1.0).perp_dot(second.derivative(0.0));
    println!("turn where the halves meet: {turn:.1e}");
    Ok(())
}
