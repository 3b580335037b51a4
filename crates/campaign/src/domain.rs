//! What the grains of a run fill: boxes small and large, long and flat, periodic or not, and other bodies.

use crate::draw::Draw;
use crate::options::Options;

/// The domain of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Domain {
    /// Sides of the box, two or three.
    pub sides: Vec<f64>,
    /// Share of the box, around its middle, in which seeds of a file surely lie inside.
    pub inner: f64,
    /// Whether the grains repeat.
    pub is_periodic: bool,
    /// Whether periodic grains end at the box.
    pub is_cut: bool,
    /// Files that the options name.
    pub files: Vec<(String, Vec<u8>)>,
}

impl Domain {
    /// Draws a domain of so many dimensions whose box has sides in these proportions, and writes it into the options.
    pub fn draw(draw: &mut Draw, proportions: Vec<f64>, options: &mut Options) -> Self {
        // Half of the boxes are as users have them; the others from nanometres to a million.
        let scale = if draw.chance(0.5) { 1.0 } else { draw.magnitude(1e-9, 1e6) };
        let sides: Vec<f64> = proportions.iter().map(|side| side * scale).collect();
        let mut domain = Self { sides, inner: 1.0, is_periodic: false, is_cut: false, files: Vec::new() };
        match draw.weighted(&[
            (0.45, "walls"),
            (0.42, "periodic"),
            (0.09, "curved"),
            (0.03, "planes"),
            (0.02, "surface"),
        ]) {
            "periodic" => domain.repeat(draw, options),
            "curved" => domain.curve(draw, options),
            "planes" => domain.cut_corners(draw, options),
            "surface" => domain.close_surface(options),
            _ => {}
        }
        if domain.files.is_empty() {
            options.set("box", &domain.sides);
        }
        domain
    }

    /// Length that a grain has on average, among so many.
    pub fn spacing(&self, count: u32) -> f64 {
        let all = self.sides.iter().product::<f64>() / f64::from(count);
        if self.sides.len() == 2 { all.sqrt() } else { all.cbrt() }
    }

    fn repeat(&mut self, draw: &mut Draw, options: &mut Options) {
        let axes = &["x", "y", "z"][..self.sides.len()];
        let mut periodic: Vec<&str> = axes.iter().copied().filter(|_| draw.chance(0.5)).collect();
        if periodic.is_empty() || draw.chance(0.5) {
            periodic = axes.to_vec();
        }
        options.set("periodic", [periodic.join(",")]);
        self.is_periodic = true;
        self.is_cut = draw.chance(0.45);
        if self.is_cut {
            options.set("periodic-cut", ["box"]);
        }
    }

    fn curve(&mut self, draw: &mut Draw, options: &mut Options) {
        let diameter = self.sides[0];
        self.sides[1] = diameter;
        let shape = match self.sides.get_mut(2) {
            None => "disc",
            Some(height) if draw.chance(0.6) => {
                *height = diameter;
                "sphere"
            }
            Some(_) => "cylinder",
        };
        options.set("domain", [shape]);
        // The cube in a ball of radius 1/2 has sides of 0.577.
        self.inner = 0.5;
        if draw.chance(0.5) {
            options.set("chord-error", [diameter * draw.magnitude(0.002, 0.05)]);
        }
    }

    /// A box whose corners some half-spaces cut off.
    fn cut_corners(&mut self, draw: &mut Draw, options: &mut Options) {
        let shortest = self.sides.iter().copied().fold(f64::INFINITY, f64::min);
        let mut lines = Vec::new();
        for (axis, side) in self.sides.iter().enumerate() {
            for (sign, offset) in [(1.0, *side), (-1.0, 0.0)] {
                let mut line = vec![0.0; self.sides.len()];
                line[axis] = sign;
                line.push(offset);
                lines.push(line);
            }
        }
        for _ in 0..draw.whole(1..=5) {
            let normal: Vec<f64> = self.sides.iter().map(|_| draw.between(-1.0, 1.0)).collect();
            let length = normal.iter().map(|part| part * part).sum::<f64>().sqrt();
            let middle: f64 = normal.iter().zip(&self.sides).map(|(part, side)| part * side / 2.0).sum();
            let offset = middle + length * shortest * draw.between(0.25, 0.5);
            lines.push(normal.into_iter().chain([offset]).collect());
        }
        let text = |line: &Vec<f64>| {
            let numbers: Vec<String> = line.iter().map(|number| format!("{number:?}")).collect();
            numbers.join(", ") + "\n"
        };
        let content: String = lines.iter().map(text).collect();
        self.files.push(("planes.csv".to_owned(), content.into_bytes()));
        options.set("half-spaces", ["planes.csv"]);
        // Half of the shortest side's quarter, whatever the direction, is inside; other sides are longer.
        let longest = self.sides.iter().copied().fold(0.0, f64::max);
        self.inner = 0.28 * shortest / longest;
    }

    /// An octahedron in the box; in the plane the box itself.
    fn close_surface(&mut self, options: &mut Options) {
        let &[x, y, z] = &self.sides[..] else { return };
        let mut content = String::new();
        for [i, j, k] in [[0., 1., 1.], [2., 1., 1.], [1., 0., 1.], [1., 2., 1.], [1., 1., 0.], [1., 1., 2.]]
        {
            content += &format!("v {:?} {:?} {:?}\n", i * x / 2.0, j * y / 2.0, k * z / 2.0);
        }
        content += "f 6 2 4\nf 6 4 1\nf 6 1 3\nf 6 3 2\nf 5 4 2\nf 5 1 4\nf 5 3 1\nf 5 2 3\n";
        self.files.push(("body.obj".to_owned(), content.into_bytes()));
        options.set("domain", ["body.obj"]);
        // The box of a third of the sides touches the faces.
        self.inner = 0.33;
    }
}

/// Sides of a box in proportion: a cube, or up to 20:1.
pub fn proportions(draw: &mut Draw, dimension: usize) -> Vec<f64> {
    let is_cube = draw.chance(0.55);
    (0..dimension).map(|_| if is_cube { 1.0 } else { draw.magnitude(0.05, 1.0) }).collect()
}
