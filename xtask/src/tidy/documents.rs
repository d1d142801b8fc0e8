//! Checks of documents against code: crates, citations, tests, and links exist.

use std::path::Path;

use super::source::Source;

pub(super) fn check(root: &Path, files: &[Source], findings: &mut Vec<String>) -> Result<(), String> {
    let text = |path: &str| files.iter().find(|file| file.path == path).map(|file| file.text.as_str());
    let architecture = text("ARCHITECTURE.md").ok_or("ARCHITECTURE.md is missing")?;
    let references = text("docs/references.bib").ok_or("docs/references.bib is missing")?;
    crates(root, architecture, findings)?;
    citations(files, references, findings);
    named_tests(files, findings);
    links(root, files, findings);
    Ok(())
}

/// Checks that ARCHITECTURE.md names every crate.
fn crates(root: &Path, architecture: &str, findings: &mut Vec<String>) -> Result<(), String> {
    for entry in std::fs::read_dir(root.join("crates")).map_err(|e| e.to_string())?.filter_map(Result::ok) {
        let name = entry.file_name().to_string_lossy().into_owned();
        if !architecture.contains(&format!("`{name}`")) {
            findings.push(format!("ARCHITECTURE.md: the crate `{name}` is missing"));
        }
    }
    Ok(())
}

/// Checks that every citation (a key in brackets) is in docs/references.bib.
fn citations(files: &[Source], references: &str, findings: &mut Vec<String>) {
    for file in files {
        for (number, line) in file.text.lines().enumerate() {
            for key in line.split('[').skip(1).filter_map(|rest| rest.split_once(']')).map(|(key, _)| key) {
                if is_citation(key) && !references.contains(&format!("{{{key},")) {
                    let at = format!("{}:{}", file.path, number + 1);
                    findings.push(format!("{at}: [{key}] is not in docs/references.bib"));
                }
            }
        }
    }
}

/// Whether `key` begins with a capital letter and ends with a year.
fn is_citation(key: &str) -> bool {
    let name = key.trim_end_matches(|c: char| c.is_ascii_digit());
    key.len() == name.len() + 4
        && key[name.len()..].starts_with(['1', '2'])
        && name.len() > 2
        && name.starts_with(|c: char| c.is_ascii_uppercase())
        && name.chars().all(|c| c.is_ascii_alphabetic())
}

/// Checks that every test named in "tested by `name`" exists.
fn named_tests(files: &[Source], findings: &mut Vec<String>) {
    let exists = |name: &str| {
        let function = name.rsplit("::").next().unwrap_or(name);
        files.iter().any(|file| file.is_rust() && file.text.contains(&format!("fn {function}(")))
    };
    for file in files.iter().filter(|file| !file.path.starts_with("xtask/")) {
        for (number, line) in file.text.lines().enumerate() {
            for marker in ["ested by `", "uarded by `"] {
                for rest in line.split(marker).skip(1) {
                    // A list of tests has the form: `one`, `two`.
                    for name in rest.split("`, `").filter_map(|part| part.split('`').next()) {
                        // Commands and attributes are not test names.
                        let is_name = name.chars().all(|c| c.is_alphanumeric() || c == '_' || c == ':');
                        if is_name && !exists(name) {
                            let at = format!("{}:{}", file.path, number + 1);
                            findings.push(format!("{at}: test `{name}` does not exist"));
                        }
                    }
                }
            }
        }
    }
}

/// Checks that relative links in documents have existing targets.
fn links(root: &Path, files: &[Source], findings: &mut Vec<String>) {
    for file in files.iter().filter(|file| Path::new(&file.path).extension().is_some_and(|e| e == "md")) {
        let folder = Path::new(&file.path).parent().unwrap_or(Path::new(""));
        for link in file.text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            let target = link.split('#').next().unwrap_or_default();
            let local = !target.is_empty() && !target.contains("://") && !target.contains(' ');
            if local && !root.join(folder).join(target).exists() {
                findings.push(format!("{}: broken link {target}", file.path));
            }
        }
    }
}
