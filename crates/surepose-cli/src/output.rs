//! Prints results: one JSON object on standard output, or a table on standard error.

use std::io::{ErrorKind, Write};

use comfy_table::{CellAlignment, ContentArrangement, LineStyle, Table, presets};
use serde::Serialize;
use serde_json::{Map, Value};

use crate::error::{CliError, WIDTH};
use crate::{capture, interrupt_flags};

/// The output format of results.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Output {
    /// Whether to print one JSON object instead of a table.
    pub(crate) json: bool,
}

impl Output {
    /// Prints the result: `json` on standard output with `--json`, else `table` on standard error.
    ///
    /// # Errors
    /// Those of [`text`]. A failure to print a table is ignored.
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

/// Serializes a report to a JSON object with the names of its fields.
pub(crate) fn object(report: &impl Serialize) -> Map<String, Value> {
    match serde_json::to_value(report) {
        Ok(Value::Object(map)) => map,
        // Reports are structs, which serialize to objects.
        _ => Map::new(),
    }
}

/// Prints text on standard output; a closed pipe is not an error.
///
/// # Errors
/// [`CliError::Print`] for any other failure, for example a full disk.
pub(crate) fn text(text: &str) -> Result<(), CliError> {
    if capture::result(text) {
        return Ok(());
    }
    // A result that is being printed is the one that there is.
    interrupt_flags::listen();
    let mut out = std::io::stdout().lock();
    printed(out.write_all(text.as_bytes()))
}

/// Flushes standard output and converts a failure to an error; a closed pipe is not an error.
pub(crate) fn printed(so_far: std::io::Result<()>) -> Result<(), CliError> {
    match so_far.and_then(|()| std::io::stdout().flush()) {
        Err(problem) if problem.kind() != ErrorKind::BrokenPipe => Err(CliError::Print { problem }),
        _ => Ok(()),
    }
}

/// Prints a line on standard error; unlike `eprintln!`, a closed pipe is ignored.
pub(crate) fn say(line: &dyn std::fmt::Display) {
    if capture::message(line) {
        return;
    }
    let _ = writeln!(std::io::stderr(), "{line}");
}

/// Prints a warning on standard error.
pub(crate) fn warning(text: &str) {
    say(&format_args!("warning: {text}"));
}

/// Creates a table in the style of the program.
pub(crate) fn table(header: &[&str]) -> Table {
    let mut table = Table::new();
    table.load_style(presets::UTF8_HORIZONTAL_ONLY.row_separator(LineStyle::none()));
    if !header.is_empty() {
        table.set_header(header);
    }
    table
}

/// Right-aligns every column except the first.
pub(crate) fn align_numbers(table: &mut Table) {
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
}

/// Wraps the cells of a table to the width of messages.
pub(crate) fn wrapped(mut table: Table) -> Table {
    table.set_content_arrangement(ContentArrangement::Dynamic).set_width(WIDTH);
    table
}

/// Formats a report as rows of label and value; a key without a label in `words` is printed as it is.
pub(crate) fn worded(json: &Map<String, Value>, words: &[(&str, &str)]) -> Vec<[String; 2]> {
    let name = |key: &String| {
        let found = words.iter().find(|(it, _)| it == key);
        found.map_or_else(|| key.clone(), |(_, words)| (*words).to_owned())
    };
    json.iter().map(|(key, value)| [name(key), shown_value(value)]).collect()
}

/// Formats a value: numbers with four significant digits, counts by name.
pub(crate) fn shown_value(value: &Value) -> String {
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
