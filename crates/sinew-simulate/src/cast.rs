//! Where a ray from a camera meets a solid.
//!
//! In the camera's frame the centre of projection is the origin and a pixel's ray is t (x, y, 1) with the pixel's place (x, y) before the lens: t is the depth.
//!
//! A tapered capsule is the convex hull of its two spheres (a; r_a) and (b; r_b). With c = b − a and d² = |c|² − (r_a − r_b)², its surface is the cone that touches both spheres where
//! `0 < y < d²`, `y = (p − a)·c − r_a (r_a − r_b)`, closed by the spheres. Every root of the three quadratics that fulfils its condition lies on the surface or inside, so the first of them is the
//! entry (the cone after Quilez, *Ray–rounded cone intersection*).
//!
//! An ellipsoid is the unit sphere after `p ↦ (h_k · (p − centre) / |h_k|²)_k` for its half axes h_k.
//!
//! The shadow that a solid casts on the image is bounded by tangent planes through the origin: of the quadric with dual matrix `S − c cᵀ`, S = Σ h_k h_kᵀ, the planes (1, 0, −x) touch it where
//! `(c_z² − S_zz) x² − 2 (c_x c_z − S_xz) x + c_x² − S_xx = 0`. A capsule is bounded by what bounds its spheres.

use crate::evaluation_body::ConvexShape;
use crate::space::{Vector, along, dot, minus, unit};
use sinew_observe::Camera;
use sinew_observe::cameras::camera::MIN_DEPTH_M;

/// A solid in the frame of a camera.
pub(super) struct Cast {
    kind: Kind,
    /// Least and greatest place before the lens, x and y; infinite for what reaches the plane of the camera.
    pub(super) bounds: [[f64; 2]; 2],
}

enum Kind {
    Capsule { a: Vector, radii: [f64; 2], axis: Vector, taper: f64, axis_squared: f64, slant_squared: f64, b: Vector },
    Ellipsoid { centre: Vector, to_unit: [Vector; 3] },
}

fn turned(camera: &Camera, v: Vector) -> Vector {
    camera.rotation.map(|row| dot(row, v))
}

impl Cast {
    /// The solid as seen by a camera; `None` behind it.
    pub(super) fn new(camera: &Camera, shape: &ConvexShape) -> Option<Self> {
        match shape {
            ConvexShape::Capsule { ends, radii } => {
                let [a, b] = ends.map(|end| camera.point_in_camera(end));
                let ball = |centre, radius: f64| extent(centre, [0, 1, 2].map(|k: usize| axis_vector(k, radius)));
                let bounds = match (ball(a, radii[0]), ball(b, radii[1])) {
                    (Some(first), Some(second)) => {
                        [0, 1].map(|i: usize| [first[i][0].min(second[i][0]), first[i][1].max(second[i][1])])
                    }
                    _ if (a[2] + radii[0]).max(b[2] + radii[1]) > MIN_DEPTH_M => EVERYWHERE,
                    _ => return None,
                };
                let axis = minus(b, a);
                let taper = radii[0] - radii[1];
                let axis_squared = dot(axis, axis);
                let slant_squared = axis_squared - taper * taper;
                Some(Self {
                    kind: Kind::Capsule { a, radii: *radii, axis, taper, axis_squared, slant_squared, b },
                    bounds,
                })
            }
            ConvexShape::Ellipsoid { centre, half_axes } => {
                let centre = camera.point_in_camera(*centre);
                let half_axes = half_axes.map(|axis| turned(camera, axis));
                let reach = half_axes.iter().map(|h| h[2] * h[2]).sum::<f64>().sqrt();
                let bounds = match extent(centre, half_axes) {
                    Some(bounds) => bounds,
                    None if centre[2] + reach > MIN_DEPTH_M => EVERYWHERE,
                    None => return None,
                };
                let to_unit = half_axes.map(|h| h.map(|x| x / dot(h, h)));
                Some(Self { kind: Kind::Ellipsoid { centre, to_unit }, bounds })
            }
        }
    }

    /// Depth at which the ray of a place before the lens enters.
    pub(super) fn entry(&self, [x, y]: [f64; 2]) -> Option<f64> {
        let ray = [x, y, 1.0];
        let depth = match &self.kind {
            Kind::Capsule { a, b, radii, axis, taper, axis_squared, slant_squared } => {
                let ball = |centre: Vector, radius: f64| {
                    first_root(dot(ray, ray), -dot(ray, centre), dot(centre, centre) - radius * radius)
                };
                let ends = ball(*a, radii[0]).min(ball(*b, radii[1]));
                if *slant_squared <= 0.0 {
                    ends
                } else {
                    let (along_axis, to_a) = (dot(*axis, ray), -dot(*axis, *a));
                    let k2 = slant_squared * dot(ray, ray) - along_axis * along_axis;
                    let k1 = -slant_squared * dot(ray, *a) - to_a * along_axis + along_axis * taper * radii[0];
                    let k0 = slant_squared * dot(*a, *a) - to_a * to_a + 2.0 * to_a * taper * radii[0]
                        - axis_squared * radii[0] * radii[0];
                    let root = (k1 * k1 - k0 * k2).sqrt();
                    let on_cone = |t: f64| {
                        let place = to_a - radii[0] * taper + t * along_axis;
                        if place > 0.0 && place < *slant_squared { t } else { f64::INFINITY }
                    };
                    ends.min(on_cone((-k1 - root) / k2)).min(on_cone((-k1 + root) / k2))
                }
            }
            Kind::Ellipsoid { centre, to_unit } => {
                let (direction, place) = (to_unit.map(|row| dot(row, ray)), to_unit.map(|row| dot(row, *centre)));
                first_root(dot(direction, direction), -dot(direction, place), dot(place, place) - 1.0)
            }
        };
        (depth.is_finite() && depth > MIN_DEPTH_M).then_some(depth)
    }

    /// Outward normal in the camera's frame at the entry of a ray.
    pub(super) fn normal(&self, [x, y]: [f64; 2], depth: f64) -> Vector {
        let point = [depth * x, depth * y, depth];
        let normal = match &self.kind {
            Kind::Capsule { a, b, radii, axis, taper, slant_squared, .. } => {
                let from_a = minus(point, *a);
                let place = dot(from_a, *axis) - radii[0] * taper;
                if *slant_squared > 0.0 && place > 0.0 && place < *slant_squared {
                    along(from_a.map(|v| v * slant_squared), -place, *axis)
                } else if (dot(from_a, from_a) - radii[0] * radii[0]).abs() < 1e-9 {
                    from_a
                } else {
                    minus(point, *b)
                }
            }
            Kind::Ellipsoid { centre, to_unit } => {
                let from = minus(point, *centre);
                to_unit.iter().fold([0.0; 3], |sum, row| along(sum, dot(*row, from), *row))
            }
        };
        unit(normal).unwrap_or([0.0, 0.0, -1.0])
    }
}

const EVERYWHERE: [[f64; 2]; 2] = [[f64::NEG_INFINITY, f64::INFINITY]; 2];

fn axis_vector(k: usize, length: f64) -> Vector {
    let mut axis = [0.0; 3];
    axis[k] = length;
    axis
}

/// The smaller root of `a t² + 2 b t + c`; infinite where there is none.
fn first_root(a: f64, b: f64, c: f64) -> f64 {
    let discriminant = b * b - a * c;
    if discriminant < 0.0 { f64::INFINITY } else { (-b - discriminant.sqrt()) / a }
}

/// Places before the lens that an ellipsoid reaches, x and y; `None` where it is not wholly in front.
fn extent(centre: Vector, half_axes: [Vector; 3]) -> Option<[[f64; 2]; 2]> {
    let s = |i: usize, j: usize| half_axes.iter().map(|h| h[i] * h[j]).sum::<f64>();
    if centre[2] - s(2, 2).sqrt() <= MIN_DEPTH_M {
        return None;
    }
    Some([0, 1].map(|i: usize| {
        let a = centre[2] * centre[2] - s(2, 2);
        let b = centre[i] * centre[2] - s(i, 2);
        let root = (b * b - a * (centre[i] * centre[i] - s(i, i))).max(0.0).sqrt();
        [(b - root) / a, (b + root) / a]
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draws::uniforms;
    use crate::space::{between, distance};
    use sinew_core::random::Stage;

    fn camera() -> Camera {
        Camera::look_at("C1", [320.0, 240.0], 340.0, [1.5, -3.0, 2.0], [0.0, 0.0, 1.0]).unwrap()
    }

    /// Whether a point lies in the solid by its definition: spheres of a capsule one by one, the ellipsoid's form.
    fn holds(shape: &ConvexShape, point: Vector) -> bool {
        match shape {
            ConvexShape::Capsule { ends, radii } => (0..=200).any(|k| {
                let part = f64::from(k) / 200.0;
                distance(point, between(ends[0], ends[1], part)) <= radii[0] + part * (radii[1] - radii[0])
            }),
            ConvexShape::Ellipsoid { centre, half_axes } => {
                let from = minus(point, *centre);
                half_axes.iter().map(|h| (dot(*h, from) / dot(*h, *h)).powi(2)).sum::<f64>() <= 1.0
            }
        }
    }

    fn shapes() -> Vec<ConvexShape> {
        let u = uniforms(&Stage::new(4, "shapes"), 0, 40 * 9);
        let mut shapes: Vec<ConvexShape> = u
            .chunks(9)
            .map(|u| ConvexShape::Capsule {
                ends: [0, 3].map(|k| [0.8 * u[k] - 0.4, 0.8 * u[k + 1] - 0.4, 0.7 + 0.7 * u[k + 2]]),
                radii: [6, 7].map(|k| 0.03 + 0.2 * u[k]),
            })
            .collect();
        // One sphere inside the other; equal radii; a single sphere.
        shapes.push(ConvexShape::Capsule { ends: [[0.0, 0.0, 1.0], [0.05, 0.0, 1.0]], radii: [0.2, 0.05] });
        shapes.push(ConvexShape::Capsule { ends: [[0.0, 0.0, 1.0], [0.4, 0.1, 1.2]], radii: [0.1, 0.1] });
        shapes.push(ConvexShape::Capsule { ends: [[0.1; 3], [0.1; 3]], radii: [0.1, 0.1] });
        let turn = |angle: f64| {
            let (s, c) = angle.sin_cos();
            [[0.3 * c, 0.3 * s, 0.0], [-0.1 * s, 0.1 * c, 0.0], [0.0, 0.0, 0.15]]
        };
        shapes.extend(
            [0.0, 0.7, 2.0].map(|angle| ConvexShape::Ellipsoid { centre: [0.1, 0.2, 1.1], half_axes: turn(angle) }),
        );
        shapes
    }

    /// Walks along rays in steps of 4 mm and asks the definition of the solid.
    #[test]
    fn entries_are_where_rays_first_are_inside() {
        let camera = camera();
        let (mut hits, mut grazes) = (0, 0);
        for shape in shapes() {
            let cast = Cast::new(&camera, &shape).unwrap();
            for k in 0..64_u32 {
                let place = [-0.14 + 0.04 * f64::from(k % 8), -0.14 + 0.04 * f64::from(k / 8)];
                let world = |depth: f64| {
                    let seen = minus([depth * place[0], depth * place[1], depth], camera.translation);
                    [0, 1, 2].map(|i: usize| (0..3).map(|j| camera.rotation[j][i] * seen[j]).sum::<f64>())
                };
                let sampled =
                    (550..1200).map(|step| 0.004 * f64::from(step)).find(|depth| holds(&shape, world(*depth)));
                match (cast.entry(place), sampled) {
                    (Some(entry), Some(sampled)) => {
                        hits += 1;
                        assert!((sampled - entry).abs() < 0.0085, "{entry} {sampled} {shape:?}");
                        let inside = [0, 1].iter().all(|&i| (cast.bounds[i][0]..cast.bounds[i][1]).contains(&place[i]));
                        assert!(inside, "{place:?} beyond {:?}", cast.bounds);
                        let normal = cast.normal(place, entry);
                        assert!(dot(normal, [place[0], place[1], 1.0]) < 1e-9);
                    }
                    (None, None) => {}
                    // A chord shorter than a step.
                    _ => grazes += 1,
                }
            }
        }
        assert!(hits > 300 && grazes < hits / 50, "{hits} hits, {grazes} grazes");
    }

    #[test]
    fn what_is_behind_casts_nothing_and_what_surrounds_is_everywhere() {
        let camera = camera();
        let centre = camera.centre();
        let at = |m: f64| along(centre, m, camera.rotation[2]);
        let ball = |m: f64, radius: f64| ConvexShape::Capsule { ends: [at(m); 2], radii: [radius; 2] };
        assert!(Cast::new(&camera, &ball(-1.0, 0.5)).is_none());
        assert_eq!(Cast::new(&camera, &ball(0.3, 0.5)).unwrap().bounds, EVERYWHERE);
        assert!(Cast::new(&camera, &ball(1.0, 0.5)).unwrap().entry([0.0, 0.0]).is_some());
    }
}
