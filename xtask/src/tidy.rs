//! Consistency checks of documents, dependencies, and source files.

mod dependencies;
mod documents;
mod sources;

use std::path::{Path, PathBuf};

/// Runs all checks and lists all findings.
pub(crate) fn check(root: &Path) -> Result<(), String> {
    let mut findings = Vec::new();
    let files = files(root)?;
    sources::check(&files, &mut findings);
    documents::check(root, &files, &mut findings)?;
    dependencies::check(root, &mut findings)?;
    if findings.is_empty() {
        println!("tidy: {} files, no findings", files.len());
        Ok(())
    } else {
        Err(format!("tidy: {} findings\n{}", findings.len(), findings.join("\n")))
    }
}

/// A text file of the project; its path is relative to the root.
struct Source {
    path: String,
    text: String,
}

impl Source {
    fn is_rust(&self) -> bool {
        Path::new(&self.path).extension().is_some_and(|e| e == "rs")
    }

    fn in_core(&self) -> bool {
        self.path.starts_with("crates/surepose/src/")
    }
}

/// Reads all text files of the project: sources, manifests, and documents.
fn files(root: &Path) -> Result<Vec<Source>, String> {
    let mut sources = Vec::new();
    let mut folders = vec![PathBuf::new()];
    while let Some(folder) = folders.pop() {
        let listing =
            std::fs::read_dir(root.join(&folder)).map_err(|e| format!("{}: {e}", folder.display()))?;
        for entry in listing.filter_map(Result::ok) {
            let path = folder.join(entry.file_name());
            let name = entry.file_name().to_string_lossy().into_owned();
            if root.join(&path).is_dir() {
                if !["target", ".git", "out", "node_modules", "corpus", "artifacts"].contains(&name.as_str())
                {
                    folders.push(path);
                }
            } else if let Ok(text) = std::fs::read_to_string(root.join(&path)) {
                sources.push(Source { path: path.to_string_lossy().into_owned(), text });
            }
        }
    }
    sources.sort_by(|a, b| a.path.cmp(&b.path));
    Ok(sources)
}
