//! Follows paths to the files that define their items.

use std::collections::BTreeMap;

use super::modules::{Crate, Module};

/// Uses of one file by another: (user, defining file) → line and path of the first use.
pub(super) type Uses = BTreeMap<(usize, usize), (usize, String)>;

/// Re-exports of re-exports: deeper than this is a `use` that names itself.
const MAX_DEPTH: usize = 16;

/// Target of a path.
#[derive(Clone, Copy, PartialEq)]
enum Target {
    Module(usize),
    /// An item that this file defines.
    Item(usize),
    /// Another crate, a local name, or nothing that the tree knows.
    Outside,
}

/// Collects which file uses which other file of a crate, with the first use of each pair.
pub(super) fn uses(tree: &Crate) -> Uses {
    let mut uses = Uses::new();
    for (at, module) in tree.modules.iter().enumerate() {
        let imports = module.imports.iter().filter(|import| !import.is_public);
        let named = imports.map(|import| (&import.path, import.line, import.name == "*"));
        for (path, line, is_glob) in named.chain(module.paths.iter().map(|(path, line)| (path, *line, false)))
        {
            let defining = match resolve(tree, at, path, 0) {
                Target::Item(file) => file,
                Target::Module(all) if is_glob && !tree.modules[all].definitions.is_empty() => {
                    tree.modules[all].file
                }
                Target::Module(_) | Target::Outside => continue,
            };
            if defining != module.file {
                uses.entry((module.file, defining)).or_insert_with(|| (line, path.join("::")));
            }
        }
    }
    uses
}

/// Follows a path that stands in module `at`.
fn resolve(tree: &Crate, at: usize, path: &[String], depth: usize) -> Target {
    let mut target = Target::Module(at);
    for (index, name) in path.iter().enumerate() {
        let Target::Module(here) = target else { return target };
        target = match (name.as_str(), index) {
            ("crate", 0) => Target::Module(0),
            ("self", 0) => Target::Module(at),
            ("super", _) => Target::Module(tree.modules[here].parent),
            _ => lookup(tree, here, name, index == 0, depth),
        };
    }
    target
}

/// Finds a name in a module: its children, its own items, its imports.
fn lookup(tree: &Crate, here: usize, name: &str, is_first: bool, depth: usize) -> Target {
    let module: &Module = &tree.modules[here];
    if let Some(child) = module.children.get(name) {
        return Target::Module(*child);
    }
    if module.definitions.contains(name) {
        return Target::Item(module.file);
    }
    if depth > MAX_DEPTH {
        return Target::Outside;
    }
    let follow = |path: &[String]| match path.first() {
        // A path that begins with the name it brings into scope is another crate's.
        Some(first) if first == name && path.len() == 1 => Target::Outside,
        _ => resolve(tree, here, path, depth + 1),
    };
    if let Some(import) = module.imports.iter().find(|import| import.name == name) {
        return follow(&import.path);
    }
    for import in module.imports.iter().filter(|import| import.name == "*") {
        if let Target::Module(all) = resolve(tree, here, &import.path, depth + 1)
            && all != here
        {
            let found = lookup(tree, all, name, true, depth + 1);
            if found != Target::Outside {
                return found;
            }
        }
    }
    // What a macro of this module defines has no declaration to be found; the first name may be another crate's.
    if is_first { Target::Outside } else { Target::Item(module.file) }
}
