//! One file of a crate, read token by token into its modules.

use super::tree::{Kind, Meaning, Mention, Module, Tree};
use crate::tidy::tokens::{Token, behind_bracket, tokens};

/// Keywords before the name of an item.
const ITEMS: [&str; 8] = ["struct", "enum", "union", "trait", "type", "fn", "const", "static"];

/// A child module that has a file: the module that declares it, its name, and the folders of inline modules between.
pub type Child = (usize, String, String);

/// Reads the code of a file into a module and its inline modules; returns the children in files.
pub fn read(tree: &mut Tree, module: usize, code: &str) -> Vec<Child> {
    let tokens = tokens(code);
    let open = vec![Open { module, depth: 0, folder: String::new() }];
    Reader { tree, tokens: &tokens, open, depth: 0, exports_macro: false, children: Vec::new() }.read()
}

/// A module whose braces are open.
struct Open {
    module: usize,
    /// Braces open inside the file where the module's own items stand.
    depth: usize,
    folder: String,
}

struct Reader<'a> {
    tree: &'a mut Tree,
    tokens: &'a [Token<'a>],
    open: Vec<Open>,
    /// Braces that are open.
    depth: usize,
    /// Whether `#[macro_export]` stands before what comes.
    exports_macro: bool,
    children: Vec<Child>,
}

impl Reader<'_> {
    fn text(&self, i: usize) -> &str {
        self.tokens.get(i).map_or("", |token| token.text)
    }

    fn module(&mut self) -> &mut Module {
        let number = self.open.last().map_or(0, |open| open.module);
        &mut self.tree.modules[number]
    }

    fn define(&mut self, name: &str) {
        let meanings = self.module().names.entry(name.to_owned()).or_default();
        if !meanings.contains(&Meaning::Item) {
            meanings.push(Meaning::Item);
        }
    }

    /// Reads all tokens.
    fn read(mut self) -> Vec<Child> {
        let mut i = 0;
        while i < self.tokens.len() {
            i = self.step(i);
        }
        self.children
    }

    /// Reads what begins at a token; returns the position behind it.
    fn step(&mut self, i: usize) -> usize {
        let at_top = self.open.last().is_some_and(|open| open.depth == self.depth);
        let (this, next) = (self.text(i), self.text(i + 1));
        match (this, next) {
            ("#", "[") => {
                self.exports_macro |= self.text(i + 2) == "macro_export";
                behind_bracket(self.tokens, i + 1)
            }
            ("{", _) => {
                self.depth += 1;
                i + 1
            }
            ("}", _) => {
                self.close();
                i + 1
            }
            ("pub", "(") => {
                let behind = behind_bracket(self.tokens, i + 1);
                if self.text(behind) == "use" { self.import(behind + 1, Kind::Export) } else { behind }
            }
            ("pub", "use") => self.import(i + 2, Kind::Export),
            ("use", _) => self.import(i + 1, Kind::Import),
            ("mod", _) if at_top => self.child(i),
            ("macro_rules", "!") => self.own_macro(i + 2),
            (keyword, name) if at_top && ITEMS.contains(&keyword) && !ITEMS.contains(&name) => {
                let name = name.to_owned();
                self.define(&name);
                i + 2
            }
            _ if self.tokens[i].is_word() => self.path(i),
            _ => i + 1,
        }
    }

    fn close(&mut self) {
        self.depth = self.depth.saturating_sub(1);
        if self.open.len() > 1 && self.open.last().is_some_and(|open| open.depth > self.depth) {
            self.open.pop();
        }
    }

    /// Reads `mod name` and what opens or ends it.
    fn child(&mut self, start: usize) -> usize {
        let name = self.text(start + 1).to_owned();
        if self.text(start + 2) == "{" {
            self.depth += 1;
            self.open_inline(&name);
        } else if let Some(open) = self.open.last() {
            self.children.push((open.module, name, open.folder.clone()));
        }
        start + 3
    }

    fn own_macro(&mut self, at: usize) -> usize {
        let name = self.text(at).to_owned();
        self.define(&name);
        if self.exports_macro && self.open.last().is_some_and(|open| open.module != 0) {
            self.export_macro(name);
        }
        self.exports_macro = false;
        at + 1
    }

    fn open_inline(&mut self, name: &str) {
        let Some(around) = self.open.last() else { return };
        let (parent, folder) = (around.module, format!("{}{name}/", around.folder));
        let inline = Module { file: self.tree.modules[parent].file, parent: Some(parent), ..Module::default() };
        let module = self.tree.add(inline, parent, name);
        self.open.push(Open { module, depth: self.depth, folder });
    }

    /// An exported macro is an item of the root, defined elsewhere.
    fn export_macro(&mut self, name: String) {
        let mut path = vec![name.clone()];
        let mut at = self.open.last().map_or(0, |open| open.module);
        while let Some(parent) = self.tree.modules[at].parent {
            let names = &self.tree.modules[parent].names;
            let own = names.iter().find(|(_, meanings)| meanings.contains(&Meaning::Module(at)));
            path.extend(own.map(|(name, _)| name.clone()));
            at = parent;
        }
        path.push("crate".into());
        path.reverse();
        self.tree.modules[0].names.entry(name).or_default().push(Meaning::Alias(path));
    }

    /// Reads a path in code from its first word on; returns the position behind it.
    fn path(&mut self, start: usize) -> usize {
        let before = if start == 0 { "" } else { self.text(start - 1) };
        let mut path = vec![self.text(start).to_owned()];
        let mut i = start + 1;
        while self.text(i) == "::" && self.tokens.get(i + 1).is_some_and(Token::is_word) {
            path.push(self.text(i + 1).to_owned());
            i += 2;
        }
        let line = self.tokens[start].line;
        if matches!(before, "." | "::") {
            return i;
        }
        if path.len() > 1 {
            self.module().mentions.push(Mention { path, line, kind: Kind::Code });
        } else {
            self.module().words.entry(path.remove(0)).or_insert(line);
        }
        i
    }

    /// Reads what follows the word `use`; returns the position behind its semicolon.
    fn import(&mut self, start: usize, kind: Kind) -> usize {
        let end = (start..self.tokens.len()).find(|&i| self.text(i) == ";").unwrap_or(self.tokens.len());
        // `use<'a>` in a bound is no import.
        if self.text(start) != "<" {
            self.branch(start, end, &[], kind);
            return end + 1;
        }
        start
    }

    /// Reads one branch of a tree of imports; returns the position behind it.
    fn branch(&mut self, start: usize, end: usize, prefix: &[String], kind: Kind) -> usize {
        let mut path = prefix.to_vec();
        let line = self.tokens.get(start).map_or(0, |token| token.line);
        let mut i = start;
        while i < end {
            match self.text(i) {
                "{" => {
                    i += 1;
                    while i < end && self.text(i) != "}" {
                        i = self.branch(i, end, &path, kind);
                        i += usize::from(self.text(i) == ",");
                    }
                    return i + 1;
                }
                "*" => {
                    self.module().globs.push(path.clone());
                    self.module().mentions.push(Mention { path, line, kind });
                    return i + 1;
                }
                "," | "}" => break,
                "::" => i += 1,
                "as" => {
                    let name = self.text(i + 1).to_owned();
                    self.leaf(path, Some(name), line, kind);
                    return i + 2;
                }
                "self" if !path.is_empty() => i += 1,
                word => {
                    path.push(word.to_owned());
                    i += 1;
                }
            }
        }
        self.leaf(path, None, line, kind);
        i
    }

    fn leaf(&mut self, path: Vec<String>, name: Option<String>, line: usize, kind: Kind) {
        let Some(name) = name.or_else(|| path.last().cloned()) else { return };
        self.module().names.entry(name).or_default().push(Meaning::Alias(path.clone()));
        self.module().mentions.push(Mention { path, line, kind });
    }
}

#[cfg(test)]
mod tests {
    use super::super::made_up;
    use super::*;

    fn words(path: &str) -> Vec<String> {
        path.split("::").map(str::to_owned).collect()
    }

    #[test]
    fn imports_are_taken_apart() {
        let tree = made_up::tree(&[("lib.rs", "use a::{self as x, b::{C, D as E}, f::*}; pub(crate) use g::{self};")]);
        let names = &tree.modules[0].names;
        for (name, path) in [("x", "a"), ("C", "a::b::C"), ("E", "a::b::D"), ("g", "g")] {
            assert_eq!(names[name], [Meaning::Alias(words(path))], "{name}");
        }
        assert_eq!(names.len(), 4);
        assert_eq!(tree.modules[0].globs, [words("a::f")]);
        let kinds: Vec<Kind> = tree.modules[0].mentions.iter().map(|mention| mention.kind).collect();
        assert_eq!(kinds, [Kind::Import, Kind::Import, Kind::Import, Kind::Import, Kind::Export]);
    }

    #[test]
    fn items_of_the_module_are_names_and_local_ones_are_not() {
        let text = "pub struct A { b: C }\nimpl A { const D: u8 = 1; fn e() { fn f() {} } }\nconst fn g() {}\nmacro_rules! h { () => {} }";
        let tree = made_up::tree(&[("lib.rs", text)]);
        assert_eq!(tree.modules[0].names.keys().collect::<Vec<_>>(), ["A", "g", "h"]);
    }

    #[test]
    fn paths_in_code_are_mentioned_wherever_they_stand() {
        let text = "pub(in crate::a) fn f(x: &crate::a::B) -> c::D { x.e::<u8>(); vec![super::f::g(1)] }\n#[crate::h::i]\nstruct S;";
        let tree = made_up::tree(&[("lib.rs", text)]);
        let found: Vec<String> = tree.modules[0].mentions.iter().map(|mention| mention.path.join("::")).collect();
        assert_eq!(found, ["crate::a::B", "c::D", "super::f::g"]);
    }

    #[test]
    fn inline_modules_have_names_of_their_own() {
        let tree = made_up::tree(&[("lib.rs", "mod a { use b::C; fn f() {} }\nfn g() { super::x() }")]);
        assert_eq!(tree.modules[1].names.keys().collect::<Vec<_>>(), ["C", "f"]);
        assert_eq!(tree.modules[0].names.keys().collect::<Vec<_>>(), ["a", "g"]);
        assert_eq!(tree.modules[0].mentions.len(), 1);
    }

    #[test]
    fn exported_macros_are_items_of_the_root() {
        let tree = made_up::tree(&[("lib.rs", "mod a;"), ("a.rs", "#[macro_export]\nmacro_rules! m { () => {} }")]);
        assert_eq!(tree.modules[0].names["m"], [Meaning::Alias(words("crate::a::m"))]);
    }
}
