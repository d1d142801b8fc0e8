//! Public type names: each exists once in the workspace.

use std::collections::BTreeMap;

use super::lexer;
use super::source::Source;

/// The keywords that declare a type.
const DECLARATIONS: [&str; 5] = ["struct", "enum", "union", "trait", "type"];

/// Reports every public type name that is declared more than once outside tests.
pub(super) fn check(files: &[Source], findings: &mut Vec<String>) {
    let mut places: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for file in files.iter().filter(|file| file.is_rust() && !file.is_test()) {
        for (name, line) in public_types(&file.text) {
            places.entry(name).or_default().push(format!("{}:{line}", file.path));
        }
    }
    for (name, places) in places.iter().filter(|(_, places)| places.len() > 1) {
        findings.push(format!(
            "{}: public type name `{name}` is declared {} times (also {}); rename all but one",
            places[0],
            places.len(),
            places[1..].join(", ")
        ));
    }
}

/// Names and lines of the types declared plain `pub`; `pub(crate)` and `pub(super)` do not count.
fn public_types(source: &str) -> Vec<(String, usize)> {
    let code = lexer::without_tests(&lexer::split(source).code);
    let words = lexer::words(&code);
    let mut found = Vec::new();
    for (at, word) in words.iter().enumerate().filter(|(_, word)| word.text == "pub") {
        let follows = |offset: usize| words.get(at + offset).filter(|next| next.gap.trim().is_empty());
        let skipped = usize::from(follows(1).is_some_and(|next| next.text == "unsafe"));
        let declares = follows(1 + skipped).is_some_and(|next| DECLARATIONS.contains(&next.text));
        // The name of a type that a macro declares is not known here: `pub struct $name`.
        if let (true, Some(name)) = (declares, follows(2 + skipped)) {
            found.push((name.text.to_owned(), word.line));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn findings(files: &[(&str, &str)]) -> Vec<String> {
        let mut findings = Vec::new();
        let source = |(path, text): &(&str, &str)| Source { path: (*path).into(), text: (*text).into() };
        check(&files.iter().map(source).collect::<Vec<_>>(), &mut findings);
        findings
    }

    #[test]
    fn repeated_names_are_reported_with_their_places() {
        let report = findings(&[
            ("crates/a/src/lib.rs", "//! A.\npub struct View;\npub struct Map<T>(T);"),
            ("experiments/src/x.rs", "pub enum View {}"),
        ]);
        assert_eq!(report.len(), 1);
        assert!(report[0].starts_with("crates/a/src/lib.rs:2: public type name `View`"));
        assert!(report[0].contains("experiments/src/x.rs:1"));
    }

    #[test]
    fn restricted_types_tests_comments_and_macros_do_not_count() {
        let report = findings(&[
            (
                "crates/a/src/lib.rs",
                "pub trait View {}\n// pub struct View;\nconst A: &str = \"pub enum View\";",
            ),
            ("crates/b/src/lib.rs", "pub(crate) struct View;\npub(super) enum View {}\nstruct View;"),
            (
                "crates/c/src/lib.rs",
                "#[cfg(test)]\nmod tests { pub struct View; }\nfn view() { pub struct $View; }",
            ),
            ("crates/c/src/x/tests.rs", "pub struct View;"),
            ("crates/c/tests/view.rs", "pub type View = u8;"),
        ]);
        assert!(report.is_empty(), "{report:?}");
    }
}
