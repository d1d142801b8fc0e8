//! The modules of a crate: their files, children, definitions and imports.

use std::collections::{BTreeMap, BTreeSet};

use super::super::{lexer, source::Source};

/// A module, with a file of its own or within another's.
#[derive(Default)]
pub(super) struct Module {
    /// The index of its file.
    pub(super) file: usize,
    /// The enclosing module; the crate's root is its own parent.
    pub(super) parent: usize,
    pub(super) children: BTreeMap<String, usize>,
    pub(super) definitions: BTreeSet<String>,
    pub(super) imports: Vec<Import>,
    /// Paths in the code outside `use`, each with its line.
    pub(super) paths: Vec<(Vec<String>, usize)>,
}

/// One name that a `use` brings into scope.
pub(super) struct Import {
    /// The name in scope; `*` for all of a module.
    pub(super) name: String,
    pub(super) path: Vec<String>,
    pub(super) line: usize,
    /// Whether it is re-exported.
    pub(super) is_public: bool,
}

/// The modules of one crate; index 0 is the root.
pub(super) struct Crate {
    /// Paths of the files.
    pub(super) files: Vec<String>,
    pub(super) modules: Vec<Module>,
}

impl Crate {
    /// Reads the module tree below a root file; `None` if that file is not among the sources.
    pub(super) fn read(sources: &[Source], root: &str) -> Option<Self> {
        let mut tree = Self { files: Vec::new(), modules: vec![Module::default()] };
        let folder = root.rsplit_once('/')?.0.to_owned();
        tree.read_file(sources, root, 0, &folder).then_some(tree)
    }

    /// Reads a file into a module whose children lie in `folder`.
    fn read_file(&mut self, sources: &[Source], path: &str, module: usize, folder: &str) -> bool {
        let Some(source) = sources.iter().find(|source| source.path == path) else { return false };
        let code = lexer::without_tests(&lexer::split(&source.text).code);
        self.modules[module].file = self.files.len();
        self.files.push(path.to_owned());
        let tokens = tokens(&code);
        Reader { tree: self, sources, tokens: &tokens }.items(0, tokens.len(), module, folder);
        true
    }

    fn add_child(&mut self, parent: usize, name: &str) -> usize {
        let child = self.modules.len();
        self.modules.push(Module { parent, file: self.modules[parent].file, ..Module::default() });
        self.modules[parent].children.insert(name.to_owned(), child);
        child
    }
}

type Token<'a> = (&'a str, usize);

/// Words, `::` and single marks, each with its line.
fn tokens(code: &str) -> Vec<Token<'_>> {
    let (mut found, mut line, mut at) = (Vec::new(), 1, 0);
    while let Some(first) = code[at..].chars().next() {
        let word = |c: char| c.is_alphanumeric() || c == '_';
        let length = if word(first) {
            code[at..].find(|c| !word(c)).unwrap_or(code.len() - at)
        } else if code[at..].starts_with("::") {
            2
        } else {
            first.len_utf8()
        };
        line += usize::from(first == '\n');
        if !first.is_whitespace() {
            found.push((&code[at..at + length], line));
        }
        at += length;
    }
    found
}

struct Reader<'a, 'b> {
    tree: &'b mut Crate,
    sources: &'b [Source],
    tokens: &'b [Token<'a>],
}

impl<'a> Reader<'a, '_> {
    /// Reads the tokens of one module.
    fn items(&mut self, mut at: usize, end: usize, module: usize, folder: &str) {
        let mut depth = 0_usize;
        while at < end {
            let (token, line) = self.tokens[at];
            let name = self.text(at + 1);
            match token {
                "{" | "(" | "[" => depth += 1,
                "}" | ")" | "]" => depth = depth.saturating_sub(1),
                "mod" if depth == 0 && self.text(at + 2) == ";" => {
                    let child = self.tree.add_child(module, name);
                    let folder = format!("{folder}/{name}");
                    if !self.tree.read_file(self.sources, &format!("{folder}.rs"), child, &folder) {
                        self.tree.read_file(self.sources, &format!("{folder}/mod.rs"), child, &folder);
                    }
                }
                "mod" if depth == 0 && self.text(at + 2) == "{" => {
                    let child = self.tree.add_child(module, name);
                    let close = self.closing(at + 2);
                    self.items(at + 3, close, child, &format!("{folder}/{name}"));
                    at = close;
                }
                "use" if self.text(at + 1) != "<" => {
                    let is_public = at > 0 && ["pub", ")"].contains(&self.text(at - 1));
                    let mut imports = Vec::new();
                    at = self.import(at + 1, &mut Vec::new(), &mut imports);
                    for import in &mut imports {
                        import.is_public = is_public && depth == 0;
                    }
                    self.tree.modules[module].imports.append(&mut imports);
                }
                "struct" | "enum" | "union" | "trait" | "type" | "fn" | "const" | "static" if depth == 0 => {
                    self.tree.modules[module].definitions.insert(name.to_owned());
                }
                "macro_rules" if depth == 0 => {
                    let name = self.text(at + 2).to_owned();
                    self.tree.modules[module].definitions.insert(name);
                    at = self.closing(at + 3);
                }
                _ if is_word(token) && self.text(at + 1) == "::" => {
                    let mut path = vec![token.to_owned()];
                    while self.text(at + 1) == "::" && is_word(self.text(at + 2)) {
                        path.push(self.text(at + 2).to_owned());
                        at += 2;
                    }
                    self.tree.modules[module].paths.push((path, line));
                }
                _ => {}
            }
            at += 1;
        }
    }

    /// Reads one branch of a `use` and returns the index of the mark after it.
    fn import(&self, mut at: usize, prefix: &mut Vec<String>, imports: &mut Vec<Import>) -> usize {
        let length = prefix.len();
        let line = self.tokens.get(at).map_or(0, |token| token.1);
        let mut push = |path: &[String], name: &str| {
            let (name, path) = (name.to_owned(), path.to_vec());
            imports.push(Import { name, path, line, is_public: false });
        };
        loop {
            match self.text(at) {
                "{" => {
                    at += 1;
                    while !["}", ""].contains(&self.text(at)) {
                        at = self.import(at, prefix, imports);
                        at += usize::from(self.text(at) == ",");
                    }
                    at += 1;
                    break;
                }
                "::" => at += 1,
                "*" => {
                    push(prefix, "*");
                    at += 1;
                    break;
                }
                word if is_word(word) => {
                    // `part::{self}` names `part`.
                    if word != "self" || prefix.is_empty() {
                        prefix.push(word.to_owned());
                    }
                    at += 1;
                    if self.text(at) != "::" {
                        let renamed = self.text(at) == "as";
                        let last = prefix.last().map_or("", String::as_str);
                        push(prefix, if renamed { self.text(at + 1) } else { last });
                        at += if renamed { 2 } else { 0 };
                        break;
                    }
                }
                _ => break,
            }
        }
        prefix.truncate(length);
        at
    }

    fn text(&self, at: usize) -> &'a str {
        self.tokens.get(at).map_or("", |token| token.0)
    }

    /// The index of the bracket that closes the one at `open`.
    fn closing(&self, open: usize) -> usize {
        let mut depth = 0_usize;
        for (at, (token, _)) in self.tokens.iter().enumerate().skip(open) {
            match *token {
                "{" | "(" | "[" => depth += 1,
                "}" | ")" | "]" => depth = depth.saturating_sub(1),
                _ => {}
            }
            if depth == 0 {
                return at;
            }
        }
        self.tokens.len()
    }
}

fn is_word(token: &str) -> bool {
    token.starts_with(|c: char| c.is_alphabetic() || c == '_')
}
