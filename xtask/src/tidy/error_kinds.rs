//! Public enums of errors are `#[non_exhaustive]`, and whoever says what to do about them names every variant.
//!
//! The compiler demands a `_` arm of a match on such an enum in another crate, and would let that arm take what was added and forgotten.
//! A variant counts as named where a pattern without guard and without literal has it. One that holds another such enum is looked into, unless a pattern takes all that it holds.
//! The name of an enum is looked up in the crate that its path names last: `sinew::formats::Error` is of `sinew-formats`.

use super::modules::imports;
use super::workspace::{File, Violation, Workspace};
use crate::source::lines_with;
use std::collections::BTreeMap;
use syn::visit::{self, Visit};
use syn::{Attribute, Item, ItemEnum, Pat, Stmt, Visibility};

/// Where help and exit codes are said.
const SAID_IN: [&str; 2] = ["crates/sinew-words/src/", "crates/sinew-cli/src/study_words.rs"];

/// Enums by crate and name.
type Enums = BTreeMap<[String; 2], ItemEnum>;

/// Names in reach, with the paths that they stand for.
type Imports = BTreeMap<String, Vec<String>>;

/// Checks definitions in libraries and the matches of those who speak.
pub fn check(workspace: &Workspace) -> Vec<Violation> {
    let mut violations = Vec::new();
    let mut enums = Enums::new();
    for file in &workspace.files {
        let Some(library) = file.library().filter(|_| !lines_with(&file.product, "enum").is_empty()) else { continue };
        for item in public_enums(file) {
            if is_error(&item) && !is_open(&item) {
                let what = format!("errors grow in number; make `{}` `#[non_exhaustive]`", item.ident);
                violations.push(Violation::at(&file.path, item.ident.span().start().line, what));
            }
            enums.insert([library.to_owned(), item.ident.to_string()], item);
        }
    }
    for file in workspace.files.iter().filter(|file| SAID_IN.iter().any(|place| file.path.starts_with(place))) {
        let Some(syntax) = file.product_syntax() else { continue };
        let mut matches = Matches { file, enums: &enums, scopes: Vec::new(), violations: &mut violations };
        matches.visit_file(&syntax);
    }
    violations
}

fn public_enums(file: &File) -> impl Iterator<Item = ItemEnum> {
    file.product_syntax().into_iter().flat_map(|syntax| syntax.items).filter_map(|item| match item {
        Item::Enum(item) if matches!(item.vis, Visibility::Public(_)) => Some(item),
        _ => None,
    })
}

fn is_open(item: &ItemEnum) -> bool {
    item.attrs.iter().any(|attribute| attribute.path().is_ident("non_exhaustive"))
}

fn is_error(item: &ItemEnum) -> bool {
    let derives = |attribute: &Attribute| {
        let list = attribute.meta.require_list().ok().filter(|list| list.path.is_ident("derive"));
        list.is_some_and(|list| list.tokens.to_string().replace(' ', "").contains("thiserror::Error"))
    };
    item.ident.to_string().ends_with("Error") || item.attrs.iter().any(derives)
}

/// Reads the matches of a file.
struct Matches<'a> {
    file: &'a File,
    enums: &'a Enums,
    scopes: Vec<Imports>,
    violations: &'a mut Vec<Violation>,
}

impl Matches<'_> {
    /// What patterns of one value leave to a `_`.
    fn missing(&self, patterns: &[&Pat]) -> Vec<String> {
        let mut named: BTreeMap<Vec<String>, BTreeMap<String, Vec<&Pat>>> = BTreeMap::new();
        let each = patterns.iter().flat_map(|pattern| alternatives(pattern));
        for pattern in each.filter(|pattern| !has_literal(pattern)) {
            let (path, held) = match pattern {
                Pat::Path(unit) => (&unit.path, None),
                Pat::Struct(fields) => (&fields.path, None),
                Pat::TupleStruct(tuple) => (&tuple.path, tuple.elems.first().filter(|_| tuple.elems.len() == 1)),
                _ => continue,
            };
            let mut path: Vec<String> = path.segments.iter().map(|segment| segment.ident.to_string()).collect();
            let Some(variant) = path.pop() else { continue };
            named.entry(self.full(path)).or_default().entry(variant).or_default().extend(held);
        }
        let mut missing = Vec::new();
        for (path, named) in named {
            match self.definition(&path) {
                Some(item) if is_open(item) => {
                    let names = item.variants.iter().map(|variant| variant.ident.to_string());
                    let absent = names.filter(|name| !named.contains_key(name));
                    missing.extend(absent.map(|name| format!("`{}::{name}` is not named here", item.ident)));
                }
                None if self.is_ours(&path) => {
                    missing.push(format!("`{}` is not found; import it from its own crate", path.join("::")));
                }
                _ => continue,
            }
            for held in named.values() {
                let takes_all = |pattern: &&Pat| matches!(pattern, Pat::Wild(_) | Pat::Ident(_) | Pat::Rest(_));
                if !held.iter().flat_map(|pattern| alternatives(pattern)).any(|pattern| takes_all(&pattern)) {
                    missing.extend(self.missing(held));
                }
            }
        }
        missing
    }

    /// Whether a path begins with a crate of ours.
    fn is_ours(&self, path: &[String]) -> bool {
        path.first().is_some_and(|first| self.enums.keys().any(|[library, _]| *library == first.replace('_', "-")))
    }

    /// The path with its first name's import in place of it.
    fn full(&self, path: Vec<String>) -> Vec<String> {
        let first = path.first();
        let import = first.and_then(|first| self.scopes.iter().rev().find_map(|scope| scope.get(first)));
        import.map_or_else(|| path.clone(), |import| [import, &path[1..]].concat())
    }

    fn definition(&self, path: &[String]) -> Option<&ItemEnum> {
        let (name, crates) = path.split_last()?;
        let of = |library: String| self.enums.get(&[library, name.clone()]);
        crates.iter().rev().find_map(|part| {
            let part = part.replace('_', "-");
            of(format!("sinew-{part}")).or_else(|| of(part))
        })
    }
}

/// The patterns between `|`.
fn alternatives(pattern: &Pat) -> Vec<&Pat> {
    match pattern {
        Pat::Or(or) => or.cases.iter().flat_map(alternatives).collect(),
        Pat::Paren(inner) => alternatives(&inner.pat),
        Pat::Reference(inner) => alternatives(&inner.pat),
        other => vec![other],
    }
}

fn has_literal(pattern: &Pat) -> bool {
    struct Literals(bool);
    impl<'ast> Visit<'ast> for Literals {
        fn visit_lit(&mut self, _: &'ast syn::Lit) {
            self.0 = true;
        }
    }
    let mut literals = Literals(false);
    literals.visit_pat(pattern);
    literals.0
}

/// What the `use` lines among items bring, but for `*`.
fn imported<'a>(items: impl Iterator<Item = &'a Item>) -> Imports {
    let trees = items.filter_map(|item| if let Item::Use(item) = item { Some(&item.tree) } else { None });
    trees.flat_map(|tree| imports(tree, Vec::new())).filter_map(|(name, path)| Some((name?, path))).collect()
}

impl<'ast> Visit<'ast> for Matches<'_> {
    fn visit_file(&mut self, file: &'ast syn::File) {
        self.scopes.push(imported(file.items.iter()));
        visit::visit_file(self, file);
    }

    fn visit_block(&mut self, block: &'ast syn::Block) {
        let items = block.stmts.iter().filter_map(|line| if let Stmt::Item(item) = line { Some(item) } else { None });
        self.scopes.push(imported(items));
        visit::visit_block(self, block);
        self.scopes.pop();
    }

    fn visit_expr_match(&mut self, found: &'ast syn::ExprMatch) {
        let patterns: Vec<&Pat> = found.arms.iter().map(|arm| &arm.pat).collect();
        let line = found.match_token.span.start().line;
        let missing = self.missing(&patterns).into_iter();
        self.violations.extend(missing.map(|what| Violation::at(&self.file.path, line, what)));
        visit::visit_expr_match(self, found);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPEAKER: &str = "crates/sinew-words/src/x.rs";

    /// Variants that a match in the body of a function leaves out.
    fn missing(body: &str) -> Vec<String> {
        let files = [
            ("crates/sinew/src/error.rs", "#[non_exhaustive]\npub enum Error { A, B { b: u8 }, C(AbError) }"),
            ("crates/sinew-a-b/src/e.rs", "#[non_exhaustive]\npub enum AbError { D, E(u8) }\npub enum Closed { F, G }"),
            ("crates/sinew-a-b/src/f.rs", "enum Error { Private }"),
            (SPEAKER, &format!("use sinew::Error;\nuse sinew_a_b::{{Closed, e::AbError}};\nfn f() {{ {body} }}")),
        ];
        let files = files.into_iter().map(|(path, text)| File::new(path, text)).collect();
        let found = check(&Workspace { top: Vec::new(), files });
        assert!(found.iter().all(|violation| (violation.path.as_str(), violation.line) == (SPEAKER, Some(3))));
        found.iter().map(|violation| violation.what.split('`').nth(1).unwrap().to_owned()).collect()
    }

    #[test]
    fn a_forgotten_variant_is_caught() {
        assert_eq!(missing("match x { Error::A => 1, Error::B { .. } => 2, _ => 0 }"), ["Error::C"]);
        assert_eq!(missing("match x { Error::A | Error::B { .. } => 1, Error::C(_) | _ => 0 }"), [""; 0]);
        assert_eq!(missing("match x { AbError::D => 1, other => g(other) }"), ["AbError::E"]);
        assert_eq!(missing("match x { &sinew::a_b::AbError::D => 1, _ => 0 }"), ["AbError::E"]);
        assert_eq!(missing("match x { Closed::F => 1, _ => 0 }"), [""; 0]);
    }

    #[test]
    fn a_pattern_that_takes_some_values_of_a_variant_does_not_name_it() {
        let named = "Error::A => 1, Error::C(_) => 2";
        for some in ["Error::B { b: 1 }", "Error::B { .. } if g()"] {
            assert_eq!(missing(&format!("match x {{ {some} => 3, {named}, _ => 0 }}")), ["Error::B"]);
            assert_eq!(
                missing(&format!("match x {{ {some} => 3, Error::B {{ .. }} => 4, {named}, _ => 0 }}")),
                [""; 0]
            );
        }
    }

    #[test]
    fn errors_within_errors_are_checked() {
        let of = |held: &str| missing(&format!("match x {{ Error::A | Error::B {{ .. }} => 1, {held}, _ => 0 }}"));
        assert_eq!(of("Error::C(AbError::D) => 2"), ["AbError::E"]);
        assert_eq!(of("Error::C(AbError::D) => 2, Error::C(AbError::E(_)) => 3"), [""; 0]);
        assert_eq!(of("Error::C(AbError::D) => 2, Error::C(_) => 3"), [""; 0]);
        assert_eq!(of("Error::C(inner) => match inner { AbError::E(_) => 2, _ => 3 }"), ["AbError::D"]);
    }

    #[test]
    fn imports_of_a_function_come_first() {
        assert_eq!(missing("use sinew_a_b::AbError as Error; match x { Error::D => 1, _ => 0 }"), ["AbError::E"]);
    }

    #[test]
    fn an_enum_that_is_not_where_its_path_says_is_caught() {
        assert_eq!(missing("match x { sinew::AbError::D => 1, _ => 0 }"), ["sinew::AbError"]);
        assert_eq!(missing("match x { std::io::ErrorKind::NotFound => 1, _ => 0 }"), [""; 0]);
    }

    #[test]
    fn errors_that_are_closed_to_growth_are_caught() {
        let path = "crates/sinew-setup/src/x.rs";
        for bad in ["pub enum AError { A }", "#[derive(Debug, thiserror::Error)]\npub enum Problem { A }"] {
            super::super::planted::check(check, path, bad, &bad.replace("pub enum", "#[non_exhaustive]\npub enum"));
        }
        for other in ["pub enum A { B }", "pub(crate) enum AError { A }"] {
            assert_eq!(super::super::planted::violations(check, path, other), []);
        }
    }
}
