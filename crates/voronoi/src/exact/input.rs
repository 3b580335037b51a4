//! What cells are cut by, in floating point.

use glam::DVec3;

use crate::exact::accurate_sum::{accurate_sum, sum_and_rest};
use crate::exact::frame::Frame;
use crate::exact::generator::Generator;
use crate::exact::image::{Image, ImageTable};
use crate::{Translation, Wall};

/// The input that exact decisions are made from. Sites are the seeds, then the periodic images of seeds.
#[derive(Clone, Copy)]
pub(crate) struct ExactInput<'a> {
    pub(crate) frame: &'a Frame,
    pub(crate) seeds: &'a [DVec3],
    /// Power weights, one per seed; all 0 if there are none.
    pub(crate) weights: Option<&'a [f64]>,
    pub(crate) images: &'a ImageTable,
}

impl<'a> ExactInput<'a> {
    /// The seed, and by how many periods it is moved, that a site is the image of.
    pub(crate) fn image(self, site: u32) -> Image {
        self.images.image(self.seeds.len(), site)
    }

    /// The site that is an image of a seed, if there is one.
    pub(crate) fn site(self, image: Image) -> Option<u32> {
        if image.translation == Translation::ZERO {
            return Some(image.seed);
        }
        let place = self.images.find(image)?;
        Some(u32::try_from(self.seeds.len() + place).expect("site ids were checked to fit"))
    }

    /// Number of sites.
    pub(crate) fn site_count(self) -> u32 {
        let count = self.seeds.len() + self.images.list().len();
        u32::try_from(count).expect("site ids were checked to fit")
    }

    /// Where a site lies, rounded.
    pub(crate) fn position(self, site: u32) -> DVec3 {
        let Image { seed, translation } = self.image(site);
        self.seeds[seed as usize] + translation.times(self.frame.size())
    }

    /// What bounds the cell of a seed across an axis before any other seed does: a wall, or its own image one period away.
    pub(crate) fn outermost(self, seed: u32, wall: Wall) -> Generator {
        if !self.frame.periodic.test(wall.axis()) {
            return Generator::side(wall);
        }
        let mut translation = [0; 3];
        translation[wall.axis()] = if wall.is_upper() { 1 } else { -1 };
        self.site(Image { seed, translation: Translation(translation) })
            .map_or(Generator::side(wall), Generator::site)
    }

    /// The planes that bound the cell of a seed before any other seed does, two for each axis.
    pub(crate) fn outermost_planes(self, seed: u32) -> impl Iterator<Item = Generator> + use<'a> {
        Wall::ALL[..2 * self.frame.axes].iter().map(move |wall| self.outermost(seed, *wall))
    }

    /// Distance of a seed from a wall, across a periodic axis half a period.
    #[inline]
    pub(crate) fn outermost_distance(self, seed: u32, wall: Wall) -> f64 {
        let axis = wall.axis();
        if self.frame.periodic.test(axis) {
            return 0.5 * self.frame.size()[axis];
        }
        (self.frame.side_coordinate(wall) - self.seeds[seed as usize][axis]).abs()
    }

    /// Whether a site is one of those that a cell begins with: the seed itself or one of its nearest images.
    pub(crate) fn bounds_from_start(self, seed: u32, site: u32) -> bool {
        let image = self.image(site);
        image.seed == seed
            && image.translation.0.iter().map(|translation| translation.unsigned_abs()).sum::<u8>() <= 1
    }

    /// Power weight of a site.
    #[inline]
    pub(crate) fn weight(self, site: u32) -> f64 {
        self.weights.map_or(0.0, |weights| weights[self.image(site).seed as usize])
    }

    /// The vector from a seed to a site, each coordinate rounded once or twice.
    #[inline]
    pub(crate) fn difference(self, seed: u32, site: u32) -> DVec3 {
        match self.seeds.get(site as usize) {
            Some(other) => other - self.seeds[seed as usize],
            None => self.difference_to_image(seed, site),
        }
    }

    fn difference_to_image(self, seed: u32, site: u32) -> DVec3 {
        let own = self.seeds[seed as usize];
        let image = self.image(site);
        let other = self.seeds[image.seed as usize];
        DVec3::from_array([0, 1, 2].map(|axis| {
            if image.translation.0[axis] == 0 {
                return other[axis] - own[axis];
            }
            // Shifts of at most two periods keep the products exact.
            let translation = f64::from(image.translation.0[axis]);
            let (lower, upper) = (self.frame.lower[axis], self.frame.upper[axis]);
            let (period, period_rest) = sum_and_rest(upper, -lower);
            if period_rest == 0.0 {
                // Either the second sum is exact, or it cancels too little for the rests to count.
                let (difference, rest) = sum_and_rest(other[axis], -own[axis]);
                let (sum, second_rest) = sum_and_rest(difference, translation * period);
                return sum + (rest + second_rest);
            }
            accurate_sum([other[axis], -own[axis], translation * upper, -translation * lower])
        }))
    }
}
