//! Code that the sources of the core must not contain.

use super::source::Source;

/// Code that is forbidden in the core, with the reason.
const NOT_IN_CORE: [(&str, &str); 8] = [
    ("std::", "the core is no_std"),
    ("extern crate alloc", "the core does not allocate"),
    ("unsafe ", "the core has no unsafe code"),
    (".unwrap()", "the core cannot panic"),
    (".expect(", "the core cannot panic"),
    ("panic!(", "the core cannot panic"),
    ("unreachable!(", "the core cannot panic"),
    ("Instant", "the core does not read clocks"),
];

pub(super) fn check(files: &[Source], findings: &mut Vec<String>) {
    for file in files.iter().filter(|file| file.is_rust() && file.in_core()) {
        if !file.path.contains("tests") {
            core(file, findings);
        }
    }
    let forbids = |file: &Source| file.text.contains("#![forbid(unsafe_code)]");
    let root = files.iter().find(|file| file.path == "crates/surepose/src/lib.rs");
    if !root.is_some_and(|file| forbids(file) && file.text.contains("#![no_std]")) {
        findings.push(
            "crates/surepose/src/lib.rs: must contain #![no_std] and #![forbid(unsafe_code)]".to_owned(),
        );
    }
}

fn core(file: &Source, findings: &mut Vec<String>) {
    let code = file.text.split("#[cfg(test)]").next().unwrap_or_default();
    for (number, line) in code.lines().enumerate() {
        let line = line.split("//").next().unwrap_or_default();
        for (word, why) in NOT_IN_CORE {
            if line.contains(word) {
                findings.push(format!("{}:{}: `{}`: {why}", file.path, number + 1, word.trim()));
            }
        }
    }
}
