//! Cleaning of raw masks: specks and pinholes go by a median, connected parts stay if they are large.

use crate::silhouettes::bit_image::BitImage;

/// The median of each pixel and its eight neighbours: set where five of the nine are. Beyond the image the pixels of its border are repeated.
#[must_use]
pub fn median(image: &BitImage) -> BitImage {
    let (width, height) = (image.width(), image.height());
    BitImage::from_fn(width, height, |x, y| {
        let columns = [x.saturating_sub(1), x, (x + 1).min(width - 1)];
        let rows = [y.saturating_sub(1), y, (y + 1).min(height - 1)];
        rows.iter().flat_map(|y| columns.iter().map(move |x| (x, y))).filter(|(x, y)| image.get(**x, **y)).count() >= 5
    })
}

/// The parts of a mask whose number of pixels is at least `least_share` of that of the largest, and at least `least_pixels`. A part is what hangs together over sides
/// or corners of pixels.
#[must_use]
pub fn large_parts(image: &BitImage, least_share: f64, least_pixels: usize) -> BitImage {
    let (width, height) = (image.width(), image.height());
    let mut part_of = vec![0_u32; width * height];
    // Number 0 is no part.
    let mut sizes = vec![0_usize];
    let mut pending = Vec::new();
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        if !image.get(x, y) || part_of[y * width + x] != 0 {
            continue;
        }
        let part = sizes.len() as u32;
        let mut size = 0;
        part_of[y * width + x] = part;
        pending.push((x, y));
        while let Some((x, y)) = pending.pop() {
            size += 1;
            for (x, y) in (y.saturating_sub(1)..=y + 1).flat_map(|y| (x.saturating_sub(1)..=x + 1).map(move |x| (x, y)))
            {
                if image.get(x, y) && part_of[y * width + x] == 0 {
                    part_of[y * width + x] = part;
                    pending.push((x, y));
                }
            }
        }
        sizes.push(size);
    }
    let most = sizes.iter().copied().max().unwrap_or_default();
    let least = (least_share * most as f64).max(least_pixels as f64).max(1.0);
    BitImage::from_fn(width, height, |x, y| sizes[part_of[y * width + x] as usize] as f64 >= least)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(rows: &[&str]) -> BitImage {
        BitImage::from_fn(rows[0].len(), rows.len(), |x, y| rows[y].as_bytes()[x] == b'#')
    }

    #[test]
    fn a_speck_goes_and_a_pinhole_closes() {
        let raw = image(&["......#", ".####..", ".#.##..", ".####..", "......."]);
        assert_eq!(median(&raw), image(&[".......", "..##...", ".####..", "..##...", "......."]));
        assert_eq!(median(&image(&["###", "###"])), image(&["###", "###"]));
    }

    #[test]
    fn parts_are_kept_by_their_size() {
        let raw = image(&["##...#", "##....", "..#...", "...#.#", "#....#"]);
        assert_eq!(large_parts(&raw, 0.5, 0), image(&["##....", "##....", "..#...", "...#..", "......"]));
        assert_eq!(large_parts(&raw, 0.3, 0), image(&["##....", "##....", "..#...", "...#.#", ".....#"]));
        assert_eq!(large_parts(&raw, 0.0, 0), raw);
        assert_eq!(large_parts(&raw, 0.0, 7), BitImage::new(6, 5));
        assert_eq!(large_parts(&BitImage::new(3, 2), 0.0, 0), BitImage::new(3, 2));
    }
}
