//! Laws of forward kinematics and of the backward sweep, on random trees.

use proptest::prelude::*;
use sinew_body::kinematics::{Inform, V3, Visit};
use sinew_body::{
    Axis, Joint, KinematicTree, Link, Plan, Point, Proportions, point_jacobian, point_jacobian_each, point_positions,
    point_positions_block, standard,
};
use sinew_core::lanes::triangle;
use sinew_core::lanes::{Block, Isa, Kernel, LANES, Real, dispatch, get_lane, set_lane};

fn direction() -> impl Strategy<Value = [f64; 3]> {
    let unit = |[turn, height]: [f64; 2]| {
        let away = (1.0 - height * height).sqrt();
        [away * turn.cos(), away * turn.sin(), height]
    };
    [-3.1..3.1, -0.99..0.99].prop_map(unit)
}

fn axis() -> impl Strategy<Value = Axis> {
    let free = direction().prop_map(|vector| Axis::along(vector).expect("a direction"));
    prop_oneof![2 => Just(Axis::X), 2 => Just(Axis::Y), 2 => Just(Axis::Z), 1 => free]
}

/// A rest rotation, or none.
fn rest() -> impl Strategy<Value = Option<M3>> {
    let turned = (direction(), -3.0..3.0).prop_map(|(axis, angle)| about(axis, angle));
    prop_oneof![3 => Just(None), 1 => turned.prop_map(Some)]
}

fn joint() -> impl Strategy<Value = Joint> {
    prop_oneof![1 => axis().prop_map(Joint::Translate), 3 => axis().prop_map(Joint::Rotate)]
}

fn offset() -> impl Strategy<Value = [f64; 3]> {
    let component = prop_oneof![1 => Just(0.0), 3 => -1.0..1.0];
    [component.clone(), component.clone(), component]
}

/// A tree of 1 to 6 links with up to four joints each and two points a link, and two poses.
fn tree_and_pose() -> impl Strategy<Value = (KinematicTree, Vec<f64>)> {
    let joints = prop::collection::vec(joint(), 0..5);
    let link = (any::<prop::sample::Index>(), offset(), rest(), joints, offset(), offset());
    prop::collection::vec(link, 1..7)
        .prop_map(|described| {
            let mut links = vec![];
            let mut points = vec![];
            for (i, (parent, offset, rest, joints, a, b)) in described.into_iter().enumerate() {
                let parent = (i > 0).then(|| parent.index(i));
                links.push(Link { rest, ..Link::new(format!("link{i}"), parent, offset, joints) });
                points.push(Point { name: format!("a{i}"), link: i, offset: a });
                points.push(Point { name: format!("b{i}"), link: i, offset: b });
            }
            KinematicTree::new(links, points).expect("built valid")
        })
        .prop_flat_map(|tree| {
            let pose = prop::collection::vec(-3.0..3.0, tree.dof());
            (Just(tree), pose)
        })
}

type M3 = [[f64; 3]; 3];

fn applied(m: &M3, x: [f64; 3]) -> [f64; 3] {
    m.map(|row| row[0] * x[0] + row[1] * x[1] + row[2] * x[2])
}

/// Active right-handed rotation, by the exponential series of the cross product with the axis.
fn about([x, y, z]: [f64; 3], q: f64) -> M3 {
    let cross = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
    let (mut sum, mut term) = (UNTURNED, UNTURNED);
    for k in 1..40 {
        term = multiplied(&term, &cross).map(|row| row.map(|x| x * q / f64::from(k)));
        sum = [0, 1, 2].map(|i: usize| [0, 1, 2].map(|j: usize| sum[i][j] + term[i][j]));
    }
    sum
}

const UNTURNED: M3 = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

fn multiplied(m: &M3, r: &M3) -> M3 {
    [0, 1, 2].map(|i: usize| [0, 1, 2].map(|j: usize| (0..3).map(|k| m[i][k] * r[k][j]).sum()))
}

/// Points by the definition of a tree, with a matrix a link.
fn defined(tree: &KinematicTree, q: &[f64]) -> Vec<f64> {
    let mut frames: Vec<(M3, [f64; 3])> = vec![];
    let mut q = q.iter();
    for link in tree.links() {
        let world = (UNTURNED, [0.0; 3]);
        let (mut rotation, origin) = link.parent.map_or(world, |parent| frames[parent]);
        let moved = |rotation: &M3, from: [f64; 3], by: [f64; 3]| {
            let by = applied(rotation, by);
            [from[0] + by[0], from[1] + by[1], from[2] + by[2]]
        };
        let mut origin = moved(&rotation, origin, link.offset);
        rotation = link.rest.map_or(rotation, |rest| multiplied(&rotation, &rest));
        for (joint, &q) in link.joints.iter().zip(&mut q) {
            match *joint {
                Joint::Rotate(axis) => rotation = multiplied(&rotation, &about(axis.direction(), q)),
                Joint::Translate(axis) => origin = moved(&rotation, origin, axis.direction().map(|x| q * x)),
            }
        }
        frames.push((rotation, origin));
    }
    let at = |point: &Point| {
        let (rotation, origin) = &frames[point.link];
        let by = applied(rotation, point.offset);
        [0, 1, 2].map(|k: usize| origin[k] + by[k])
    };
    tree.points().iter().flat_map(at).collect()
}

fn positions(plan: &Plan, q: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; 3 * plan.points()];
    point_positions(plan, Isa::best(), q, &mut out);
    out
}

struct Diagonal<'a>(&'a Plan, &'a [Block], &'a mut [Block], &'a mut [Block]);
impl Kernel<Block> for Diagonal<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        let mut ws = vec![Block::ZERO; self.0.workspace()];
        self.0.gauss_newton_diagonal::<V>(self.1, &mut ws, self.2, &Same);
        self.0.gauss_newton::<V>(self.1, &mut ws, self.3, &Same);
    }
}

struct Same;
impl<V: Real> Inform<V> for Same {
    #[inline(always)]
    fn information(&self, _k: usize, _p: V3<V>) -> [V; 6] {
        [V::splat(2.0), V::splat(0.5), V::splat(-0.3), V::splat(1.0), V::splat(0.1), V::splat(3.0)]
    }
}

/// Force on point k in the plan's order.
fn force(k: usize) -> [f64; 3] {
    [1.0, 2.0, 3.0].map(|a| (a + 7.0 * k as f64).sin())
}

struct Pushed;
impl<V: Real> Visit<V> for Pushed {
    #[inline(always)]
    fn point(&mut self, k: usize, _p: V3<V>) -> V3<V> {
        let [x, y, z] = force(k);
        [V::splat(x), V::splat(y), V::splat(z)]
    }
}

struct Sweep<'a>(&'a Plan, &'a [Block], &'a mut [Block]);
impl Kernel<Block> for Sweep<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        let mut ws = vec![Block::ZERO; self.0.workspace()];
        self.0.sweep::<V, true>(self.1, self.2, &mut ws, &mut Pushed);
    }
}

proptest! {
    /// Forward kinematics (K1 to K3): points lie where the definition of the tree puts them, computed with whole matrices; on random trees and on the built-in bodies.
    #[test]
    fn points_lie_where_the_tree_is_defined_to_put_them(
        (tree, q) in tree_and_pose(),
        angles in prop::collection::vec(-3.0..3.0, 32),
    ) {
        let p = Proportions::default();
        let bodies = [standard::cf28(&p), standard::h32(&p)].map(|body| (body.clone(), angles[..body.dof()].to_vec()));
        for (tree, q) in bodies.into_iter().chain([(tree, q)]) {
            let found = positions(&Plan::with_all_points(&tree), &q);
            for (found, expected) in found.iter().zip(defined(&tree, &q)) {
                prop_assert!((found - expected).abs() < 1e-12 * (1.0 + expected.abs()), "{found} against {expected}");
            }
        }
    }

    /// Gradients (K4): the backward sweep returns `Jᵀ g`, on every instruction set.
    #[test]
    fn backward_sweep_is_the_transposed_jacobian((tree, q) in tree_and_pose()) {
        let plan = Plan::with_all_points(&tree);
        let (d, n) = (plan.dof(), 3 * plan.points());
        let (mut p, mut jacobian) = (vec![0.0; n], vec![0.0; n * d]);
        point_jacobian(&plan, Isa::best(), &q, &mut p, &mut jacobian);
        let block: Vec<Block> = q.iter().map(|&x| Block::splat(x)).collect();
        let largest = jacobian.iter().fold(1.0_f64, |m, x| m.max(x.abs()));
        for isa in Isa::available() {
            let mut grad = vec![Block::ZERO; d];
            dispatch(isa, Sweep(&plan, &block, &mut grad));
            for j in 0..d {
                let expected: f64 = (plan.order().iter().enumerate())
                    .flat_map(|(i, &k)| force(i).into_iter().enumerate().map(move |(a, g)| (3 * k + a, g)))
                    .map(|(row, g)| g * jacobian[row * d + j])
                    .sum();
                prop_assert!((grad[j].0[3] - expected).abs() < 1e-12 * largest * n as f64, "{}, coordinate {j}", isa.name());
            }
        }
    }

    /// Gradients (K4): the Jacobian is that of central differences.
    #[test]
    fn jacobian_agrees_with_central_differences((tree, q) in tree_and_pose()) {
        let plan = Plan::with_all_points(&tree);
        let (d, n) = (plan.dof(), 3 * plan.points());
        let (mut p, mut jacobian) = (vec![0.0; n], vec![0.0; n * d]);
        point_jacobian(&plan, Isa::best(), &q, &mut p, &mut jacobian);
        prop_assert_eq!(&p, &positions(&plan, &q));
        let largest = jacobian.iter().fold(1.0_f64, |m, x| m.max(x.abs()));
        for j in 0..d {
            let at = |h: f64| {
                let mut q = q.clone();
                q[j] += h;
                positions(&plan, &q)
            };
            let (above, below) = (at(1e-6), at(-1e-6));
            for i in 0..n {
                let numeric = (above[i] - below[i]) / 2e-6;
                prop_assert!((numeric - jacobian[i * d + j]).abs() < 1e-7 * largest, "row {i}, coordinate {j}");
            }
        }
    }

    /// Jacobians of many states, eight at a time, equal the Jacobians of the states one by one, whatever their number.
    #[test]
    fn jacobians_of_many_states_are_the_jacobians_of_each((tree, q) in tree_and_pose(), count in 1_usize..20) {
        let plan = Plan::with_all_points(&tree);
        let (d, n) = (plan.dof(), 3 * plan.points());
        prop_assume!(d > 0 && n > 0);
        let states: Vec<f64> = (0..count).flat_map(|k| q.iter().map(move |x| x + 0.1 * k as f64)).collect();
        let (mut at, mut by) = (vec![0.0; count * n], vec![0.0; count * n * d]);
        point_jacobian_each(&plan, Isa::best(), &states, &mut at, &mut by);
        for (k, state) in states.chunks(d).enumerate() {
            let (mut p, mut jacobian) = (vec![0.0; n], vec![0.0; n * d]);
            point_jacobian(&plan, Isa::best(), state, &mut p, &mut jacobian);
            let found = at[k * n..][..n].iter().chain(&by[k * n * d..][..n * d]);
            for (found, expected) in found.zip(p.iter().chain(&jacobian)) {
                prop_assert!((found - expected).abs() < 1e-12 * (1.0 + expected.abs()), "state {k}: {found}, {expected}");
            }
        }
    }

    /// The straight-line code of the built-in bodies does what the walk does, for any sizes and poses: points and gradients to 1e-12, on every instruction set.
    #[test]
    fn straight_line_code_is_the_walk(
        scale in 0.5..1.5,
        angles in prop::collection::vec(-3.0..3.0, 32),
        body in 0_usize..2,
    ) {
        let p = Proportions::default();
        let p = Proportions { thigh: scale * p.thigh, nose: p.nose.map(|x| scale * x), ..p };
        let tree = [standard::cf28(&p), standard::h32(&p)][body].clone();
        let straight = Plan::with_all_points(&tree);
        prop_assert!(straight.has_straight_line());
        let walk = straight.clone().without_straight_line();
        prop_assert!(!walk.has_straight_line());
        let block: Vec<Block> =
            (0..tree.dof()).map(|j| Block(std::array::from_fn(|lane| angles[j] * (1.0 - 0.1 * lane as f64)))).collect();
        for isa in Isa::available() {
            let run = |plan: &Plan| {
                let mut grad = vec![Block::ZERO; plan.dof()];
                dispatch(isa, Sweep(plan, &block, &mut grad));
                let mut out = vec![Block::ZERO; 3 * plan.points()];
                point_positions_block(plan, isa, &block, &mut out, &mut vec![Block::ZERO; plan.workspace()]);
                grad.into_iter().chain(out).flat_map(|b| b.0)
            };
            for (a, b) in run(&straight).zip(run(&walk)) {
                prop_assert!((a - b).abs() <= 1e-12 * b.abs().max(1.0), "{}: {a} and {b}", isa.name());
            }
        }
    }

    /// Curvature (K5): the Gauss–Newton matrix is `Σ Jᵀ M J` of the points' Jacobians, and so is its diagonal alone.
    #[test]
    fn gauss_newton_matrix_is_that_of_the_jacobian((tree, q) in tree_and_pose()) {
        let plan = Plan::with_all_points(&tree);
        let (d, n) = (plan.dof(), 3 * plan.points());
        let (mut p, mut jacobian) = (vec![0.0; n], vec![0.0; n * d]);
        point_jacobian(&plan, Isa::best(), &q, &mut p, &mut jacobian);
        let m = [[2.0, 0.5, -0.3], [0.5, 1.0, 0.1], [-0.3, 0.1, 3.0]];
        let block: Vec<Block> = q.iter().map(|&x| Block::splat(x)).collect();
        for isa in Isa::available() {
            let mut diagonal = vec![Block::ZERO; d];
            let mut matrix = vec![Block::ZERO; triangle(d, 0)];
            dispatch(isa, Diagonal(&plan, &block, &mut diagonal, &mut matrix));
            for i in 0..d {
                for j in 0..=i {
                    let at = |k: usize, a: usize, j: usize| jacobian[(3 * k + a) * d + j];
                    let expected: f64 = (0..plan.points())
                        .map(|k| {
                            let row = |a: usize| (0..3).map(|b| m[a][b] * at(k, b, j)).sum::<f64>();
                            (0..3).map(|a| at(k, a, i) * row(a)).sum::<f64>()
                        })
                        .sum();
                    let found = matrix[triangle(i, j)].0[5];
                    prop_assert!((found - expected).abs() < 1e-9 * (1.0 + expected.abs()), "{found} {expected}");
                    if i == j {
                        prop_assert!((diagonal[j].0[3] - expected).abs() < 1e-9 * (1.0 + expected));
                    }
                }
            }
        }
    }

    /// The block path gives each lane what the path of one state gives it, on every instruction set.
    #[test]
    fn block_agrees_with_single_states((tree, q) in tree_and_pose()) {
        let plan = Plan::with_all_points(&tree);
        let d = plan.dof();
        let mut block = vec![Block::ZERO; d];
        let states: Vec<Vec<f64>> = (0..LANES).map(|l| q.iter().map(|x| x * (1.0 - 0.1 * l as f64)).collect()).collect();
        for (lane, state) in states.iter().enumerate() {
            set_lane(&mut block, lane, state);
        }
        for isa in Isa::available() {
            let mut out = vec![Block::ZERO; 3 * plan.points()];
            point_positions_block(&plan, isa, &block, &mut out, &mut vec![Block::ZERO; plan.workspace()]);
            for (lane, state) in states.iter().enumerate() {
                let mut found = vec![0.0; out.len()];
                get_lane(&out, lane, &mut found);
                for (a, b) in found.iter().zip(positions(&plan, state)) {
                    prop_assert!((a - b).abs() < 1e-13);
                }
            }
        }
    }
}
