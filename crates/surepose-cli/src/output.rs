//! What a command says: one JSON object on standard output, or a table on standard error.

use std::io::{ErrorKind, Write};

use comfy_table::{CellAlignment, ContentArrangement, LineStyle, Table, presets};
use serde::Serialize;
use serde_json::{Map, Value};

use crate::error::{CliError, WIDTH};
use crate::interrupt_flags;

/// How results are printed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Output {
    /// One JSON object instead of tables.
    pub(crate) json: bool,
}

impl Output {
    /// Prints the result: `json` on standard output if asked for, else `table` on standard error.
    ///
    /// # Errors
    /// Those of [`text`]; a table is a message, and its failing is none.
    pub(crate) fn result(
        self,
        json: &Map<String, Value>,
        table: impl FnOnce() -> Table,
    ) -> Result<(), CliError> {
        if self.json {
            return text(&format!("{}\n", Value::Object(json.clone())));
        }
        say(&table());
        Ok(())
    }
}

/// A report under the names of its fields.
pub(crate) fn object(report: &impl Serialize) -> Map<String, Value> {
    match serde_json::to_value(report) {
        Ok(Value::Object(map)) => map,
        // Reports are structures of numbers and names: they always become objects.
        _ => Map::new(),
    }
}

/// Prints text on standard output; a reader that left early is no failure.
///
/// # Errors
/// What else can be wrong with standard output: a full disk takes a result away, and a script must not go on without it.
pub(crate) fn text(text: &str) -> Result<(), CliError> {
    // A result that is being printed is the one that there is.
    interrupt_flags::listen();
    let mut out = std::io::stdout().lock();
    printed(out.write_all(text.as_bytes()))
}

/// What came of printing on standard output, with what is still held back.
pub(crate) fn printed(so_far: std::io::Result<()>) -> Result<(), CliError> {
    match so_far.and_then(|()| std::io::stdout().flush()) {
        Err(problem) if problem.kind() != ErrorKind::BrokenPipe => Err(CliError::Print { problem }),
        _ => Ok(()),
    }
}

/// Prints a line on standard error; a reader that left early is no failure, as `eprintln!` would have it.
pub(crate) fn say(line: &dyn std::fmt::Display) {
    let _ = writeln!(std::io::stderr(), "{line}");
}

/// A warning, on standard error.
pub(crate) fn warning(text: &str) {
    say(&format_args!("warning: {text}"));
}

/// A table in the program's style.
pub(crate) fn table(header: &[&str]) -> Table {
    let mut table = Table::new();
    table.load_style(presets::UTF8_HORIZONTAL_ONLY.row_separator(LineStyle::none()));
    if !header.is_empty() {
        table.set_header(header);
    }
    table
}

/// Aligns every column but the first to the right, as numbers are read.
pub(crate) fn align_numbers(table: &mut Table) {
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
}

/// Wraps sentences in the table's cells, so that it is no wider than messages are.
pub(crate) fn wrapped(mut table: Table) -> Table {
    table.set_content_arrangement(ContentArrangement::Dynamic).set_width(WIDTH);
    table
}

/// Rows of a report: each key in `words`, where there are any for it, and its value as a person reads it.
pub(crate) fn worded(json: &Map<String, Value>, words: &[(&str, &str)]) -> Vec<[String; 2]> {
    let name = |key: &String| {
        let found = words.iter().find(|(it, _)| it == key);
        found.map_or_else(|| key.clone(), |(_, words)| (*words).to_owned())
    };
    json.iter().map(|(key, value)| [name(key), shown(value)]).collect()
}

/// A value as a person reads it: four digits, and counts by name.
fn shown(value: &Value) -> String {
    match value {
        Value::Number(number) if !number.is_u64() => {
            let number = number.as_f64().unwrap_or(f64::NAN);
            format!("{:.*}", (3 - number.abs().max(1e-3).log10().floor() as i32).clamp(0, 6) as usize, number)
        }
        Value::Object(counts) if counts.is_empty() => "none".to_owned(),
        Value::Object(counts) => {
            let counted = counts.iter().filter(|(_, count)| count.as_u64() != Some(0));
            let named: Vec<_> = counted.map(|(name, count)| format!("{count} {name}")).collect();
            if named.is_empty() { "none".to_owned() } else { named.join(", ") }
        }
        Value::String(text) => text.clone(),
        Value::Bool(sure) => if *sure { "yes" } else { "no" }.to_owned(),
        other => other.to_string(),
    }
}
