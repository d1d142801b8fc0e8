//! First lines of documentation: a subject or a verb, not a question word.

use super::source::Source;

/// Words with which no documentation begins, lower case.
const NOT_FIRST: [&str; 10] =
    ["what", "who", "which", "where", "when", "how", "why", "nothing", "something", "same"];

/// Reports documentation of Rust items that begins with such a word.
pub(super) fn check(files: &[Source], findings: &mut Vec<String>) {
    for file in files.iter().filter(|file| file.is_rust()) {
        let mut was_doc = false;
        for (number, line) in file.text.lines().enumerate() {
            let doc = documentation(line);
            if let Some(word) = doc.filter(|_| !was_doc).and_then(first_word)
                && NOT_FIRST.contains(&word.as_str())
            {
                findings.push(format!(
                    "{}:{}: documentation begins with `{word}`; begin with the quantity, or with a verb",
                    file.path,
                    number + 1
                ));
            }
            was_doc = doc.is_some();
        }
    }
}

/// The text of a line of documentation.
fn documentation(line: &str) -> Option<&str> {
    let line = line.trim_start();
    line.strip_prefix("///").or_else(|| line.strip_prefix("//!")).filter(|text| !text.starts_with('/'))
}

/// The first word, after articles, in lower case.
fn first_word(text: &str) -> Option<String> {
    let words =
        text.split_whitespace().map(|word| word.trim_end_matches([',', '.', ':', ';']).to_lowercase());
    words.into_iter().find(|word| !["the", "a", "an"].contains(&word.as_str()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn question_words_begin_no_documentation() {
        let text = "/// What the wheels do.\nfn a() {}\n/// Speed of the wheels,\n/// where they turn.\nfn b() {}\n/// The same, slower.\n";
        let file = Source { path: "a.rs".into(), text: text.into() };
        let mut findings = Vec::new();
        check(&[file], &mut findings);
        assert_eq!(findings.len(), 2, "{findings:?}");
        assert!(findings[0].starts_with("a.rs:1: documentation begins with `what`"), "{}", findings[0]);
        assert!(findings[1].starts_with("a.rs:6:"), "{}", findings[1]);
    }
}
