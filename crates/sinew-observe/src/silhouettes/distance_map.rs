//! Euclidean distance of every pixel to the nearest pixel of a silhouette, in time linear in the pixels.
//!
//! The squared distance along the column is found first, then the lower envelope of the parabolas (x − x')² + d(x') along each row (Felzenszwalb & Huttenlocher,
//! *Distance Transforms of Sampled Functions*, 2012, section 2.1).

use crate::Map;
use crate::silhouettes::bit_image::BitImage;

/// Distance of each pixel's centre to that of the nearest set pixel, pixels; 0 in the silhouette, +∞ everywhere if that is empty.
#[must_use]
pub fn distance_map(silhouette: &BitImage) -> Map {
    let (width, height) = (silhouette.width(), silhouette.height());
    let mut squared = vec![f64::INFINITY; width * height];
    for x in 0..width {
        let mut nearest = None;
        for y in 0..height {
            nearest = if silhouette.get(x, y) { Some(y) } else { nearest };
            if let Some(row) = nearest {
                squared[y * width + x] = ((y - row) as f64).powi(2);
            }
        }
        let mut nearest = None;
        for y in (0..height).rev() {
            nearest = if silhouette.get(x, y) { Some(y) } else { nearest };
            if let Some(row) = nearest {
                squared[y * width + x] = squared[y * width + x].min(((row - y) as f64).powi(2));
            }
        }
    }
    let mut values = vec![f32::INFINITY; width * height];
    let mut envelope = Vec::with_capacity(width);
    for (row, out) in squared.chunks_exact(width.max(1)).zip(values.chunks_exact_mut(width.max(1))) {
        lower_envelope(row, &mut envelope);
        let mut parabolas = envelope.iter().peekable();
        let Some(mut current) = parabolas.next() else { continue };
        for (x, out) in out.iter_mut().enumerate() {
            while let Some(next) = parabolas.next_if(|next| next.from <= x as f64) {
                current = next;
            }
            *out = ((x as f64 - current.vertex as f64).powi(2) + row[current.vertex]).sqrt() as f32;
        }
    }
    Map { width, height, values }
}

/// A parabola that is the lowest from some abscissa on.
struct Parabola {
    vertex: usize,
    from: f64,
}

/// The parabolas that are lowest somewhere, from left to right; none of those with an infinite offset is.
fn lower_envelope(offsets: &[f64], envelope: &mut Vec<Parabola>) {
    envelope.clear();
    for (vertex, offset) in offsets.iter().enumerate().filter(|(_, offset)| offset.is_finite()) {
        let mut from = f64::NEG_INFINITY;
        while let Some(last) = envelope.last() {
            let (a, b) = (last.vertex as f64, vertex as f64);
            let crossing = (offset + b * b - offsets[last.vertex] - a * a) / (2.0 * (b - a));
            if crossing > last.from {
                from = crossing;
                break;
            }
            envelope.pop();
        }
        envelope.push(Parabola { vertex, from });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_the_least_of_all_distances() {
        for (seed, rare) in [(1, 3), (2, 17), (3, 101), (4, 400)] {
            let image = BitImage::from_fn(37, 23, |x, y| (x * 131 + y * 71 + seed * x * y + 5) % rare == 1);
            let set: Vec<(usize, usize)> =
                (0..23).flat_map(|y| (0..37).map(move |x| (x, y))).filter(|&(x, y)| image.get(x, y)).collect();
            assert!(!set.is_empty(), "{rare}");
            let map = distance_map(&image);
            for (x, y) in (0..23).flat_map(|y| (0..37).map(move |x| (x, y))) {
                let distance = |&(a, b): &(usize, usize)| (x as f64 - a as f64).hypot(y as f64 - b as f64);
                let wanted = set.iter().map(distance).fold(f64::INFINITY, f64::min) as f32;
                assert!((map.get(x, y).unwrap() - wanted).abs() < 1e-5);
            }
        }
    }

    #[test]
    fn an_empty_silhouette_is_infinitely_far() {
        assert!(distance_map(&BitImage::new(5, 4)).values.iter().all(|value| *value == f32::INFINITY));
        assert!(distance_map(&BitImage::new(0, 0)).values.is_empty());
    }
}
