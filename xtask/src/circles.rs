//! The second half of `arrows`: no more than three files of a crate may import each other.
//!
//! An arrow leads from a file that names an item to the file that defines it, a name followed through re-exports. No arrows are
//! a re-export (`pub use`) and a name of the module above, of which the file is a part: so the methods of one type stand in several
//! files. Tests, method calls and names in attributes do not count.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::fs;
use std::path::{Path, PathBuf};

use syn::buffer::{Cursor, TokenBuffer};
use syn::visit::{self, Visit};
use syn::{Attribute, Item, UseTree, Visibility};

use crate::Outcome;

/// Most files that may import each other.
const MOST: usize = 3;
/// Most re-exports that a name is followed through; more are a circle of re-exports.
const MOST_HOPS: usize = 16;

/// The arrows from each file to others, with the names that make them.
type Arrows<'n> = BTreeMap<usize, BTreeMap<usize, BTreeSet<&'n str>>>;

/// What there is of circles.
pub struct Circles {
    /// Every circle in a library or program of `crates/` that is too large.
    pub wrong: Vec<String>,
    /// The sizes of those there would be if names of the module above counted, the largest first.
    pub strict: Vec<usize>,
}

/// Reads all libraries and programs of `crates/`.
pub fn find(root: &Path) -> Outcome<Circles> {
    let (mut wrong, mut strict) = (Vec::new(), Vec::new());
    for package in fs::read_dir(root.join("crates"))? {
        let source = package?.path().join("src");
        let entries = ["lib.rs", "main.rs"].map(|name| source.join(name));
        for entry in entries.iter().filter(|entry| entry.is_file()) {
            let graph = Crate::read(entry, &|path| fs::read_to_string(path).ok())?;
            wrong.extend(graph.circles(root));
            let circles = graph.too_large(&graph.arrows(true));
            strict.extend(circles.iter().map(BTreeSet::len));
        }
    }
    wrong.sort();
    strict.sort_by(|one, other| other.cmp(one));
    Ok(Circles { wrong, strict })
}

/// The modules of a crate, and who names what in which file.
#[derive(Default)]
struct Crate {
    files: Vec<PathBuf>,
    modules: Vec<Module>,
    /// Paths that code or a private import has, with the module they stand in.
    names: Vec<(usize, Vec<String>)>,
}

#[derive(Default)]
struct Module {
    file: usize,
    parent: usize,
    children: HashMap<String, usize>,
    items: HashSet<String>,
    aliases: HashMap<String, Vec<String>>,
    globs: Vec<Vec<String>>,
}

/// What a name stands for.
#[derive(Clone, Copy)]
enum Meaning {
    Module(usize),
    /// An item that this module defines.
    Item(usize),
}

impl Crate {
    /// Reads a crate from its first file.
    fn read(entry: &Path, source: &dyn Fn(&Path) -> Option<String>) -> Outcome<Self> {
        let mut graph = Self::default();
        graph.modules.push(Module::default());
        let folder = entry.parent().unwrap_or(entry).to_owned();
        let mut waiting = vec![(0, entry.to_owned(), folder)];
        while let Some((module, path, folder)) = waiting.pop() {
            let text = source(&path).ok_or_else(|| format!("{}: cannot be read", path.display()))?;
            let parsed = syn::parse_file(&text).map_err(|error| format!("{}: {error}", path.display()))?;
            graph.modules[module].file = graph.files.len();
            graph.files.push(path);
            let mut reader = Reader {
                graph: &mut graph,
                module,
                folder,
                found: Vec::new(),
            };
            reader.visit_file(&parsed);
            for (module, folder, name) in reader.found {
                let candidates = [
                    folder.join(format!("{name}.rs")),
                    folder.join(&name).join("mod.rs"),
                ];
                let path = candidates.into_iter().find(|path| source(path).is_some());
                let path = path.ok_or_else(|| format!("{}: no file of `{name}`", folder.display()))?;
                waiting.push((module, path, folder.join(name)));
            }
        }
        Ok(graph)
    }

    /// Returns the meaning of a path that stands in `module`.
    fn resolve(&self, module: usize, path: &[String], hops: usize) -> Option<Meaning> {
        let mut meaning = Meaning::Module(module);
        for (index, name) in path.iter().enumerate() {
            let Meaning::Module(at) = meaning else { break };
            let last = index + 1 == path.len();
            meaning = match name.as_str() {
                "crate" => Meaning::Module(0),
                "self" => meaning,
                "super" => Meaning::Module(self.modules[at].parent),
                name => self.look_up(at, name, last, hops)?,
            };
        }
        Some(meaning)
    }

    /// Returns the meaning of a name in a module. At the end of a path an item comes before a module of the same name.
    fn look_up(&self, module: usize, name: &str, last: bool, hops: usize) -> Option<Meaning> {
        if hops == 0 {
            return None;
        }
        let here = &self.modules[module];
        let item = || here.items.contains(name).then_some(Meaning::Item(module));
        let child = || here.children.get(name).copied().map(Meaning::Module);
        let own = if last {
            item().or_else(child)
        } else {
            child().or_else(item)
        };
        own.or_else(|| {
            let path = here.aliases.get(name)?;
            // `use name;` of another crate
            let other_crate = path.len() == 1 && path[0] == name;
            (!other_crate).then(|| self.resolve(module, path, hops - 1))?
        })
        .or_else(|| {
            here.globs
                .iter()
                .find_map(|glob| match self.resolve(module, glob, hops - 1)? {
                    Meaning::Module(at) if at != module => self.look_up(at, name, last, hops - 1),
                    _ => None,
                })
        })
    }

    /// Returns whether a module stands in this file, or is a part of one that does. The root of the crate has no parts: it holds
    /// what there is.
    fn is_part(&self, mut module: usize, file: usize) -> bool {
        let own = self.modules[module].file;
        while module != 0 && self.modules[module].file != file {
            module = self.modules[module].parent;
        }
        file == own || module != 0
    }

    /// Returns the arrows between files, each with the names that make it; `strict` also those of the modules above.
    fn arrows(&self, strict: bool) -> Arrows<'_> {
        let mut arrows: Arrows<'_> = BTreeMap::new();
        for (module, path) in &self.names {
            let Some(Meaning::Item(target)) = self.resolve(*module, path, MOST_HOPS) else {
                continue;
            };
            let (from, to) = (self.modules[*module].file, self.modules[target].file);
            if from != to && (strict || !self.is_part(*module, to)) {
                let name = path
                    .iter()
                    .rev()
                    .find(|name| self.modules[target].items.contains(*name));
                let names = arrows.entry(from).or_default().entry(to).or_default();
                names.extend(name.or(path.last()).map(String::as_str));
            }
        }
        arrows
    }

    /// Returns the files of each circle of more than [`MOST`] files.
    fn too_large(&self, arrows: &Arrows<'_>) -> BTreeSet<BTreeSet<usize>> {
        let reach: Vec<BTreeSet<usize>> = (0..self.files.len()).map(|file| reached(arrows, file)).collect();
        let circle = |file: usize| {
            let others = reach[file].iter().copied();
            others.filter(|&other| reach[other].contains(&file)).collect()
        };
        let circles = (0..self.files.len()).map(circle);
        circles
            .filter(|circle: &BTreeSet<usize>| circle.len() > MOST)
            .collect()
    }

    /// Returns each circle of more than [`MOST`] files with its arrows.
    fn circles(&self, root: &Path) -> Vec<String> {
        let arrows = self.arrows(false);
        let name = |file: usize| {
            self.files[file]
                .strip_prefix(root)
                .unwrap_or(&self.files[file])
                .display()
        };
        let mut circles = Vec::new();
        for circle in self.too_large(&arrows) {
            let mut text = format!("{} files import each other, at most {MOST} may:", circle.len());
            for (from, to) in circle
                .iter()
                .flat_map(|from| circle.iter().map(move |to| (from, to)))
            {
                if let Some(names) = arrows.get(from).and_then(|arrows| arrows.get(to)) {
                    let names: Vec<&str> = names.iter().copied().collect();
                    text += &format!("\n  {} -> {}: {}", name(*from), name(*to), names.join(", "));
                }
            }
            circles.push(text);
        }
        circles
    }
}

/// Returns the files that a file reaches along arrows.
fn reached(arrows: &Arrows<'_>, file: usize) -> BTreeSet<usize> {
    let mut reached = BTreeSet::new();
    let mut waiting = vec![file];
    while let Some(file) = waiting.pop() {
        let next = arrows.get(&file).into_iter().flat_map(BTreeMap::keys);
        waiting.extend(next.filter(|next| reached.insert(**next)));
    }
    reached
}

/// Takes the modules, items, imports and names out of one file.
struct Reader<'a> {
    graph: &'a mut Crate,
    module: usize,
    /// Where the files of its modules are.
    folder: PathBuf,
    /// Modules with a file of their own: number, folder of that file, name.
    found: Vec<(usize, PathBuf, String)>,
}

impl Reader<'_> {
    fn define(&mut self, name: &syn::Ident) {
        self.graph.modules[self.module].items.insert(plain(name));
    }

    fn import(&mut self, tree: &UseTree, before: &[String], counts: bool) {
        let with = |name: &syn::Ident| [before, &[plain(name)]].concat();
        match tree {
            UseTree::Path(path) => self.import(&path.tree, &with(&path.ident), counts),
            UseTree::Group(group) => group
                .items
                .iter()
                .for_each(|tree| self.import(tree, before, counts)),
            UseTree::Glob(_) => self.graph.modules[self.module].globs.push(before.to_vec()),
            UseTree::Name(name) if name.ident == "self" => {
                let alias = before.last().cloned().unwrap_or_default();
                self.alias(alias, before.to_vec(), counts);
            }
            UseTree::Name(name) => self.alias(plain(&name.ident), with(&name.ident), counts),
            UseTree::Rename(rename) => self.alias(plain(&rename.rename), with(&rename.ident), counts),
        }
    }

    fn alias(&mut self, name: String, path: Vec<String>, counts: bool) {
        if counts {
            self.graph.names.push((self.module, path.clone()));
        }
        self.graph.modules[self.module].aliases.insert(name, path);
    }

    /// Paths in the tokens of a macro, whatever they mean to it.
    fn scan(&mut self, mut cursor: Cursor<'_>) {
        let mut path: Vec<String> = Vec::new();
        let mut dots = String::new();
        loop {
            if let Some((name, next)) = cursor.ident() {
                if dots != "::" {
                    self.name(std::mem::take(&mut path));
                }
                // what follows a point is a field or a method
                if dots != "." {
                    path.push(plain(&name));
                }
                dots.clear();
                cursor = next;
            } else if let Some((punct, next)) = cursor.punct() {
                dots.push(punct.as_char());
                cursor = next;
            } else {
                self.name(std::mem::take(&mut path));
                dots.clear();
                if let Some((inner, _, _, next)) = cursor.any_group() {
                    self.scan(inner);
                    cursor = next;
                } else if let Some((_, next)) = cursor.token_tree() {
                    cursor = next;
                } else {
                    return;
                }
            }
        }
    }

    fn name(&mut self, path: Vec<String>) {
        if !path.is_empty() {
            self.graph.names.push((self.module, path));
        }
    }
}

impl<'ast> Visit<'ast> for Reader<'_> {
    fn visit_item(&mut self, item: &'ast Item) {
        let (name, attributes) = match item {
            Item::Const(item) => (Some(&item.ident), &item.attrs),
            Item::Enum(item) => (Some(&item.ident), &item.attrs),
            Item::Fn(item) => (Some(&item.sig.ident), &item.attrs),
            Item::Macro(item) => (item.ident.as_ref(), &item.attrs),
            Item::Static(item) => (Some(&item.ident), &item.attrs),
            Item::Struct(item) => (Some(&item.ident), &item.attrs),
            Item::Trait(item) => (Some(&item.ident), &item.attrs),
            Item::Type(item) => (Some(&item.ident), &item.attrs),
            Item::Union(item) => (Some(&item.ident), &item.attrs),
            Item::Impl(item) => (None, &item.attrs),
            Item::Mod(item) => (None, &item.attrs),
            Item::Use(item) => (None, &item.attrs),
            _ => return,
        };
        if is_test(attributes) {
            return;
        }
        if let Some(name) = name {
            self.define(name);
        }
        visit::visit_item(self, item);
    }

    fn visit_item_mod(&mut self, item: &'ast syn::ItemMod) {
        let name = plain(&item.ident);
        let number = self.graph.modules.len();
        let file = self.graph.modules[self.module].file;
        self.graph.modules.push(Module {
            file,
            parent: self.module,
            ..Module::default()
        });
        self.graph.modules[self.module]
            .children
            .insert(name.clone(), number);
        if item.content.is_none() {
            self.found.push((number, self.folder.clone(), name));
            return;
        }
        let outer = std::mem::replace(&mut self.module, number);
        let folder = self.folder.clone();
        self.folder.push(name);
        visit::visit_item_mod(self, item);
        self.module = outer;
        self.folder = folder;
    }

    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        let counts = matches!(item.vis, Visibility::Inherited);
        self.import(&item.tree, &[], counts);
    }

    fn visit_impl_item_fn(&mut self, item: &'ast syn::ImplItemFn) {
        if !is_test(&item.attrs) {
            visit::visit_impl_item_fn(self, item);
        }
    }

    fn visit_attribute(&mut self, _: &'ast Attribute) {}

    fn visit_path(&mut self, path: &'ast syn::Path) {
        self.name(
            path.segments
                .iter()
                .map(|segment| plain(&segment.ident))
                .collect(),
        );
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, item: &'ast syn::Macro) {
        self.visit_path(&item.path);
        self.scan(TokenBuffer::new2(item.tokens.clone()).begin());
    }
}

fn plain(name: &syn::Ident) -> String {
    let name = name.to_string();
    name.strip_prefix("r#").map_or(name.clone(), str::to_owned)
}

fn is_test(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        let condition = attribute
            .meta
            .require_list()
            .ok()
            .filter(|_| attribute.path().is_ident("cfg"));
        condition.is_some_and(|condition| {
            let condition = condition.tokens.to_string();
            condition.contains("test") && !condition.contains("not")
        })
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    /// Reads a crate from the texts of its files.
    fn crate_of(files: &[(&str, &str)]) -> Crate {
        let source = |path: &Path| {
            let file = files.iter().find(|(name, _)| Path::new(name) == path);
            file.map(|(_, text)| (*text).to_owned())
        };
        Crate::read(Path::new("lib.rs"), &source).unwrap()
    }

    fn arrows(files: &[(&str, &str)]) -> Vec<String> {
        let graph = crate_of(files);
        let name = |file: usize| graph.files[file].display().to_string();
        let mut found = Vec::new();
        for (from, to) in graph.arrows(false) {
            for (to, names) in to {
                let names: Vec<&str> = names.into_iter().collect();
                found.push(format!("{} -> {}: {}", name(from), name(to), names.join(" ")));
            }
        }
        found.sort();
        found
    }

    /// `b/deep.rs` is a part of `b`, so what it names there is no arrow.
    #[test]
    fn a_name_leads_to_the_file_that_defines_it() {
        let found = arrows(&[
            (
                "lib.rs",
                "mod a; mod b; pub use b::deep::Deep; pub use a::f; struct Here;",
            ),
            (
                "a.rs",
                "use crate::Deep; pub fn f(_: Deep) { crate::b::g(); let _ = super::Here; }",
            ),
            ("b/mod.rs", "pub mod deep; pub use deep::*; pub fn g() {}"),
            (
                "b/deep.rs",
                "pub struct Deep; pub struct Other; fn h() { super::g() }",
            ),
        ]);
        assert_eq!(
            found,
            [
                "a.rs -> b/deep.rs: Deep",
                "a.rs -> b/mod.rs: g",
                "a.rs -> lib.rs: Here",
            ]
        );
    }

    #[test]
    fn globs_modules_variants_macros_and_functions_are_followed() {
        let found = arrows(&[
            ("lib.rs", "mod a; mod b; mod c { pub struct Inner; }"),
            (
                "a.rs",
                "use crate::b::*; use crate::c; fn f() { let _ = Kind::One; println!(\"{}\", c::Inner.a.own); }",
            ),
            (
                "b.rs",
                "pub enum Kind { One } fn own() { use crate::a; vec![1, a::x(2)]; }",
            ),
        ]);
        // `x` is nowhere: nothing is known of it
        assert_eq!(found, ["a.rs -> b.rs: Kind", "a.rs -> lib.rs: Inner"]);
    }

    #[test]
    fn tests_and_re_exports_are_no_arrows() {
        let found = arrows(&[
            ("lib.rs", "mod a; mod b; pub use a::A; pub(crate) use b::B;"),
            (
                "a.rs",
                "pub struct A; #[cfg(test)] mod tests { use crate::B; } #[cfg(test)] fn t() { crate::b::x() }",
            ),
            (
                "b.rs",
                "pub struct B; impl B { #[cfg(test)] fn t() -> crate::A {} }",
            ),
        ]);
        assert_eq!(found, Vec::<String>::new());
        // but the code beside a re-export uses it
        let found = arrows(&[
            ("lib.rs", "mod a; pub use a::A; fn f(_: A) {}"),
            ("a.rs", "pub struct A;"),
        ]);
        assert_eq!(found, ["lib.rs -> a.rs: A"]);
    }

    #[test]
    fn a_circle_of_four_files_is_reported_with_its_arrows() {
        let ring = |last: &'static str| {
            crate_of(&[
                ("lib.rs", "mod a; mod b; mod c; mod d;"),
                ("a.rs", "pub fn a() { crate::b::b() }"),
                ("b.rs", "pub fn b() { crate::c::c() }"),
                ("c.rs", last),
                ("d.rs", "pub fn d() { crate::a::a() }"),
            ])
        };
        let three = ring("pub fn c() { crate::a::a() }");
        assert_eq!(three.circles(Path::new("")), Vec::<String>::new());
        let four = ring("pub fn c() { crate::d::d() }").circles(Path::new(""));
        assert_eq!(four.len(), 1);
        assert!(four[0].starts_with("4 files import each other"), "{four:?}");
        for arrow in ["a.rs -> b.rs: b", "c.rs -> d.rs: d", "d.rs -> a.rs: a"] {
            assert!(four[0].contains(arrow), "{arrow}: {four:?}");
        }
    }
}
