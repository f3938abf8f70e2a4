//! The files of a crate have no circular dependencies.
//!
//! A file depends on each file whose items it names by a path, in `use` declarations and in expressions.
//! Paths are resolved through modules, imports and re-exports to the file that defines the item. Declarations
//! `mod x;`, re-exports that the file itself does not use, and items under `#[cfg(test)]` are ignored. Method
//! calls, which do not name a file, are not detected.

use proc_macro2::{Delimiter, TokenStream, TokenTree};
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::path::Path;

/// The crates whose files are checked.
const CRATES: [&str; 6] = ["cli", "geom", "integrator", "io", "material", "scenes"];

#[test]
fn no_file_imports_its_importer() {
    for name in CRATES {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates").join(name).join("src");
        let circles = Sources::read(&|file| std::fs::read_to_string(folder.join(file)).ok()).circles();
        assert!(circles.is_empty(), "crates/{name}/src has circles:\n{}", circles.join("\n"));
    }
}

/// A module; one written inline shares its file with its parent.
#[derive(Debug, Default)]
struct Module {
    file: String,
    parent: usize,
    children: BTreeMap<String, usize>,
    imports: Vec<Import>,
    /// Paths of two names or more in the code, imports aside.
    paths: Vec<Vec<String>>,
    /// All names in the code, imports aside.
    names: BTreeSet<String>,
}

/// A leaf of a `use` declaration.
#[derive(Debug)]
struct Import {
    path: Vec<String>,
    name: String,
    is_public: bool,
}

/// The modules of a crate; the first is its root.
struct Sources<'a> {
    modules: Vec<Module>,
    /// Returns the content of a file, given its path from the folder of `lib.rs`; `None` if there is none.
    text: &'a dyn Fn(&str) -> Option<String>,
}

impl<'a> Sources<'a> {
    /// Parses the crate of these files.
    fn read(text: &'a dyn Fn(&str) -> Option<String>) -> Self {
        let mut this = Self { modules: Vec::new(), text };
        this.add_file("lib.rs".to_owned(), "", 0);
        this
    }

    /// Adds the module in `file`, whose children lie in `folder`, and returns its index.
    fn add_file(&mut self, file: String, folder: &str, parent: usize) -> usize {
        let source = (self.text)(&file).unwrap_or_else(|| panic!("{file} cannot be read"));
        let tokens: TokenStream = source.parse().unwrap_or_else(|error| panic!("{file}: {error}"));
        let index = self.modules.len();
        self.modules.push(Module { file, parent, ..Module::default() });
        self.add_tokens(index, tokens, folder);
        index
    }

    fn add_tokens(&mut self, module: usize, tokens: TokenStream, folder: &str) {
        let tokens: Vec<TokenTree> = tokens.into_iter().collect();
        let (mut at, mut is_public) = (0, false);
        while let Some(token) = tokens.get(at) {
            at += 1;
            match (token, tokens.get(at)) {
                (TokenTree::Punct(hash), Some(TokenTree::Group(attribute))) if hash.as_char() == '#' => {
                    at += 1;
                    if attribute.stream().to_string().replace(' ', "") == "cfg(test)" {
                        at += item_length(&tokens[at..]);
                    }
                }
                (TokenTree::Ident(word), Some(TokenTree::Ident(name))) if word == "mod" => {
                    at += 2;
                    let (name, parent) = (name.to_string(), module);
                    let inner = format!("{folder}{name}/");
                    let child = match tokens.get(at - 1) {
                        Some(TokenTree::Group(body)) => {
                            let index = self.modules.len();
                            let file = self.modules[module].file.clone();
                            self.modules.push(Module { file, parent, ..Module::default() });
                            self.add_tokens(index, body.stream(), &inner);
                            index
                        }
                        _ => {
                            let flat = format!("{folder}{name}.rs");
                            let file =
                                if (self.text)(&flat).is_some() { flat } else { format!("{inner}mod.rs") };
                            self.add_file(file, &inner, parent)
                        }
                    };
                    self.modules[module].children.insert(name, child);
                }
                (TokenTree::Ident(word), _) if word == "use" => {
                    let end = at - 1 + item_length(&tokens[at - 1..]);
                    add_leaves(&tokens[at..end - 1], &[], is_public, &mut self.modules[module].imports);
                    at = end;
                }
                (TokenTree::Ident(word), _) => {
                    let mut path = vec![word.to_string()];
                    while let Some(next) = name_after_colons(&tokens[at..]) {
                        path.push(next);
                        at += 3;
                    }
                    self.modules[module].names.extend(path.iter().cloned());
                    if path.len() > 1 {
                        self.modules[module].paths.push(path);
                    }
                }
                (TokenTree::Group(group), _) => self.add_tokens(module, group.stream(), folder),
                _ => {}
            }
            // As in `pub use` and `pub(crate) use`.
            is_public = matches!(token, TokenTree::Ident(word) if word == "pub")
                || is_public && is_group(token, Delimiter::Parenthesis);
        }
    }

    /// The module that defines the item `path` as named in `module`; `None` if it belongs to another crate.
    fn resolve(&self, module: usize, path: &[String], through_imports: bool) -> Option<usize> {
        let first = path.first()?;
        match first.as_str() {
            "crate" => self.descend(0, &path[1..]),
            "self" => self.descend(module, &path[1..]),
            "super" => {
                let mut at = (self.modules[module].parent, &path[1..]);
                while let Some((_, rest)) = at.1.split_first().filter(|(next, _)| *next == "super") {
                    at = (self.modules[at.0].parent, rest);
                }
                self.descend(at.0, at.1)
            }
            name => {
                let Module { children, imports, .. } = &self.modules[module];
                let is_known = children.contains_key(name)
                    || through_imports && imports.iter().any(|import| import.name == *name);
                is_known.then(|| self.descend(module, path))?
            }
        }
    }

    /// The module that defines the item `path`, whose first name belongs to `module`.
    fn descend(&self, module: usize, path: &[String]) -> Option<usize> {
        let Some((first, rest)) = path.split_first() else { return Some(module) };
        let Module { children, imports, .. } = &self.modules[module];
        if let Some(&child) = children.get(first) {
            return self.descend(child, rest);
        }
        match imports.iter().find(|import| import.name == *first) {
            Some(import) => self.resolve(module, &[&import.path, rest].concat(), false),
            None => Some(module),
        }
    }

    /// The files that each file depends on.
    fn dependencies(&self) -> BTreeMap<&str, BTreeSet<&str>> {
        let mut dependencies: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
        for (index, module) in self.modules.iter().enumerate() {
            let used = |import: &&Import| !import.is_public || module.names.contains(&import.name);
            let imported = module
                .imports
                .iter()
                .filter(used)
                .filter_map(|import| self.resolve(index, &import.path, false));
            let named = module.paths.iter().filter_map(|path| self.resolve(index, path, true));
            let files = imported.chain(named).map(|target| self.modules[target].file.as_str());
            dependencies.entry(&module.file).or_default().extend(files.filter(|file| *file != module.file));
        }
        dependencies
    }

    /// A shortest circle for each file that is part of one, without duplicates.
    fn circles(&self) -> Vec<String> {
        let dependencies = self.dependencies();
        let mut reported = BTreeSet::new();
        let mut circles = Vec::new();
        for &file in dependencies.keys() {
            let Some(circle) = shortest_circle(file, &dependencies) else { continue };
            if reported.insert(circle.iter().copied().collect::<BTreeSet<_>>()) {
                circles.push([circle.join(" -> "), file.to_owned()].join(" -> "));
            }
        }
        circles
    }
}

/// The files of a shortest circle from `start`; `None` if there is none.
fn shortest_circle<'a>(
    start: &'a str,
    dependencies: &BTreeMap<&'a str, BTreeSet<&'a str>>,
) -> Option<Vec<&'a str>> {
    let mut paths = VecDeque::from([vec![start]]);
    let mut seen = BTreeSet::new();
    while let Some(path) = paths.pop_front() {
        for &next in dependencies.get(path.last()?).into_iter().flatten() {
            if next == start {
                return Some(path);
            }
            if seen.insert(next) {
                paths.push_back([&path[..], &[next]].concat());
            }
        }
    }
    None
}

/// The number of tokens of the first item, up to its semicolon or its braces.
fn item_length(tokens: &[TokenTree]) -> usize {
    let is_semicolon = |token: &TokenTree| matches!(token, TokenTree::Punct(mark) if mark.as_char() == ';');
    let is_body = |token: &TokenTree| is_group(token, Delimiter::Brace);
    let is_import = tokens
        .iter()
        .take_while(|token| !is_body(token))
        .any(|token| matches!(token, TokenTree::Ident(word) if word == "use"));
    let end = tokens.iter().position(|token| is_semicolon(token) || !is_import && is_body(token));
    end.map_or(tokens.len(), |end| end + 1)
}

fn is_group(token: &TokenTree, delimiter: Delimiter) -> bool {
    matches!(token, TokenTree::Group(group) if group.delimiter() == delimiter)
}

/// The name after a leading `::`.
fn name_after_colons(tokens: &[TokenTree]) -> Option<String> {
    match tokens {
        [TokenTree::Punct(a), TokenTree::Punct(b), TokenTree::Ident(name), ..]
            if a.as_char() == ':' && b.as_char() == ':' =>
        {
            Some(name.to_string())
        }
        _ => None,
    }
}

/// Adds the leaves of the tree of a `use` declaration, whose paths begin with `prefix`.
fn add_leaves(tree: &[TokenTree], prefix: &[String], is_public: bool, leaves: &mut Vec<Import>) {
    let is_comma = |token: &TokenTree| matches!(token, TokenTree::Punct(mark) if mark.as_char() == ',');
    for branch in tree.split(is_comma) {
        let (mut path, mut alias) = (prefix.to_vec(), None);
        for token in branch {
            match token {
                TokenTree::Group(group) => {
                    let tree: Vec<TokenTree> = group.stream().into_iter().collect();
                    add_leaves(&tree, &path, is_public, leaves);
                    path.clear();
                }
                TokenTree::Ident(word) if word == "as" => alias = path.last().cloned(),
                TokenTree::Ident(word) if alias.is_some() => alias = Some(word.to_string()),
                // As in `use module::{self, Item}`.
                TokenTree::Ident(word) if word == "self" && !path.is_empty() => {}
                TokenTree::Ident(word) => path.push(word.to_string()),
                _ => {}
            }
        }
        if let Some(last) = path.last() {
            leaves.push(Import { name: alias.unwrap_or_else(|| last.clone()), path, is_public });
        }
    }
}

/// The circles of a crate of these files.
fn circles_of(files: &[(&str, &str)]) -> Vec<String> {
    let find = |name: &str| files.iter().find(|(file, _)| *file == name);
    Sources::read(&|name| find(name).map(|(_, text)| (*text).to_owned())).circles()
}

#[test]
fn a_circle_is_found_through_re_exports_and_inline_paths() {
    let lib = ("lib.rs", "mod a; mod b; mod room; pub use a::A; pub use room::C;");
    let clean = [
        lib,
        ("a.rs", "use crate::b::B; pub struct A(B);"),
        ("b.rs", "pub struct B; #[cfg(test)] mod tests { use crate::A; use super::B; }"),
        ("room/mod.rs", "mod c; pub use c::C;"),
        ("room/c.rs", "use crate::A; pub struct C(A);"),
    ];
    assert!(circles_of(&clean).is_empty());
    let with_b = |b| circles_of(&[clean[0], clean[1], ("b.rs", b), clean[3], clean[4]]);
    assert_eq!(with_b("use crate::A;"), ["a.rs -> b.rs -> a.rs"]);
    assert_eq!(with_b("use super::{A as Other};"), ["a.rs -> b.rs -> a.rs"]);
    assert_eq!(with_b("fn f() { crate::room::C::new() }"), ["a.rs -> b.rs -> room/c.rs -> a.rs"]);
    // A parent that uses what it re-exports, and a child that uses its parent.
    let parent = ("room/mod.rs", "mod c; pub use c::C; pub struct D(C);");
    let child = ("room/c.rs", "use super::D; pub struct C;");
    let found = circles_of(&[clean[0], clean[1], clean[2], parent, child]);
    assert_eq!(found, ["room/c.rs -> room/mod.rs -> room/c.rs"]);
}
