//! Source code of straight-line kinematics: a function per body, without loops, branches or frames in memory.
//!
//! The order is that of a depth-first walk: a link's frame, the links below it, its points, then its part of the gradient, so that what belongs together stays near. Products with components that are
//! known to be zero or one (the root's frame, offsets along an axis) are not written at all.

use crate::structure::structure;
use crate::tree::{Joint, KinematicTree};
use std::fmt::Write;

/// A number of the generated code: known, or in a variable.
#[derive(Clone, Debug)]
enum Term {
    Zero,
    One,
    Var(String),
    /// The negative of a variable.
    Minus(String),
}
use Term::{Minus, One, Var, Zero};

type Vector = [Term; 3];

fn negative(x: &Term) -> Term {
    match x {
        Zero => Zero,
        Var(name) => Minus(name.clone()),
        Minus(name) => Var(name.clone()),
        One => Minus("V::splat(1.0)".into()),
    }
}

/// A frame: the columns of its rotation and its origin.
#[derive(Clone)]
struct Frame {
    columns: [Vector; 3],
    origin: Vector,
}

/// Force and moment.
struct Wrench {
    force: Vector,
    moment: Vector,
}

struct Writer<'a> {
    tree: &'a KinematicTree,
    /// The plan's index of each of the tree's points.
    place: Vec<usize>,
    /// First rotation among the degrees of freedom.
    turning: usize,
    gradient: bool,
    variables: usize,
    text: String,
}

/// The whole file.
pub fn source(bodies: &[(&str, KinematicTree)]) -> String {
    let mut text = String::from(
        "/// Bodies with code of their own.\n#[derive(Clone, Copy, Debug, PartialEq, Eq)]\npub enum Body {\n",
    );
    for (name, _) in bodies {
        let _ = writeln!(text, "    #[allow(missing_docs)]\n    {},", variant(name));
    }
    text += "}\n\nimpl Body {\n    /// Every body with its structure.\n    const ALL: &[(Self, &'static str)] = &[\n";
    for (name, tree) in bodies {
        let all: Vec<usize> = (0..tree.points().len()).collect();
        let _ = writeln!(text, "        (Self::{}, {:?}),", variant(name), structure(tree, &all));
    }
    text += "    ];\n";
    text += &choice(bodies, false);
    text += &choice(bodies, true);
    text += "}\n";
    for (name, tree) in bodies {
        for gradient in [false, true] {
            text += &function(name, tree, gradient);
        }
    }
    text
}

fn variant(name: &str) -> String {
    name[..1].to_uppercase() + &name[1..]
}

/// The method that goes to the function of a body.
fn choice(bodies: &[(&str, KinematicTree)], gradient: bool) -> String {
    let (suffix, argument, passed) =
        if gradient { ("sweep", "\n        grad: &mut [V::Mem],", "whole_mut(grad), ") } else { ("positions", "", "") };
    let mut text = format!(
        "
    #[inline(always)]
    pub(super) fn {suffix}<V: Real, W: Visit<V>>(
        self,
        q: &[V::Mem],
        links: &[[f64; 3]],
        points: &[[f64; 3]],
        ws: &mut [V::Mem],{argument}
        visitor: &mut W,
    ) {{
        let turns = ws.as_chunks_mut().0;
        match self {{
"
    );
    for (name, _) in bodies {
        let _ = writeln!(
            text,
            "            Self::{} => {name}_{suffix}(whole(q), whole(links), whole(points), whole_mut(turns), {passed}visitor),",
            variant(name)
        );
    }
    text + "        }\n    }\n"
}

fn function(name: &str, tree: &KinematicTree, gradient: bool) -> String {
    let turning = tree.joints().take_while(|(_, joint)| matches!(joint, Joint::Translate(_))).count();
    assert!(
        tree.joints().skip(turning).all(|(_, joint)| matches!(joint, Joint::Rotate(_))),
        "{name}: rotations follow one another"
    );
    assert!(
        tree.links().iter().all(|link| link.rest.is_none() && link.joints.iter().all(|j| j.axis().index().is_some())),
        "{name}: axes are coordinate axes of the world in the zero pose"
    );
    let mut place = vec![0; tree.points().len()];
    let mut next = 0;
    for link in 0..tree.links().len() {
        for (k, point) in tree.points().iter().enumerate() {
            if point.link == link {
                place[k] = next;
                next += 1;
            }
        }
    }
    let mut writer = Writer { tree, place, turning, gradient, variables: 0, text: String::new() };
    writer.root();
    let (links, points, dof) = (tree.links().len(), tree.points().len(), tree.dof());
    let (suffix, argument) =
        if gradient { ("sweep", format!("\n    grad: &mut [V::Mem; {dof}],")) } else { ("positions", String::new()) };
    format!(
        "
#[inline(always)]
#[allow(clippy::too_many_lines, unused_variables)]
fn {name}_{suffix}<V: Real, W: Visit<V>>(
    q: &[V::Mem; {dof}],
    links: &[[f64; 3]; {links}],
    points: &[[f64; 3]; {points}],
    turns: &mut [[V::Mem; 2]; {turns}],{argument}
    visitor: &mut W,
) {{
    for (turn, q) in turns.iter_mut().zip(&q[{turning}..]) {{
        let (sin, cos) = sin_cos(V::load(q));
        sin.store(&mut turn[0]);
        cos.store(&mut turn[1]);
    }}
{body}}}
",
        turns = dof - turning,
        body = writer.text,
    )
}

impl Writer<'_> {
    fn root(&mut self) {
        let unit = |k: usize| std::array::from_fn(|i| if i == k { One } else { Zero });
        let world = Frame { columns: [unit(0), unit(1), unit(2)], origin: [Zero, Zero, Zero] };
        for (index, link) in self.tree.links().iter().enumerate() {
            if link.parent.is_none() {
                self.link(index, &world);
            }
        }
    }

    /// Writes a link and all below it.
    fn link(&mut self, index: usize, parent: &Frame) -> Wrench {
        let tree = self.tree;
        let link = &tree.links()[index];
        let origin = self.moved(parent, &link.offset, &format!("links[{index}]"));
        let mut frame = Frame { columns: parent.columns.clone(), origin };
        let mut axes = vec![];
        for (j, joint) in (tree.first_dof(index)..).zip(&link.joints) {
            let index = joint.axis().index().unwrap_or_default();
            match joint {
                Joint::Translate(_) => {
                    let axis = frame.columns[index].clone();
                    let x = self.variable(&format!("V::load(&q[{j}])"));
                    frame.origin = self.each(|w, k| w.sum(&[(&x, &axis[k])], &frame.origin[k]));
                    axes.push(axis);
                }
                Joint::Rotate(_) => {
                    let turn = j - self.turning;
                    let sin = self.variable(&format!("V::load(&turns[{turn}][0])"));
                    let cos = self.variable(&format!("V::load(&turns[{turn}][1])"));
                    let (a, b) = ((index + 1) % 3, (index + 2) % 3);
                    let (from, to) = (frame.columns[a].clone(), frame.columns[b].clone());
                    frame.columns[a] = self.each(|w, k| w.sum(&[(&cos, &from[k]), (&sin, &to[k])], &Zero));
                    let back = negative(&sin);
                    frame.columns[b] = self.each(|w, k| w.sum(&[(&cos, &to[k]), (&back, &from[k])], &Zero));
                    axes.push(frame.columns[index].clone());
                }
            }
        }
        let mut wrench = Wrench { force: [Zero, Zero, Zero], moment: [Zero, Zero, Zero] };
        for (child, below) in tree.links().iter().enumerate() {
            if below.parent == Some(index) {
                let Wrench { force, moment } = self.link(child, &frame);
                wrench.force = self.each(|w, k| w.plus(&force[k], &wrench.force[k]));
                wrench.moment = self.each(|w, k| w.plus(&moment[k], &wrench.moment[k]));
            }
        }
        for (point, p) in tree.points().iter().enumerate().filter(|(_, p)| p.link == index) {
            self.point(self.place[point], &frame, &p.offset, &mut wrench);
        }
        if self.gradient {
            self.gradient(index, &frame.origin, &axes, &wrench);
        }
        wrench
    }

    /// Writes a call of the visitor, and what it adds to force and moment.
    fn point(&mut self, k: usize, frame: &Frame, offset: &[f64; 3], wrench: &mut Wrench) {
        let position = self.moved(frame, offset, &format!("points[{k}]"));
        let place = position.each_ref().map(Self::value).join(", ");
        if !self.gradient {
            let _ = writeln!(self.text, "    visitor.point({k}, [{place}]);");
            return;
        }
        let _ = writeln!(self.text, "    let [g{k}x, g{k}y, g{k}z] = visitor.point({k}, [{place}]);");
        let g = ["x", "y", "z"].map(|c| Var(format!("g{k}{c}")));
        wrench.force = self.each(|w, i| w.plus(&g[i], &wrench.force[i]));
        wrench.moment = self.crossed(&position, &g, &wrench.moment);
    }

    /// Writes a link's part of the gradient: forces along its translations, moments about its rotations.
    fn gradient(&mut self, index: usize, origin: &Vector, axes: &[Vector], wrench: &Wrench) {
        let first = self.tree.first_dof(index);
        let about = self.crossed(&origin.each_ref().map(negative), &wrench.force, &wrench.moment);
        for ((j, joint), axis) in (first..).zip(&self.tree.links()[index].joints).zip(axes) {
            let along = match joint {
                Joint::Translate(_) => &wrench.force,
                Joint::Rotate(_) => &about,
            };
            let slope = self.sum(&[(&axis[0], &along[0]), (&axis[1], &along[1]), (&axis[2], &along[2])], &Zero);
            let _ = writeln!(self.text, "    {}.store(&mut grad[{j}]);", Self::value(&slope));
        }
    }

    /// Origin of a frame plus its rotation times an offset, which stands in the code as `name`.
    fn moved(&mut self, frame: &Frame, offset: &[f64; 3], name: &str) -> Vector {
        let mut place = frame.origin.clone();
        for (i, column) in frame.columns.iter().enumerate().filter(|(i, _)| offset[*i] != 0.0) {
            let x = self.variable(&format!("V::splat({name}[{i}])"));
            place = self.each(|w, k| w.sum(&[(&x, &column[k])], &place[k]));
        }
        place
    }

    /// `c + a × b`.
    fn crossed(&mut self, a: &Vector, b: &Vector, c: &Vector) -> Vector {
        self.each(|w, k| {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            w.sum(&[(&a[i], &b[j]), (&negative(&a[j]), &b[i])], &c[k])
        })
    }

    fn each(&mut self, mut component: impl FnMut(&mut Self, usize) -> Term) -> Vector {
        [component(self, 0), component(self, 1), component(self, 2)]
    }

    /// The sum of products and of one more term.
    fn sum(&mut self, products: &[(&Term, &Term)], plus: &Term) -> Term {
        products.iter().fold(plus.clone(), |sum, (a, b)| self.fused(a, b, &sum))
    }

    /// `a · b + c`, with the least that must be computed.
    fn fused(&mut self, a: &Term, b: &Term, c: &Term) -> Term {
        let (a, b, negated) = match (a, b) {
            (Zero, _) | (_, Zero) => return c.clone(),
            (One, x) | (x, One) => return self.plus(x, c),
            (Var(a), Var(b)) | (Minus(a), Minus(b)) => (a, b, false),
            (Var(a), Minus(b)) | (Minus(a), Var(b)) => (a, b, true),
        };
        match (c, negated) {
            (Zero, false) => self.variable(&format!("{a} * {b}")),
            (Zero, true) => negative(&self.variable(&format!("{a} * {b}"))),
            (Minus(c), false) => negative(&self.variable(&format!("{a}.fnma({b}, {c})"))),
            (Minus(c), true) => negative(&self.variable(&format!("{a}.fma({b}, {c})"))),
            (c, false) => self.variable(&format!("{a}.fma({b}, {})", Self::value(c))),
            (c, true) => self.variable(&format!("{a}.fnma({b}, {})", Self::value(c))),
        }
    }

    fn plus(&mut self, a: &Term, b: &Term) -> Term {
        match (a, b) {
            (Zero, x) | (x, Zero) => x.clone(),
            (Minus(a), Minus(b)) => negative(&self.variable(&format!("{a} + {b}"))),
            (Minus(a), b) | (b, Minus(a)) => self.variable(&format!("{} - {a}", Self::value(b))),
            (a, b) => self.variable(&format!("{} + {}", Self::value(a), Self::value(b))),
        }
    }

    fn variable(&mut self, value: &str) -> Term {
        let name = format!("v{}", self.variables);
        self.variables += 1;
        let _ = writeln!(self.text, "    let {name} = {value};");
        Var(name)
    }

    fn value(x: &Term) -> String {
        match x {
            Zero => "V::splat(0.0)".into(),
            One => "V::splat(1.0)".into(),
            Var(name) => name.clone(),
            Minus(name) => format!("(-{name})"),
        }
    }
}
