//! The words of the field: identifiers and phrases that `xtask/banned_words.txt` replaces must not come back.

use std::path::Path;

use super::lexer::{self, Word};
use super::source::Source;

/// The list of banned words, relative to the root.
const LIST: &str = "xtask/banned_words.txt";

/// Documents in which old words are history.
const EXEMPT: [&str; 1] = ["CHANGELOG.md"];

/// Reports banned identifiers in code, comments and documents, and banned phrases in those and in messages.
///
/// String literals are not searched for identifiers: configuration and JSON keys keep their names.
pub(super) fn check(files: &[Source], findings: &mut Vec<String>) -> Result<(), String> {
    let list = files.iter().find(|file| file.path == LIST).ok_or(format!("{LIST}: missing"))?;
    let banned = parse(&list.text)?;
    for file in files.iter().filter(|file| !EXEMPT.iter().any(|end| file.path.ends_with(end))) {
        for (line, word, target) in occurrences(file, &banned) {
            findings.push(format!("{}:{line}: `{word}` is banned; use: {target}", file.path));
        }
    }
    Ok(())
}

/// Scope of an entry of the list: its section.
#[derive(Clone, Copy, PartialEq)]
enum Scope {
    /// `[identifiers]`: whole identifiers of code, comments and documents.
    Identifier,
    /// `[code]`: English words, which comments and documents may use outside backquotes.
    Code,
    /// `[phrases]`: comments, documents, messages, and parts of names.
    Phrase,
}

/// A banned word or phrase and what to write instead.
struct Banned {
    /// One word for an identifier, any number for a phrase; an identifier may end with a star for any ending.
    words: Vec<String>,
    target: String,
    scope: Scope,
}

impl Banned {
    fn is(&self, word: &str) -> bool {
        match self.words[0].strip_suffix('*') {
            Some(start) => word.starts_with(start),
            None => self.words[0] == word,
        }
    }
}

/// Reads lines `old -> new` below the names of their sections; `#` begins a comment.
fn parse(list: &str) -> Result<Vec<Banned>, String> {
    let (mut banned, mut scope) = (Vec::new(), None);
    for (number, line) in list.lines().enumerate() {
        match line.split('#').next().unwrap_or_default().trim() {
            "" => {}
            "[identifiers]" => scope = Some(Scope::Identifier),
            "[code]" => scope = Some(Scope::Code),
            "[phrases]" => scope = Some(Scope::Phrase),
            entry => {
                let at = format!("{LIST}:{}", number + 1);
                let (old, new) =
                    entry.split_once(" -> ").ok_or(format!("{at}: got `{entry}`, expected `old -> new`"))?;
                let words = old.split_whitespace().map(str::to_owned).collect();
                let scope = scope.ok_or(format!("{at}: `{entry}` stands in no section; put it below one"))?;
                banned.push(Banned { words, target: new.trim().to_owned(), scope });
            }
        }
    }
    Ok(banned)
}

/// Line, word and target of every banned word of a file, in the order of lines.
fn occurrences<'a>(file: &Source, banned: &'a [Banned]) -> Vec<(usize, String, &'a str)> {
    let mut found = Vec::new();
    if file.is_rust() {
        let layers = lexer::split(&file.text);
        identifiers(&layers.code, true, banned, &mut found);
        identifiers(&layers.comments, false, banned, &mut found);
        for text in [&layers.comments, &layers.strings, &layers.code.replace('_', " ")] {
            phrases(text, banned, &mut found);
        }
    } else if Path::new(&file.path).extension().is_some_and(|e| e == "md") {
        identifiers(&file.text, false, banned, &mut found);
        phrases(&file.text, banned, &mut found);
    }
    found.sort_unstable();
    found
}

fn identifiers<'a>(
    text: &str,
    is_code: bool,
    banned: &'a [Banned],
    found: &mut Vec<(usize, String, &'a str)>,
) {
    for word in lexer::words(text) {
        let is_quoted = ["`", "::"].iter().any(|mark| word.gap.ends_with(*mark));
        let applies = |entry: &&Banned| match entry.scope {
            Scope::Identifier => true,
            Scope::Code => is_code || is_quoted,
            Scope::Phrase => false,
        };
        for entry in banned.iter().filter(applies).filter(|entry| entry.is(word.text)) {
            found.push((word.line, word.text.to_owned(), entry.target.as_str()));
        }
    }
}

/// Phrases may break over lines of one comment, but not at punctuation.
fn phrases<'a>(text: &str, banned: &'a [Banned], found: &mut Vec<(usize, String, &'a str)>) {
    let words = lexer::words(text);
    let joined = |gap: &str| gap.chars().all(|c| c.is_whitespace() || "/!*>".contains(c));
    for entry in banned.iter().filter(|entry| entry.scope == Scope::Phrase) {
        for window in words.windows(entry.words.len()) {
            let same = |(word, old): (&Word, &String)| word.text.eq_ignore_ascii_case(old);
            if window.iter().zip(&entry.words).all(same) && window[1..].iter().all(|word| joined(word.gap)) {
                found.push((window[0].line, entry.words.join(" "), entry.target.as_str()));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WORDS: &str = "# Old names.\n[identifiers]\nSpotter -> BeamProcessor\nTOP_* -> MAX_*\n\
                         [code]\nGlimpse -> ScanEvent\n[phrases]\nis handed -> takes\n";

    fn findings(path: &str, text: &str) -> Vec<String> {
        let source = |path: &str, text: &str| Source { path: path.into(), text: text.into() };
        let mut findings = Vec::new();
        check(&[source(LIST, WORDS), source(path, text)], &mut findings).unwrap();
        findings
    }

    #[test]
    fn identifiers_are_found_whole_in_code_comments_and_documents() {
        let text = "// A Spotter.\nstruct Spotter;\nstruct SpotterLike;\nconst KEY: &str = \"Spotter\";\n";
        assert_eq!(
            findings("a.rs", text),
            [1, 2].map(|line| format!("a.rs:{line}: `Spotter` is banned; use: BeamProcessor"))
        );
        assert_eq!(findings("docs/a.md", "The `Spotter`, a spotter.").len(), 1);
        assert!(findings("CHANGELOG.md", "Spotter").is_empty());
        assert!(findings("surepose.toml", "Spotter = 1").is_empty());
    }

    #[test]
    fn english_words_count_in_code_and_between_backquotes_and_stars_are_any_ending() {
        let text = "// Glimpse here, `Glimpse` and `x::Glimpse`.\nlet Glimpse = TOP_SPEED + STOP_TOP;\n";
        let lines: Vec<usize> = (1..=2).flat_map(|line| vec![line; 2]).collect();
        let report = findings("a.rs", text);
        assert!(
            report.len() == 4 && report.iter().zip(lines).all(|(r, l)| r.starts_with(&format!("a.rs:{l}:")))
        );
        assert_eq!(report[3], "a.rs:2: `TOP_SPEED` is banned; use: MAX_*");
    }

    #[test]
    fn phrases_are_found_over_lines_in_messages_and_in_names() {
        let text = "/// The filter Is\n/// handed a scan.\nfn what_is_handed() { \"it is handed\" }\n// is, handed\n";
        let report = findings("a.rs", text);
        assert_eq!(report.len(), 3, "{report:?}");
        assert!(report[0].starts_with("a.rs:1: `is handed`") && report[2].starts_with("a.rs:3"));
    }

    #[test]
    fn lists_that_are_not_understood_are_errors() {
        assert!(parse("[phrases]\nold new").is_err());
        assert!(parse("old -> new").is_err());
    }
}
