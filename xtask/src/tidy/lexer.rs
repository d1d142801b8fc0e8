//! Splits Rust source into code, comments and string literals, line by line and column by column.

/// Three texts of the same shape as the source; what belongs to another layer is blank.
pub(super) struct Layers {
    /// Everything but comments and the contents of literals.
    pub(super) code: String,
    /// Comments with their slashes.
    pub(super) comments: String,
    /// Contents of string literals.
    pub(super) strings: String,
}

/// Separates the layers of a source; an unterminated comment or literal extends to its end.
pub(super) fn split(source: &str) -> Layers {
    let chars: Vec<char> = source.chars().collect();
    let mut layers = Vec::with_capacity(chars.len());
    while layers.len() < chars.len() {
        let at = layers.len();
        let (kind, end) = next(&chars, at);
        layers.resize(end.clamp(at + 1, chars.len()), kind);
    }
    let text = |kept: Kind| {
        let one = |(c, kind): (&char, &Kind)| if *kind == kept || *c == '\n' { *c } else { ' ' };
        chars.iter().zip(&layers).map(one).collect()
    };
    Layers { code: text(Kind::Code), comments: text(Kind::Comment), strings: text(Kind::Literal) }
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Code,
    Comment,
    Literal,
}

/// The token that begins at an index: its layer and the index after it.
fn next(chars: &[char], at: usize) -> (Kind, usize) {
    let peek = |offset: usize| chars.get(at + offset).copied().unwrap_or('\0');
    let word = |c: char| c.is_alphanumeric() || c == '_';
    match (peek(0), peek(1)) {
        ('/', '/') => (Kind::Comment, find(chars, at, '\n')),
        ('/', '*') => (Kind::Comment, block_comment_end(chars, at)),
        ('"', _) => (Kind::Literal, string_end(chars, at + 1, '"')),
        ('\'', '\\') => (Kind::Literal, string_end(chars, at + 1, '\'')),
        ('\'', _) if peek(2) == '\'' => (Kind::Literal, at + 3),
        (first, _) if word(first) => {
            let end = at + chars[at..].iter().take_while(|c| word(**c)).count();
            let prefix: String = chars[at..end].iter().collect();
            let raw = ["r", "br", "cr"].contains(&prefix.as_str());
            match raw.then(|| raw_string_end(chars, end)).flatten() {
                Some(end) => (Kind::Literal, end),
                None => (Kind::Code, end),
            }
        }
        _ => (Kind::Code, at + 1),
    }
}

/// The index of a character at or after a start, or the end of the text.
fn find(chars: &[char], start: usize, wanted: char) -> usize {
    chars[start..].iter().position(|c| *c == wanted).map_or(chars.len(), |offset| start + offset)
}

/// The index after a block comment, which may contain others.
fn block_comment_end(chars: &[char], start: usize) -> usize {
    let (mut depth, mut at) = (0_usize, start);
    while at < chars.len() {
        match (chars[at], chars.get(at + 1)) {
            ('/', Some('*')) => (depth, at) = (depth + 1, at + 2),
            ('*', Some('/')) => (depth, at) = (depth - 1, at + 2),
            _ => at += 1,
        }
        if depth == 0 {
            break;
        }
    }
    at
}

/// The index after the closing quote; a backslash escapes the next character.
fn string_end(chars: &[char], start: usize, quote: char) -> usize {
    let mut at = start;
    while at < chars.len() && chars[at] != quote {
        at += if chars[at] == '\\' { 2 } else { 1 };
    }
    at + 1
}

/// The index after a raw string whose `r` ends at `start`; `None` where none begins.
fn raw_string_end(chars: &[char], start: usize) -> Option<usize> {
    let hashes = chars[start..].iter().take_while(|c| **c == '#').count();
    (chars.get(start + hashes) == Some(&'"')).then(|| {
        let mut at = start + hashes + 1;
        loop {
            at = find(chars, at, '"') + 1;
            if at > chars.len() || chars[at..].iter().take(hashes).filter(|c| **c == '#').count() == hashes {
                return at + hashes;
            }
        }
    })
}

/// Blanks every item behind `#[cfg(test)]` or `#[cfg(all(test, …))]` in a code layer.
pub(super) fn without_tests(code: &str) -> String {
    let mut kept: Vec<char> = code.chars().collect();
    for marker in ["#[cfg(test)]", "#[cfg(all(test"] {
        let marker: Vec<char> = marker.chars().collect();
        let mut at = 0;
        while at + marker.len() <= kept.len() {
            if kept[at..at + marker.len()] == marker[..] {
                let end = item_end(&kept, at);
                kept[at..end].iter_mut().filter(|c| **c != '\n').for_each(|c| *c = ' ');
            }
            at += 1;
        }
    }
    kept.into_iter().collect()
}

/// The index after the item that begins at `start`: its `;` or its closing brace at depth 0.
fn item_end(chars: &[char], start: usize) -> usize {
    let mut depth = 0_usize;
    for (at, c) in chars.iter().enumerate().skip(start) {
        match c {
            '{' | '(' | '[' => depth += 1,
            '}' | ')' | ']' => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth == 0 && (*c == ';' || *c == '}') {
            return at + 1;
        }
    }
    chars.len()
}

/// A word of a text: letters, digits and underscores.
pub(super) struct Word<'a> {
    /// The word itself.
    pub(super) text: &'a str,
    /// Its line, counted from 1.
    pub(super) line: usize,
    /// Text between the previous word and this one.
    pub(super) gap: &'a str,
}

/// Lists the words of a text in order.
pub(super) fn words(text: &str) -> Vec<Word<'_>> {
    let part = |c: char| c.is_alphanumeric() || c == '_';
    let (mut found, mut line, mut at) = (Vec::new(), 1, 0);
    while let Some(start) = text[at..].find(part).map(|offset| at + offset) {
        let end = text[start..].find(|c| !part(c)).map_or(text.len(), |offset| start + offset);
        let gap = &text[at..start];
        line += gap.matches('\n').count();
        found.push(Word { text: &text[start..end], line, gap });
        at = end;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_keep_lines_and_columns() {
        let layers = split("let a = \"x // \\\" y\"; // note 'b'\nlet c: &'a str = '\\'';\n");
        assert_eq!(layers.code, "let a =            ;            \nlet c: &'a str =     ;\n");
        assert_eq!(layers.comments.trim(), "// note 'b'");
        assert!(layers.strings.contains("x // \\\" y") && !layers.strings.contains("note"));
    }

    #[test]
    fn raw_strings_and_nested_comments_end_where_they_should() {
        let layers = split("f(r#\"a \" b\"#, r\"\\\") /* x /* y */ z */ g r#type");
        assert_eq!(layers.code.split_whitespace().collect::<Vec<_>>(), ["f(", ",", ")", "g", "r#type"]);
        assert!(layers.comments.contains("z */"));
    }

    #[test]
    fn test_items_are_blanked() {
        let code =
            "fn a() {}\n#[cfg(test)]\nmod tests { fn b() { c } }\n#[cfg(test)] mod other;\nfn d() {}\n";
        let left = without_tests(code);
        assert_eq!(left.split_whitespace().collect::<Vec<_>>(), ["fn", "a()", "{}", "fn", "d()", "{}"]);
        assert_eq!(left.lines().count(), code.lines().count());
    }
}
