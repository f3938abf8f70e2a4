//! The public items of a crate as a Rust file without bodies, made from its sources.

use std::path::{Path, PathBuf};
use syn::{
    Attribute, Field, Fields, ImplItem, Item, ItemImpl, TraitItem, Type, UseTree, Visibility, parse_quote,
};

/// A module with its items and child modules.
struct Module {
    name: String,
    items: Vec<Item>,
    children: Vec<Module>,
}

/// The listing of the crate whose root is `lib`.
///
/// # Panics
/// If a source file is missing or is not valid Rust.
pub(crate) fn of_crate(lib: &Path) -> String {
    let folder = lib.parent().expect("a crate's root lies in a folder");
    let root = Module::read("crate", lib, folder);
    let mut found = Vec::new();
    root.collect("", &root, &mut found);
    found.sort_by(|a, b| a.0.cmp(&b.0));
    let sections = found.into_iter().map(|(path, items)| {
        let file = syn::File { shebang: None, attrs: Vec::new(), items };
        format!("// {path}\n{}", prettyplease::unparse(&file))
    });
    sections.collect::<Vec<_>>().join("\n")
}

impl Module {
    /// The module in `file`, whose children lie in `folder`.
    fn read(name: &str, file: &Path, folder: &Path) -> Self {
        let text =
            std::fs::read_to_string(file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        let file = syn::parse_file(&text).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        Self::of_items(name, file.items, folder)
    }

    fn of_items(name: &str, items: Vec<Item>, folder: &Path) -> Self {
        let mut children = Vec::new();
        for item in &items {
            let Item::Mod(module) = item else { continue };
            let name = module.ident.to_string();
            if is_test(&module.attrs) {
                continue;
            }
            let inner = folder.join(&name);
            children.push(match &module.content {
                Some((_, items)) => Self::of_items(&name, items.clone(), &inner),
                None => Self::read(&name, &source_of(folder, &name), &inner),
            });
        }
        Self { name: name.to_owned(), items, children }
    }

    /// Adds all public items of this module under their public paths.
    fn collect(&self, path: &str, root: &Self, found: &mut Vec<(String, Vec<Item>)>) {
        for item in &self.items {
            match item {
                Item::Use(import) if is_public(&import.vis) => {
                    for (target, name) in imports(&import.tree, &[]) {
                        self.collect_import(path, &target, &name, root, found);
                    }
                }
                Item::Mod(module) if is_public(&module.vis) => {
                    if let Some(child) = self.children.iter().find(|child| module.ident == child.name) {
                        child.collect(&format!("{path}{}::", child.name), root, found);
                    }
                }
                item => {
                    if let Some(name) = public_name(item) {
                        found.push((format!("{path}{name}"), root.described(item, &name)));
                    }
                }
            }
        }
    }

    /// Adds an item that is re-exported as `name`. For an item of another crate, adds the re-export itself.
    fn collect_import(
        &self,
        path: &str,
        target: &[String],
        name: &str,
        root: &Self,
        found: &mut Vec<(String, Vec<Item>)>,
    ) {
        let (last, modules) = target.split_last().expect("a path has an end");
        let start = if modules.first().is_some_and(|first| first == "crate") { root } else { self };
        let steps = modules.iter().filter(|step| *step != "crate" && *step != "self");
        let home = steps.into_iter().try_fold(start, |module, step| module.child(step));
        let definition = home.filter(|_| !modules.is_empty()).and_then(|home| home.find(last));
        let items = match definition {
            Some(item) => root.described(item, last),
            None => {
                let target = target.join("::");
                let target: syn::Path = syn::parse_str(&target).expect("a path");
                let name: syn::Ident = syn::parse_str(name).expect("a name");
                vec![parse_quote!(pub use #target as #name;)]
            }
        };
        found.push((format!("{path}{name}"), items));
    }

    fn child(&self, name: &str) -> Option<&Self> {
        self.children.iter().find(|child| child.name == name)
    }

    /// The public item of this name, defined or re-exported here.
    fn find(&self, name: &str) -> Option<&Item> {
        if let Some(item) = self.items.iter().find(|item| public_name(item).is_some_and(|n| n == name)) {
            return Some(item);
        }
        let uses = self.items.iter().filter_map(|item| match item {
            Item::Use(import) => Some(import),
            _ => None,
        });
        let mut targets = uses.flat_map(|import| imports(&import.tree, &[]));
        let (target, _) = targets.find(|(_, imported)| imported == name)?;
        let (last, modules) = target.split_last()?;
        let home = modules.iter().filter(|step| *step != "self").try_fold(self, |m, step| m.child(step))?;
        if std::ptr::eq(home, self) { None } else { home.find(last) }
    }

    /// The item without bodies and private fields, and its implementations in this crate.
    fn described(&self, item: &Item, name: &str) -> Vec<Item> {
        let mut items = vec![bare(item.clone())];
        self.implementations(name, &mut items);
        items
    }

    fn implementations(&self, name: &str, found: &mut Vec<Item>) {
        for item in &self.items {
            match item {
                Item::Impl(block) if !is_test(&block.attrs) && is_for(&block.self_ty, name) => {
                    found.extend(bare_impl(block.clone()).map(Item::Impl));
                }
                _ => {}
            }
        }
        self.children.iter().for_each(|child| child.implementations(name, found));
    }
}

fn source_of(folder: &Path, name: &str) -> PathBuf {
    let file = folder.join(format!("{name}.rs"));
    if file.exists() { file } else { folder.join(name).join("mod.rs") }
}

fn is_public(visibility: &Visibility) -> bool {
    matches!(visibility, Visibility::Public(_))
}

fn is_test(attributes: &[Attribute]) -> bool {
    attributes
        .iter()
        .any(|a| a.path().is_ident("cfg") && a.parse_args::<syn::Ident>().is_ok_and(|i| i == "test"))
}

/// The name of an item, if it is public.
fn public_name(item: &Item) -> Option<String> {
    let (visibility, name) = match item {
        Item::Const(item) => (&item.vis, &item.ident),
        Item::Enum(item) => (&item.vis, &item.ident),
        Item::Fn(item) => (&item.vis, &item.sig.ident),
        Item::Static(item) => (&item.vis, &item.ident),
        Item::Struct(item) => (&item.vis, &item.ident),
        Item::Trait(item) => (&item.vis, &item.ident),
        Item::Type(item) => (&item.vis, &item.ident),
        _ => return None,
    };
    is_public(visibility).then(|| name.to_string())
}

/// Every path of a `use` declaration, with the name it is imported as.
fn imports(tree: &UseTree, before: &[String]) -> Vec<(Vec<String>, String)> {
    let with = |name: &syn::Ident| [before, &[name.to_string()]].concat();
    match tree {
        UseTree::Path(path) => imports(&path.tree, &with(&path.ident)),
        UseTree::Name(name) => vec![(with(&name.ident), name.ident.to_string())],
        UseTree::Rename(rename) => vec![(with(&rename.ident), rename.rename.to_string())],
        UseTree::Group(group) => group.items.iter().flat_map(|tree| imports(tree, before)).collect(),
        UseTree::Glob(_) => vec![([before, &["*".to_owned()]].concat(), "*".to_owned())],
    }
}

/// Whether the type, or the type it refers to, has this name.
fn is_for(ty: &Type, name: &str) -> bool {
    match ty {
        Type::Path(path) => path.path.segments.last().is_some_and(|segment| segment.ident == name),
        Type::Reference(reference) => is_for(&reference.elem, name),
        _ => false,
    }
}

/// Keeps only the attributes that matter to users of the item.
fn keep_public_attributes(attributes: &mut Vec<Attribute>) {
    let names = ["derive", "must_use", "non_exhaustive", "repr", "deprecated"];
    attributes.retain(|attribute| names.iter().any(|name| attribute.path().is_ident(name)));
}

fn bare(mut item: Item) -> Item {
    match &mut item {
        Item::Const(item) => {
            keep_public_attributes(&mut item.attrs);
            *item.expr = parse_quote!(_);
        }
        Item::Enum(item) => {
            keep_public_attributes(&mut item.attrs);
            for variant in &mut item.variants {
                keep_public_attributes(&mut variant.attrs);
                variant.fields.iter_mut().for_each(|field| keep_public_attributes(&mut field.attrs));
            }
        }
        Item::Fn(item) => {
            keep_public_attributes(&mut item.attrs);
            *item.block = parse_quote!({});
        }
        Item::Struct(item) => {
            keep_public_attributes(&mut item.attrs);
            hide_private(&mut item.fields);
        }
        Item::Trait(item) => {
            keep_public_attributes(&mut item.attrs);
            item.items.iter_mut().for_each(bare_trait_item);
        }
        Item::Type(item) => keep_public_attributes(&mut item.attrs),
        _ => {}
    }
    item
}

fn bare_trait_item(item: &mut TraitItem) {
    match item {
        TraitItem::Fn(function) => {
            keep_public_attributes(&mut function.attrs);
            // Implementers of the trait depend on whether there is a body, but not on its content.
            if let Some(body) = &mut function.default {
                *body = parse_quote!({});
            }
        }
        TraitItem::Const(constant) => keep_public_attributes(&mut constant.attrs),
        TraitItem::Type(ty) => keep_public_attributes(&mut ty.attrs),
        _ => {}
    }
}

/// Replaces private fields by one field without a type, which shows that there are some.
fn hide_private(fields: &mut Fields) {
    let secret = |field: &Field| !is_public(&field.vis);
    match fields {
        Fields::Named(named) => {
            let hidden = named.named.iter().any(secret);
            let public = named.named.iter().filter(|field| !secret(field)).cloned();
            named.named = public.chain(hidden.then(|| parse_quote!(private: _))).collect();
        }
        Fields::Unnamed(unnamed) => {
            for field in unnamed.unnamed.iter_mut().filter(|field| secret(field)) {
                field.ty = parse_quote!(_);
            }
        }
        Fields::Unit => {}
    }
    fields.iter_mut().for_each(|field| keep_public_attributes(&mut field.attrs));
}

/// The public functions and constants of a type, or the header of a trait implementation; `None` if nothing
/// is public.
fn bare_impl(mut block: ItemImpl) -> Option<ItemImpl> {
    keep_public_attributes(&mut block.attrs);
    if block.trait_.is_some() {
        block.items.retain(|item| matches!(item, ImplItem::Type(_)));
        return Some(block);
    }
    block.items.retain(|item| match item {
        ImplItem::Fn(function) => is_public(&function.vis),
        ImplItem::Const(constant) => is_public(&constant.vis),
        _ => false,
    });
    for item in &mut block.items {
        match item {
            ImplItem::Fn(function) => {
                keep_public_attributes(&mut function.attrs);
                function.block = parse_quote!({});
            }
            ImplItem::Const(constant) => {
                keep_public_attributes(&mut constant.attrs);
                constant.expr = parse_quote!(_);
            }
            _ => {}
        }
    }
    (!block.items.is_empty()).then_some(block)
}
