//! Bezier curves and tensor-product surfaces by de Casteljau's algorithm.

use glam::DVec3;

use crate::ids::id;
use crate::mesh_checks::fits;
use crate::{BezierError, Point};

/// A Bezier curve of any degree.
#[derive(Clone, Debug, PartialEq)]
pub struct BezierCurve<P> {
    control: Vec<P>,
}

/// `(1 - t) a + t b`.
fn mix<P: Point>(a: P, b: P, t: f64) -> P {
    P::zero().add_scaled(a, 1.0 - t).add_scaled(b, t)
}

/// The next level of de Casteljau's scheme, in place: one point less.
fn descend<P: Point>(points: &mut Vec<P>, t: f64) {
    for i in 1..points.len() {
        points[i - 1] = mix(points[i - 1], points[i], t);
    }
    points.pop();
}

impl<P: Point> BezierCurve<P> {
    /// The curve with these control points, one more than its degree.
    ///
    /// # Errors
    /// [`BezierError::NoControlPoints`] if there are none.
    pub fn new(control: Vec<P>) -> Result<Self, BezierError> {
        if control.is_empty() { Err(BezierError::NoControlPoints) } else { Ok(Self { control }) }
    }

    /// The control points.
    pub fn control(&self) -> &[P] {
        &self.control
    }

    /// The degree, 0 for a single point.
    pub fn degree(&self) -> usize {
        self.control.len() - 1
    }

    /// The point at `t`, which runs from 0 to 1 along the curve (and may leave this range).
    ///
    /// ```
    /// use glam::DVec3;
    /// use subzero::BezierCurve;
    ///
    /// let curve = BezierCurve::new(vec![DVec3::ZERO, DVec3::Y, DVec3::new(1., 1., 0.), DVec3::X])?;
    /// assert_eq!(curve.point(0.5), DVec3::new(0.5, 0.75, 0.));
    /// # Ok::<(), subzero::BezierError>(())
    /// ```
    pub fn point(&self, t: f64) -> P {
        let mut points = self.control.clone();
        while points.len() > 1 {
            descend(&mut points, t);
        }
        points[0]
    }

    /// The derivative at `t`.
    pub fn derivative(&self, t: f64) -> P {
        let mut points = self.control.clone();
        while points.len() > 2 {
            descend(&mut points, t);
        }
        match points[..] {
            #[allow(clippy::cast_precision_loss)] // No degree is that high.
            [a, b] => P::zero().add_scaled(b, self.degree() as f64).add_scaled(a, -(self.degree() as f64)),
            _ => P::zero(),
        }
    }

    /// All levels of de Casteljau's scheme at `t`: first the control points, last the point on the curve.
    pub fn casteljau(&self, t: f64) -> Vec<Vec<P>> {
        let mut levels = vec![self.control.clone()];
        while let Some(last) = levels.last().filter(|level| level.len() > 1) {
            let mut next = last.clone();
            descend(&mut next, t);
            levels.push(next);
        }
        levels
    }

    /// The two curves of the same degree before and after `t`.
    ///
    /// ```
    /// use glam::DVec2;
    /// use subzero::BezierCurve;
    ///
    /// let parabola = BezierCurve::new(vec![DVec2::ZERO, DVec2::new(1., 2.), DVec2::new(2., 0.)])?;
    /// let [left, right] = parabola.split(0.5);
    /// assert_eq!(left.control(), [DVec2::ZERO, DVec2::new(0.5, 1.), DVec2::new(1., 1.)]);
    /// assert_eq!(right.control()[0], DVec2::new(1., 1.));
    /// # Ok::<(), subzero::BezierError>(())
    /// ```
    pub fn split(&self, t: f64) -> [Self; 2] {
        let levels = self.casteljau(t);
        let left = levels.iter().map(|level| level[0]).collect();
        let right = levels.iter().rev().map(|level| level[level.len() - 1]).collect();
        [Self { control: left }, Self { control: right }]
    }

    /// `segments + 1` points at even steps of `t`, both ends included.
    pub fn sample(&self, segments: u32) -> Vec<P> {
        (0..=segments).map(|i| self.point(f64::from(i) / f64::from(segments.max(1)))).collect()
    }
}

/// A tensor-product Bezier surface, bicubic with 4 x 4 control points.
#[derive(Clone, Debug, PartialEq)]
pub struct BezierSurface<P> {
    /// One curve in v for each control step in u; all of the same degree.
    rows: Vec<BezierCurve<P>>,
}

impl<P: Point> BezierSurface<P> {
    /// The surface whose control point i, j is `control[i][j]`, with i along u and j along v.
    ///
    /// # Errors
    /// [`BezierError::NoControlPoints`] if there are none, [`BezierError::RaggedControlPoints`] if rows differ in length.
    pub fn new(control: Vec<Vec<P>>) -> Result<Self, BezierError> {
        let length = control.first().ok_or(BezierError::NoControlPoints)?.len();
        if let Some(row) = control.iter().position(|row| row.len() != length) {
            return Err(BezierError::RaggedControlPoints { row, length, found: control[row].len() });
        }
        Ok(Self { rows: control.into_iter().map(BezierCurve::new).collect::<Result<_, _>>()? })
    }

    /// The bicubic patch whose control point i, j is `control[i][j]`, with i along u and j along v.
    pub fn bicubic(control: [[P; 4]; 4]) -> Self {
        Self { rows: control.map(|row| BezierCurve { control: row.to_vec() }).to_vec() }
    }

    /// The control points i, j, one curve in v for each i.
    pub fn rows(&self) -> &[BezierCurve<P>] {
        &self.rows
    }

    /// The point at `(u, v)`.
    pub fn point(&self, u: f64, v: f64) -> P {
        self.curve_along_u(v).point(u)
    }

    /// The curve in u at `v`.
    pub fn curve_along_u(&self, v: f64) -> BezierCurve<P> {
        self.along_u(|row| row.point(v))
    }

    /// The derivatives with respect to u and to v at `(u, v)`.
    pub fn derivatives(&self, u: f64, v: f64) -> [P; 2] {
        [self.curve_along_u(v).derivative(u), self.along_u(|row| row.derivative(v)).point(u)]
    }

    fn along_u(&self, of_row: impl Fn(&BezierCurve<P>) -> P) -> BezierCurve<P> {
        BezierCurve { control: self.rows.iter().map(of_row).collect() }
    }

    /// Points on a grid of `u_steps` x `v_steps` cells, v running fastest, and two triangles per cell, counter-clockwise
    /// as seen from where u x v points. Triangles have corners apart; a collapsed side of the surface makes
    /// points that coincide.
    ///
    /// ```
    /// use glam::DVec3;
    /// use subzero::BezierSurface;
    ///
    /// let surface = BezierSurface::new(vec![vec![DVec3::ZERO, DVec3::X], vec![DVec3::Y, DVec3::ONE]])?;
    /// let (points, triangles) = surface.tessellate(4, 2)?;
    /// assert_eq!((points.len(), triangles.len()), (5 * 3, 2 * 4 * 2));
    /// # Ok::<(), subzero::BezierError>(())
    /// ```
    ///
    /// # Errors
    /// [`BezierError::TooLarge`] if there are more points than 32-bit ids can count.
    pub fn tessellate(&self, u_steps: u32, v_steps: u32) -> Result<(Vec<P>, Vec<[u32; 3]>), BezierError> {
        let [u_steps, v_steps] = [u_steps.max(1), v_steps.max(1)];
        let count = (u_steps as usize + 1).saturating_mul(v_steps as usize + 1);
        if !fits(count) {
            return Err(BezierError::TooLarge { what: "grid points", count });
        }
        let mut points = Vec::with_capacity(count);
        let mut triangles = Vec::new();
        for i in 0..=u_steps {
            for j in 0..=v_steps {
                let corner = id(points.len());
                points.push(self.point(f64::from(i) / f64::from(u_steps), f64::from(j) / f64::from(v_steps)));
                if i < u_steps && j < v_steps {
                    let across = corner + v_steps + 1;
                    triangles.push([corner, across, across + 1]);
                    triangles.push([corner, across + 1, corner + 1]);
                }
            }
        }
        Ok((points, triangles))
    }
}

impl BezierSurface<DVec3> {
    /// The unit normal at `(u, v)`, along the derivative in u x that in v; nothing where they are parallel or vanish.
    pub fn normal(&self, u: f64, v: f64) -> Option<DVec3> {
        let [along_u, along_v] = self.derivatives(u, v);
        along_u.cross(along_v).try_normalize()
    }
}
