//! Pictures of meshes and curves that are no grains, still and animated.

use std::f64::consts::FRAC_1_SQRT_2;
use std::io;
use std::num::NonZeroU16;

use colorous::TABLEAU10;
use glam::DVec3;
use subzero::FaceId;
use tiny_skia::Pixmap;

use super::camera::Camera;
use super::color::{Color, channels};
use super::raster::{Figures, LINE, draw_figures, samples};
use super::scene_colors::{ColorScale, SceneColors};
use super::{Picture, Png, beside_legend, blank};
use crate::{Error, Output, StagedFiles};

/// The front of surfaces: sand.
const FRONT: Color = [0.85, 0.79, 0.66];

/// The back of surfaces, which shows where they are open or wind the wrong way: blue.
const BACK: Color = [0.55, 0.66, 0.82];

/// Faces at a point whose normals differ by less share a normal there, as a cosine: 45 degrees, half of what a cube's differ by.
const SMOOTH_COSINE: f64 = FRAC_1_SQRT_2;

/// Width of a curve, in widths of an edge.
const CURVE: f64 = 3.0;

/// Radius of a point, in widths of an edge.
const POINT: f64 = 6.0;

/// Seconds for which each level of an animated picture stays.
const SECONDS_A_FRAME: u16 = 1;

/// A mesh or curves to draw.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Scene {
    /// Coordinates of each point.
    pub points: Vec<DVec3>,
    /// The points of each face.
    pub faces: Vec<Vec<u32>>,
    /// The points of each polyline.
    pub lines: Vec<Vec<u32>>,
    /// The number of each polyline's colour; all have the first where there are none.
    pub line_colors: Vec<i32>,
    /// What is coloured by numbers.
    pub colors: Option<SceneColors>,
}

/// How surfaces and curves are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Shading {
    /// Each face by itself, with its edges; curves with their points.
    #[default]
    Flat,
    /// By normals at the points, without edges but at boundaries; curves without points.
    Smooth,
}

/// How a picture of meshes or curves looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ScenePicture {
    /// Width and height in pixels.
    pub size: [NonZeroU16; 2],
    /// How surfaces and curves are drawn.
    pub shading: Shading,
}

impl Default for ScenePicture {
    fn default() -> Self {
        Self { size: Picture::SIZE, shading: Shading::Flat }
    }
}

impl ScenePicture {
    /// Completes a picture of the scenes, which all have the same scale: of one a still, of several an animation (APNG) that shows each
    /// for a second. `made_by` is the command line, which the file carries.
    ///
    /// # Errors
    /// [`Error::WriteOutput`]; [`Error::OutputTwice`].
    pub fn stage(
        self,
        scenes: &[Scene],
        made_by: &str,
        output: &Output<Png>,
        files: &mut StagedFiles,
    ) -> Result<(), Error> {
        output.stage(files, |out| out.write_all(&self.png(scenes, made_by)?))
    }

    /// The bytes of a PNG file.
    pub(crate) fn png(self, scenes: &[Scene], made_by: &str) -> io::Result<Vec<u8>> {
        let scale = ColorScale::new(scenes.iter().filter_map(|scene| scene.colors.as_ref()));
        let legend = scale.as_ref().map(ColorScale::legend);
        let frame = |scene| {
            beside_legend(legend.as_ref(), self.size, false, |size| {
                let points = scenes.iter().flat_map(|scene| &scene.points);
                let camera = Camera::of_points(points, samples(size));
                Self { size, ..self }.frame(scene, &camera, scale.as_ref())
            })
        };
        let frames: Vec<Pixmap> = scenes.iter().map(frame).collect::<io::Result<_>>()?;
        encoded(frames, self.size, made_by).map_err(io::Error::other)
    }

    fn frame(self, scene: &Scene, camera: &Camera, scale: Option<&ColorScale>) -> io::Result<Pixmap> {
        let mut pixmap = blank(self.size, false)?;
        let width = Picture { size: self.size, ..Picture::default() }.line_width();
        // Samples are three to a pixel.
        let half_width = 1.5 * width;
        let mut figures = Figures::default();
        let painted =
            |cell: usize, point: u32| Some(scale?.color(scene.colors.as_ref()?.numbers.at(cell, point)));
        self.add_surface(scene, (camera, half_width), painted, &mut figures);
        self.add_curves(scene, (camera, half_width), painted, &mut figures);
        draw_figures(&figures, &mut pixmap);
        Ok(pixmap)
    }

    /// `painted` is the colour of a corner of a face, where numbers give it one.
    fn add_surface(
        self,
        scene: &Scene,
        (camera, half_width): (&Camera, f64),
        painted: impl Fn(usize, u32) -> Option<Color>,
        figures: &mut Figures,
    ) {
        let places: Vec<DVec3> = scene.points.iter().map(|point| camera.project(*point)).collect();
        let (triangles, face_of) = scene.triangles();
        let normals: Vec<DVec3> = scene.faces.iter().map(|face| scene.area_vector(face)).collect();
        let faces_at = match self.shading {
            Shading::Flat => Vec::new(),
            Shading::Smooth => scene.faces_at_points(),
        };
        for (triangle, face) in triangles.iter().zip(face_of) {
            let own = normals[face.index()].normalize_or_zero();
            let is_front = own.dot(camera.toward) >= 0.0;
            let brightness = triangle.map(|point| {
                let normal = match faces_at.get(point as usize) {
                    Some(faces) => smooth_normal(own, faces, &normals),
                    None => own,
                };
                camera.brightness(if is_front { normal } else { -normal })
            });
            let side = if is_front { FRONT } else { BACK };
            let mut corners = triangle.map(|point| places[point as usize]);
            let mut colors = [0, 1, 2].map(|corner| {
                let color = painted(face.index(), triangle[corner]).unwrap_or(side);
                color.map(|channel| channel * brightness[corner])
            });
            if !is_front {
                corners.swap(1, 2);
                colors.swap(1, 2);
            }
            figures.triangles.push((corners, colors));
        }
        let edges = scene.edges(self.shading == Shading::Smooth);
        let lines =
            edges.into_iter().map(|ends| (ends.map(|end| places[end as usize]), LINE, 0.5 * half_width));
        figures.lines.extend(lines);
    }

    fn add_curves(
        self,
        scene: &Scene,
        (camera, half_width): (&Camera, f64),
        painted: impl Fn(usize, u32) -> Option<Color>,
        figures: &mut Figures,
    ) {
        for (number, line) in scene.lines.iter().enumerate() {
            let places: Vec<DVec3> =
                line.iter().map(|point| camera.project(scene.points[*point as usize])).collect();
            for (ends, points) in places.windows(2).zip(line.windows(2)) {
                let color = painted(number, points[0]).unwrap_or_else(|| scene.color(number));
                figures.lines.push(([ends[0], ends[1]], color, CURVE * half_width));
            }
            if self.shading == Shading::Flat {
                figures.discs.extend(places.iter().map(|place| (*place, LINE, POINT * half_width)));
            }
        }
        // A point that no line runs through stands for itself: the last of de Casteljau's.
        if self.shading == Shading::Flat && !scene.lines.is_empty() {
            let mut is_used = vec![false; scene.points.len()];
            scene.lines.iter().flatten().for_each(|point| is_used[*point as usize] = true);
            let alone = scene.points.iter().zip(is_used).filter(|(_, is_used)| !is_used);
            let color = scene.color(scene.lines.len());
            figures
                .discs
                .extend(alone.map(|(point, _)| (camera.project(*point), color, 1.5 * POINT * half_width)));
        }
    }
}

impl Scene {
    /// The faces cut into triangles, and the face of each.
    pub(crate) fn triangles(&self) -> (Vec<[u32; 3]>, Vec<FaceId>) {
        // What cannot be cut, as it crosses itself, is drawn as a fan.
        subzero::triangulate(&self.points, &self.faces).unwrap_or_else(|_| {
            let fan = |face: &Vec<u32>| -> Vec<[u32; 3]> {
                face[1..].windows(2).map(|pair| [face[0], pair[0], pair[1]]).collect()
            };
            let fans = (0..)
                .map(FaceId)
                .zip(&self.faces)
                .flat_map(|(number, face)| fan(face).into_iter().map(move |triangle| (triangle, number)));
            fans.unzip()
        })
    }

    fn area_vector(&self, face: &[u32]) -> DVec3 {
        let [first, rest @ ..] = face else { return DVec3::ZERO };
        let at = |point: u32| self.points[point as usize] - self.points[*first as usize];
        rest.windows(2).map(|pair| at(pair[0]).cross(at(pair[1]))).sum()
    }

    fn faces_at_points(&self) -> Vec<Vec<u32>> {
        let mut faces_at = vec![Vec::new(); self.points.len()];
        for (number, face) in (0..).zip(&self.faces) {
            face.iter().for_each(|point| faces_at[*point as usize].push(number));
        }
        faces_at
    }

    /// All edges of faces, or those alone that do not have two.
    fn edges(&self, on_boundaries: bool) -> Vec<[u32; 2]> {
        let sides = |face: &Vec<u32>| -> Vec<[u32; 2]> {
            let next = face.iter().cycle().skip(1);
            face.iter().zip(next).map(|(&a, &b)| [a.min(b), a.max(b)]).collect()
        };
        let mut edges: Vec<[u32; 2]> = self.faces.iter().flat_map(sides).collect();
        edges.sort_unstable();
        let edges = edges.chunk_by(|a, b| a == b).filter(|uses| !on_boundaries || uses.len() != 2);
        edges.map(|uses| uses[0]).collect()
    }

    /// The colour of a polyline.
    fn color(&self, line: usize) -> Color {
        let default = if self.line_colors.is_empty() { 0 } else { line };
        let number =
            self.line_colors.get(line).and_then(|number| usize::try_from(*number).ok()).unwrap_or(default);
        channels(TABLEAU10[number % TABLEAU10.len()])
    }
}

/// The mean of the normals at a point that differ little from that of a face.
fn smooth_normal(own: DVec3, faces: &[u32], normals: &[DVec3]) -> DVec3 {
    let near = faces.iter().map(|face| normals[*face as usize]);
    let near = near.filter(|normal| normal.normalize_or_zero().dot(own) > SMOOTH_COSINE);
    near.sum::<DVec3>().normalize_or(own)
}

/// Pictures without transparency as PNG; several as an animation.
fn encoded(frames: Vec<Pixmap>, size: [NonZeroU16; 2], made_by: &str) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let [width, height] = size.map(|side| u32::from(side.get()));
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.add_text_chunk("Software".to_owned(), format!("grainsmooth {}", env!("CARGO_PKG_VERSION")))?;
    encoder.add_itxt_chunk("CommandLine".to_owned(), made_by.to_owned())?;
    if frames.len() > 1 {
        // There are at most a hundred levels. The animation goes round without end.
        encoder.set_animated(u32::try_from(frames.len()).unwrap_or(u32::MAX), 0)?;
        encoder.set_frame_delay(SECONDS_A_FRAME, 1)?;
    }
    let mut writer = encoder.write_header()?;
    for frame in frames {
        writer.write_image_data(&frame.take_demultiplied())?;
    }
    writer.finish()?;
    Ok(bytes)
}
