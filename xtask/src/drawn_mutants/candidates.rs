//! Where code can be made wrong without knowing what it means, as cargo-mutants does: other operators, answers that do not depend on what was asked, arms of a match that are missing, guards that always or never hold.

use std::collections::BTreeSet;
use std::ops::Range;
use syn::spanned::Spanned;
use syn::visit::{self, Visit};
use syn::{Attribute, BinOp, Block, Expr, ExprBinary, ExprMatch, ExprUnary, GenericArgument, Pat, PathArguments};
use syn::{ReturnType, Signature, Type, UnOp};

/// Stands in a replacement for the question whether this mutant is the one.
pub const SWITCH: &str = "\u{1}";

/// A change of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mutant {
    /// Path from the root.
    pub file: String,
    /// Line from 1.
    pub line: usize,
    /// What is replaced by what, and in which function.
    pub what: String,
    /// Bytes that are replaced; none where something is put in.
    pub place: Range<usize>,
    /// What stands there instead: the mutated code where [`SWITCH`] holds, and the code of today where it does not.
    pub instead: String,
}

/// All changes of a file; `defaults` are the types of ours that have a default.
pub fn find(file: &str, code: &str, defaults: &BTreeSet<String>) -> Vec<Mutant> {
    let Ok(syntax) = syn::parse_file(code) else { return vec![] };
    let mut finder = Finder { file, code, defaults, function: String::new(), found: vec![] };
    finder.visit_file(&syntax);
    finder.found
}

/// Names of the types in a file whose default is derived or written.
pub fn types_with_defaults(code: &str) -> BTreeSet<String> {
    #[derive(Default)]
    struct Names(BTreeSet<String>);
    impl Visit<'_> for Names {
        fn visit_item_struct(&mut self, item: &syn::ItemStruct) {
            if item.attrs.iter().any(derives_default) && item.generics.params.is_empty() {
                self.0.insert(item.ident.to_string());
            }
        }
        fn visit_item_impl(&mut self, item: &syn::ItemImpl) {
            let is_default = |path: &syn::Path| path.segments.last().is_some_and(|last| last.ident == "Default");
            if let (Some((path, _)), Type::Path(of)) = (&item.trait_, &*item.self_ty)
                && let (true, Some(last)) = (is_default(path), of.path.segments.last())
            {
                self.0.insert(last.ident.to_string());
            }
        }
    }
    let mut names = Names::default();
    if let Ok(syntax) = syn::parse_file(code) {
        names.visit_file(&syntax);
    }
    names.0
}

fn derives_default(attribute: &Attribute) -> bool {
    let tokens = || attribute.meta.require_list().map(|list| list.tokens.to_string()).unwrap_or_default();
    attribute.path().is_ident("derive") && tokens().split(',').any(|name| name.trim() == "Default")
}

struct Finder<'a> {
    file: &'a str,
    code: &'a str,
    defaults: &'a BTreeSet<String>,
    function: String,
    found: Vec<Mutant>,
}

impl Finder<'_> {
    fn text(&self, node: &impl Spanned) -> &str {
        &self.code[node.span().byte_range()]
    }

    fn push(&mut self, place: Range<usize>, what: String, instead: String) {
        let line = 1 + self.code[..place.start].matches('\n').count();
        let what = format!("{what} in {}", self.function);
        self.found.push(Mutant { file: self.file.into(), line, what, place, instead });
    }

    /// Instead of an expression another one, which may have the same parts.
    fn exchange(&mut self, expression: &impl Spanned, what: String, wrong: &str) {
        let (place, right) = (expression.span().byte_range(), self.text(expression));
        let instead = format!("(if {SWITCH} {{ {wrong} }} else {{ {right} }})");
        self.push(place, what, instead);
    }

    fn function(&mut self, signature: &Signature, block: &Block) {
        if signature.constness.is_some() || signature.ident == "main" {
            return;
        }
        let outside = std::mem::replace(&mut self.function, signature.ident.to_string());
        for value in self.answers(&signature.output) {
            let at = block.brace_token.span.open().byte_range().end;
            let what = format!("answer {value}");
            self.push(at..at, what, format!(" if {SWITCH} {{ return {value}; }} "));
        }
        self.visit_block(block);
        self.function = outside;
    }

    fn answers(&self, output: &ReturnType) -> Vec<String> {
        match output {
            ReturnType::Default => vec!["()".into()],
            ReturnType::Type(_, of) => self.values(of),
        }
    }

    /// Values that nobody has computed.
    fn values(&self, of: &Type) -> Vec<String> {
        let same = |values: &[&str]| values.iter().map(|value| (*value).to_owned()).collect();
        match of {
            Type::Reference(of) if of.mutability.is_none() => match &*of.elem {
                Type::Path(of) if of.path.is_ident("str") => same(&["\"\"", "\"xyzzy\""]),
                Type::Slice(_) => same(&["&[]"]),
                _ => vec![],
            },
            Type::Tuple(of) if of.elems.is_empty() => same(&["()"]),
            Type::Tuple(of) => {
                let parts: Vec<Vec<String>> = of.elems.iter().map(|part| self.values(part)).collect();
                if parts.iter().any(Vec::is_empty) {
                    return vec![];
                }
                let most = parts.iter().map(Vec::len).max().unwrap_or(0);
                let of_each = |k: usize| parts.iter().map(move |part| part[k.min(part.len() - 1)].clone());
                (0..most).map(|k| format!("({})", of_each(k).collect::<Vec<_>>().join(", "))).collect()
            }
            Type::Array(of) => {
                self.values(&of.elem).into_iter().map(|value| format!("std::array::from_fn(|_| {value})")).collect()
            }
            Type::Path(of) => self.values_of_named(of),
            _ => vec![],
        }
    }

    fn values_of_named(&self, of: &syn::TypePath) -> Vec<String> {
        let same = |values: &[&str]| values.iter().map(|value| (*value).to_owned()).collect();
        let Some(last) = of.path.segments.last() else { return vec![] };
        let inside = || match &last.arguments {
            PathArguments::AngleBracketed(inside) => match inside.args.first() {
                Some(GenericArgument::Type(first)) => self.values(first),
                _ => vec![],
            },
            _ => vec![],
        };
        let in_each = |name: &str| inside().into_iter().map(|value| format!("{name}({value})")).collect::<Vec<_>>();
        match last.ident.to_string().as_str() {
            "bool" => same(&["true", "false"]),
            "f64" | "f32" => same(&["0.0", "1.0", "-1.0"]),
            "usize" | "u64" | "u32" | "u16" | "u8" => same(&["0", "1"]),
            "isize" | "i64" | "i32" => same(&["0", "1", "-1"]),
            "String" => same(&["String::new()", "\"xyzzy\".to_owned()"]),
            "Vec" => {
                [vec!["vec![]".to_owned()], inside().iter().map(|value| format!("vec![{value}]")).collect()].concat()
            }
            "Option" => [vec!["None".to_owned()], in_each("Some")].concat(),
            "Result" => in_each("Ok"),
            "Box" => in_each("Box::new"),
            "BTreeMap" | "BTreeSet" | "HashMap" | "HashSet" | "PathBuf" | "Duration" => same(&["Default::default()"]),
            name if self.defaults.contains(name) => same(&["Default::default()"]),
            _ => vec![],
        }
    }
}

fn others(operator: &BinOp) -> &'static [&'static str] {
    match operator {
        BinOp::Eq(_) => &["!="],
        BinOp::Ne(_) => &["=="],
        BinOp::Lt(_) => &["==", ">", "<="],
        BinOp::Gt(_) => &["==", "<", ">="],
        BinOp::Le(_) => &[">"],
        BinOp::Ge(_) => &["<"],
        BinOp::And(_) => &["||"],
        BinOp::Or(_) => &["&&"],
        BinOp::Add(_) => &["-", "*"],
        BinOp::Sub(_) | BinOp::Mul(_) => &["+", "/"],
        BinOp::Div(_) => &["%", "*"],
        BinOp::Rem(_) => &["/", "+"],
        BinOp::Shl(_) => &[">>"],
        BinOp::Shr(_) => &["<<"],
        BinOp::BitAnd(_) => &["|", "^"],
        BinOp::BitOr(_) => &["&", "^"],
        BinOp::BitXor(_) => &["|", "&"],
        BinOp::AddAssign(_) => &["-=", "*="],
        BinOp::SubAssign(_) | BinOp::MulAssign(_) => &["+=", "/="],
        BinOp::DivAssign(_) => &["%=", "*="],
        _ => &[],
    }
}

/// Whether an expression binds by `let`, outside of which its parts mean nothing.
fn binds(expression: &Expr) -> bool {
    struct Lets(bool);
    impl Visit<'_> for Lets {
        fn visit_expr_let(&mut self, _: &syn::ExprLet) {
            self.0 = true;
        }
        fn visit_block(&mut self, _: &Block) {}
    }
    let mut lets = Lets(false);
    lets.visit_expr(expression);
    lets.0
}

fn is_for_tests(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| attribute.path().is_ident("cfg") || attribute.path().is_ident("test"))
}

impl<'ast> Visit<'ast> for Finder<'_> {
    fn visit_item_mod(&mut self, item: &'ast syn::ItemMod) {
        if !is_for_tests(&item.attrs) {
            visit::visit_item_mod(self, item);
        }
    }

    fn visit_item_impl(&mut self, item: &'ast syn::ItemImpl) {
        if !is_for_tests(&item.attrs) {
            visit::visit_item_impl(self, item);
        }
    }

    fn visit_item_fn(&mut self, item: &'ast syn::ItemFn) {
        if !is_for_tests(&item.attrs) {
            self.function(&item.sig, &item.block);
        }
    }

    fn visit_impl_item_fn(&mut self, item: &'ast syn::ImplItemFn) {
        if !is_for_tests(&item.attrs) {
            self.function(&item.sig, &item.block);
        }
    }

    fn visit_trait_item_fn(&mut self, item: &'ast syn::TraitItemFn) {
        if let Some(block) = &item.default {
            self.function(&item.sig, block);
        }
    }

    // What the compiler computes asks no switch.
    fn visit_item_const(&mut self, _: &'ast syn::ItemConst) {}
    fn visit_item_static(&mut self, _: &'ast syn::ItemStatic) {}
    fn visit_impl_item_const(&mut self, _: &'ast syn::ImplItemConst) {}
    fn visit_trait_item_const(&mut self, _: &'ast syn::TraitItemConst) {}
    fn visit_type(&mut self, _: &'ast Type) {}
    fn visit_variant(&mut self, _: &'ast syn::Variant) {}
    fn visit_pat(&mut self, pattern: &'ast Pat) {
        if let Pat::Guard(guarded) = pattern {
            self.visit_expr(&guarded.guard);
        }
    }
    fn visit_generic_argument(&mut self, _: &'ast GenericArgument) {}
    fn visit_expr_const(&mut self, _: &'ast syn::ExprConst) {}
    fn visit_expr_repeat(&mut self, repeated: &'ast syn::ExprRepeat) {
        self.visit_expr(&repeated.expr);
    }

    fn visit_expr_binary(&mut self, binary: &'ast ExprBinary) {
        if !binds(&binary.left) && !binds(&binary.right) {
            let [left, sign, right] =
                [self.text(&binary.left), self.text(&binary.op), self.text(&binary.right)].map(str::to_owned);
            for other in others(&binary.op) {
                self.exchange(binary, format!("{sign} → {other}"), &format!("{left} {other} {right}"));
            }
        }
        visit::visit_expr_binary(self, binary);
    }

    fn visit_expr_unary(&mut self, unary: &'ast ExprUnary) {
        if matches!(unary.op, UnOp::Neg(_) | UnOp::Not(_)) {
            let (sign, of) = (self.text(&unary.op).to_owned(), self.text(&unary.expr).to_owned());
            self.exchange(unary, format!("without {sign}"), &of);
        }
        visit::visit_expr_unary(self, unary);
    }

    fn visit_expr_match(&mut self, expression: &'ast ExprMatch) {
        let has_rest = expression.arms.last().is_some_and(|arm| matches!(arm.pat, Pat::Wild(_)));
        for (k, arm) in expression.arms.iter().enumerate() {
            let pattern = self.text(&arm.pat).to_owned();
            match &arm.pat {
                Pat::Guard(guarded) if !binds(&guarded.guard) => {
                    for holds in ["true", "false"] {
                        self.exchange(&*guarded.guard, format!("guard of {pattern} → {holds}"), holds);
                    }
                }
                Pat::Guard(_) => {}
                _ if has_rest && k + 1 < expression.arms.len() => {
                    let at = arm.pat.span().byte_range().end;
                    self.push(at..at, format!("without arm {pattern}"), format!(" if !{SWITCH}"));
                }
                _ => {}
            }
        }
        visit::visit_expr_match(self, expression);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn whats(code: &str) -> Vec<String> {
        find("x.rs", code, &types_with_defaults(code)).into_iter().map(|mutant| mutant.what).collect()
    }

    #[test]
    fn operators_answers_arms_and_guards_are_found() {
        let code = "fn f(a: f64) -> f64 { match a { 0.0 => -a, _ if a > 1.0 => 2.0, _ => a / 2.0 } }";
        let expected = [
            "answer 0.0",
            "answer 1.0",
            "answer -1.0",
            "without arm 0.0",
            "guard of _ if a > 1.0 → true",
            "guard of _ if a > 1.0 → false",
            "without -",
            "> → ==",
            "> → <",
            "> → >=",
            "/ → %",
            "/ → *",
        ];
        assert_eq!(whats(code), expected.map(|what| format!("{what} in f")));
    }

    #[test]
    fn constants_and_tests_have_no_candidates() {
        let code = "const A: f64 = 1.0 + 2.0; #[cfg(test)] mod tests { fn f() -> bool { 1 > 2 } } #[test] fn g() {}
            const fn h(a: usize) -> usize { a + 1 } static B: [u8; 1 + 2] = [0; 3];";
        assert_eq!(whats(code), [""; 0]);
        assert_eq!(
            whats("fn f(a: Option<u8>) { if let Some(b) = a && b > 0 { g(b) } }"),
            ["answer ()", "> → ==", "> → <", "> → >="].map(|what| format!("{what} in f"))
        );
    }

    #[test]
    fn answers_fit_what_is_asked_for() {
        let code = "#[derive(Default)] struct S; fn f() -> Result<(usize, Option<S>), T> {} fn g() -> T {} fn h() -> [bool; N] {}";
        let expected = [
            "answer Ok((0, None)) in f",
            "answer Ok((1, Some(Default::default()))) in f",
            "answer std::array::from_fn(|_| true) in h",
            "answer std::array::from_fn(|_| false) in h",
        ];
        assert_eq!(whats(code), expected);
    }
}
