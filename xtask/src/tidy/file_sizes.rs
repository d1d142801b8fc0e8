//! Lengths of Rust files: one idea fits, and a fragment is no file.

use super::lexer;
use super::source::Source;

/// The most lines a file may have: one idea fits.
const MAX_LINES: usize = 400;

/// A shorter file belongs to a neighbor, unless `SHORT` states a reason.
const MIN_LINES: usize = 25;

/// Ends of paths that may be shorter, and why.
const SHORT: &[(&str, &str)] = &[
    ("/build.rs", "Cargo runs a build script from its own file"),
    ("/src/main.rs", "Cargo builds a program from its own file"),
    ("/tests/common/mod.rs", "Cargo takes every other file of `tests` for a test program"),
    (
        "/firmware_loop/main.rs",
        "the host's entry to the loop that firmware/ includes from the file beside it",
    ),
    ("/src/control/output.rs", "shared by the laws; their parent would close a circle of imports"),
    ("/src/half_circle.rs", "shared by two readers; the crate's root would close a circle of imports"),
    ("/reproduce/figure_result.rs", "shared by the figures; their parent would close a circle of imports"),
    ("/src/element/single.rs", "the coefficients of `f32`, as `double.rs` beside it has those of `f64`"),
];

/// Folders whose files may be shorter, and why.
const SHORT_FOLDERS: &[(&str, &str)] = &[("fuzz/fuzz_targets/", "libFuzzer wants one program per target")];

/// Reports files that are too long or, without a stated reason, too short.
pub(super) fn check(files: &[Source], findings: &mut Vec<String>) {
    for file in files.iter().filter(|file| file.is_rust()) {
        let lines = file.text.lines().count();
        if lines > MAX_LINES {
            findings.push(format!("{}: {lines} lines, more than {MAX_LINES}; split the ideas", file.path));
        } else if lines < MIN_LINES && !is_excused(&file.path) && !only_declares_modules(&file.text) {
            findings.push(format!(
                "{}: {lines} lines, fewer than {MIN_LINES}; merge it into a neighbor, \
                 or state a reason in xtask/src/tidy/file_sizes.rs",
                file.path
            ));
        }
    }
    for (end, _) in SHORT {
        let short = |file: &Source| file.path.ends_with(end) && file.text.lines().count() < MIN_LINES;
        if !files.iter().any(short) {
            findings.push(format!("xtask/src/tidy/file_sizes.rs: no short file ends with {end}; remove it"));
        }
    }
}

fn is_excused(path: &str) -> bool {
    SHORT.iter().any(|(end, _)| path.ends_with(end))
        || SHORT_FOLDERS.iter().any(|(folder, _)| path.starts_with(folder))
}

/// Whether a file only declares its child modules and re-exports them: Rust wants a file for each level.
fn only_declares_modules(source: &str) -> bool {
    let code = lexer::without_tests(&lexer::split(source).code);
    let mut modules = 0;
    let allowed = code.split(';').map(str::trim).all(|item| {
        let item = item.rsplit(']').next().unwrap_or_default().trim();
        let words: Vec<&str> = lexer::words(item).iter().map(|word| word.text).collect();
        let words: Vec<&str> =
            words.into_iter().filter(|word| !["pub", "crate", "super"].contains(word)).collect();
        modules += usize::from(words.first() == Some(&"mod"));
        matches!(words.first(), None | Some(&"mod" | &"use"))
    });
    allowed && modules > 0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn findings(path: &str, text: &str) -> Vec<String> {
        let mut findings = Vec::new();
        check(&[Source { path: path.into(), text: text.into() }], &mut findings);
        findings.retain(|finding| finding.starts_with(path));
        findings
    }

    #[test]
    fn long_and_short_files_are_reported() {
        assert!(
            findings("crates/a/src/x.rs", &"fn a() {}\n".repeat(401))[0].contains("401 lines, more than")
        );
        assert!(findings("crates/a/src/x.rs", &"fn a() {}\n".repeat(24))[0].contains("24 lines, fewer than"));
        assert!(findings("crates/a/src/x.rs", &"fn a() {}\n".repeat(25)).is_empty());
        assert!(findings("README.md", "# A\n").is_empty());
    }

    #[test]
    fn reasons_and_parents_of_modules_excuse_short_files() {
        assert!(findings("firmware/build.rs", "fn main() {}\n").is_empty());
        assert!(findings("fuzz/fuzz_targets/a.rs", "fn main() {}\n").is_empty());
        let parent = "//! Parts.\n\nmod one;\npub mod two;\n\npub use one::{A, B};\n";
        assert!(findings("crates/a/src/x.rs", parent).is_empty());
        assert_eq!(findings("crates/a/src/x.rs", "//! Alone.\n\npub use crate::A;\n").len(), 1);
        assert_eq!(findings("crates/a/src/x.rs", "mod one;\nfn a() {}\n").len(), 1);
    }
}
