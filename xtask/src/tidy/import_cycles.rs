//! Circles of imports: within one crate, no file uses what a file defines that, directly or not, uses it.

mod circles;
mod modules;
mod resolve;

use modules::Crate;
use resolve::Uses;

use super::source::Source;

/// Reports each set of files of one crate that reach each other through imports.
///
/// A path counts for the file that defines its item, through any `pub use`; a `mod` line and a `pub use` alone
/// are no uses. Test code is left out.
pub(super) fn check(files: &[Source], findings: &mut Vec<String>) {
    for root in files.iter().filter(|file| is_crate_root(&file.path)) {
        let Some(tree) = Crate::read(files, &root.path) else { continue };
        let uses = resolve::uses(&tree);
        for circle in circles::circles(tree.files.len(), uses.keys().copied()) {
            findings.push(describe(&tree, &uses, &circle));
        }
    }
}

fn is_crate_root(path: &str) -> bool {
    path.ends_with("/src/lib.rs") || path.ends_with("/src/main.rs") || path.contains("/src/bin/")
}

fn describe(tree: &Crate, uses: &Uses, circle: &[usize]) -> String {
    let inside = |(a, b): &(usize, usize)| circle.contains(a) && circle.contains(b);
    let mut text = format!("{}: circle of imports over {} files:", tree.files[circle[0]], circle.len());
    for ((user, defining), (line, path)) in uses.iter().filter(|(edge, _)| inside(edge)) {
        let (user, defining) = (&tree.files[*user], &tree.files[*defining]);
        text.extend(["\n    ", user, &format!(":{line} uses `{path}` of "), defining]);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn findings(files: &[(&str, &str)]) -> Vec<String> {
        let source = |(path, text): &(&str, &str)| Source {
            path: format!("crates/a/src/{path}"),
            text: (*text).to_owned(),
        };
        let mut findings = Vec::new();
        check(&files.iter().map(source).collect::<Vec<_>>(), &mut findings);
        findings
    }

    #[test]
    fn files_that_use_each_other_are_a_circle() {
        let report = findings(&[
            ("lib.rs", "mod one; mod two; mod three;"),
            ("one.rs", "use crate::two::Two;\npub struct One(Two);"),
            ("two.rs", "\nuse super::three::Three; pub struct Two(Three);"),
            ("three.rs", "pub enum Three {}\nfn f() { crate::one::One; }"),
        ]);
        assert_eq!(report.len(), 1);
        assert!(report[0].contains("over 3 files"), "{}", report[0]);
        assert!(
            report[0].contains("crates/a/src/two.rs:2 uses `super::three::Three` of crates/a/src/three.rs")
        );
    }

    #[test]
    fn paths_are_followed_through_re_exports_to_the_defining_file() {
        let library = ("lib.rs", "mod one; pub mod part;\npub use part::{Leaf as Renamed, *};");
        let part = ("part.rs", "mod leaf; mod other;\npub use {leaf::Leaf, other::Other};");
        let files = [library, part, ("part/other.rs", "pub struct Other;")];
        let leaf = ("part/leaf.rs", "use crate::one::One; pub struct Leaf;");
        let with = |one| findings(&[&files[..], &[leaf, ("one.rs", one)]].concat());
        assert_eq!(with("use crate::{Renamed}; pub struct One;").len(), 1);
        assert_eq!(with("use crate::part::{self, Other}; pub struct One;").len(), 0);
        assert_eq!(with("use crate::part; pub struct One; fn f() -> part::Leaf {}").len(), 1);
        assert_eq!(with("use crate::Leaf; pub struct One;").len(), 1);
    }

    #[test]
    fn a_child_that_uses_its_parents_items_counts_if_the_parent_uses_the_child() {
        let child = ("one/child.rs", "use super::Shared;\npub fn f() {}");
        let with = |one| findings(&[("lib.rs", "mod one;"), child, ("one.rs", one)]);
        assert_eq!(with("mod child;\npub struct Shared;\nfn g() { child::f(); }").len(), 1);
        assert_eq!(with("mod child;\nuse child::f;\npub struct Shared;").len(), 1);
        assert_eq!(with("mod child;\npub use child::f;\npub struct Shared;").len(), 0);
    }

    #[test]
    fn tests_comments_and_inline_modules_do_not_count() {
        let two = "// use crate::one::One;\npub struct Two;\nmod inner { use super::Two; }\n\
                   #[cfg(test)]\nmod tests { use crate::one::One; }";
        let one = "use crate::two::Two; pub struct One; #[cfg(test)] mod tests;";
        let test = ("one/tests.rs", "use super::*; use crate::one::One;");
        assert!(
            findings(&[("lib.rs", "mod one; mod two;"), ("one.rs", one), ("two.rs", two), test]).is_empty()
        );
    }
}
