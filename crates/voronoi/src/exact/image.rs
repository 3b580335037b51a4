//! Periodic images of seeds, in layers around the domain.

use glam::DVec3;

use crate::Translation;
use crate::exact::frame::Frame;

/// A seed moved by whole periods.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Image {
    pub(crate) seed: u32,
    pub(crate) translation: Translation,
}

/// Images of seeds by number, and their numbers by image.
#[derive(Debug, Clone, Default)]
pub(crate) struct ImageTable {
    list: Vec<Image>,
    /// Places in `list`, sorted by what stands there.
    order: Vec<u32>,
    /// Those of the images of seed s are `order[starts[s]..starts[s + 1]]`.
    starts: Vec<u32>,
}

impl ImageTable {
    pub(crate) fn list(&self) -> &[Image] {
        &self.list
    }

    /// The seed, and by how many periods it is moved, that a site is the image of: sites are so many seeds, then the list.
    pub(crate) fn image(&self, seed_count: usize, site: u32) -> Image {
        match (site as usize).checked_sub(seed_count) {
            None => Image { seed: site, translation: Translation::ZERO },
            Some(image) => self.list[image],
        }
    }

    /// Place of an image in the list.
    pub(crate) fn find(&self, image: Image) -> Option<usize> {
        let seed = image.seed as usize;
        let (start, end) = (*self.starts.get(seed)?, *self.starts.get(seed + 1)?);
        let of_seed = &self.order[start as usize..end as usize];
        of_seed.iter().map(|place| *place as usize).find(|place| self.list[*place] == image)
    }

    /// This table and, after what it has, all images within a distance of the domain along each axis.
    ///
    /// A distance of at most one period is enough for every cell: across a plane at half a period from its seed a cell
    /// meets the seed's own image, and of two images of another seed that are whole periods apart the farther one is
    /// nearer to no point between these planes.
    pub(crate) fn widened(&self, frame: &Frame, seeds: &[DVec3], thickness: DVec3) -> Self {
        let size = frame.size();
        // Rounded positions of images may miss the limit by some last places; one image more does no harm.
        let margin = 1e-12 * size;
        let (lower, upper) = (frame.lower - thickness - margin, frame.upper + thickness + margin);
        let mut list = self.list.clone();
        for (seed, position) in (0u32..).zip(seeds) {
            let translations = |axis: usize| {
                let reaches = move |translation: &i8| {
                    let moved = position[axis] + f64::from(*translation) * size[axis];
                    *translation == 0 || (moved >= lower[axis] && moved <= upper[axis])
                };
                // A seed on the upper wall is two periods away from where it comes to lie one period below the lower.
                let farthest = if frame.periodic.test(axis) { 2i8 } else { 0 };
                (-farthest..=farthest).filter(reaches)
            };
            for x in translations(0) {
                for y in translations(1) {
                    for z in translations(2) {
                        let image = Image { seed, translation: Translation([x, y, z]) };
                        if image.translation != Translation::ZERO && self.find(image).is_none() {
                            list.push(image);
                        }
                    }
                }
            }
        }
        let mut order: Vec<u32> = (0u32..).take(list.len()).collect();
        order.sort_unstable_by_key(|place| list[*place as usize]);
        let mut starts = vec![0; seeds.len() + 1];
        for image in &list {
            starts[image.seed as usize + 1] += 1;
        }
        for seed in 0..seeds.len() {
            starts[seed + 1] += starts[seed];
        }
        Self { list, order, starts }
    }
}
