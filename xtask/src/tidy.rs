//! Consistency checks of documents, dependencies, and source files.

mod dependencies;
mod doc_lines;
mod documents;
mod file_sizes;
mod import_cycles;
mod lexer;
mod source;
mod sources;
mod type_names;
mod vocabulary;

use std::path::Path;

/// Runs all checks and lists all findings.
pub(crate) fn check(root: &Path) -> Result<(), String> {
    let mut findings = Vec::new();
    let files = source::files(root)?;
    sources::check(&files, &mut findings);
    file_sizes::check(&files, &mut findings);
    type_names::check(&files, &mut findings);
    vocabulary::check(&files, &mut findings)?;
    doc_lines::check(&files, &mut findings);
    import_cycles::check(&files, &mut findings);
    documents::check(root, &files, &mut findings)?;
    dependencies::check(root, &mut findings)?;
    if findings.is_empty() {
        println!("tidy: {} files, no findings", files.len());
        Ok(())
    } else {
        Err(format!("tidy: {} findings\n{}", findings.len(), findings.join("\n")))
    }
}
