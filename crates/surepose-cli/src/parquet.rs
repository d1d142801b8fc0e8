//! Writes tables as Apache Parquet files.
//!
//! The format (<https://parquet.apache.org/docs/file-format>) is written in one form: optional columns of Booleans, integers
//! and numbers, plain encoding, one gzip-compressed page per column and row group.

mod thrift;

use std::fs::File;
use std::io::{BufWriter, Error, Result, Write};
use std::path::Path;

use flate2::Compression;
use flate2::write::GzEncoder;
use serde::Serialize;
use serde_json::{Map, Value};
use thrift::{Struct, varint};

/// Maximum number of rows in a row group, which is held in memory.
const GROUP: usize = 1 << 16;

/// First and last bytes of a Parquet file.
const MAGIC: &[u8] = b"PAR1";

/// Constants of the format: gzip codec, encodings of values and of definition levels, data page, optional column.
const GZIP: usize = 2;
const PLAIN: usize = 0;
const RLE: usize = 3;
const DATA_PAGE: usize = 0;
const OPTIONAL: usize = 1;

/// Writes a table with one row per element of `rows` and one column per field.
///
/// Fields are numbers, integers and Booleans; an absent value is null. The same rows give the same bytes.
///
/// # Errors
/// I/O errors, and rows whose fields differ in name or type.
pub(crate) fn write<T: Serialize>(path: &Path, rows: impl IntoIterator<Item = T>) -> Result<()> {
    let mut rows = rows.into_iter().map(|row| fields(&row)).peekable();
    let Some(first) = rows.peek() else { return Ok(()) };
    let mut columns: Vec<Column> = match first {
        Ok(first) => first.iter().map(|(name, value)| Column::like(name, value)).collect(),
        Err(why) => return Err(Error::other(why.to_string())),
    };
    let mut file = Output { file: BufWriter::new(File::create(path)?), offset: 0 };
    file.write(MAGIC)?;
    let (mut groups, mut count, mut held) = (Vec::new(), 0, 0);
    for row in rows {
        let row = row?;
        let fits = row.len() == columns.len()
            && row.iter().zip(&mut columns).all(|((name, value), column)| column.push(name, value));
        if !fits {
            return Err(Error::other("Parquet: rows have different fields"));
        }
        (count, held) = (count + 1, held + 1);
        if held == GROUP {
            groups.push(group(&mut file, &mut columns, held)?);
            held = 0;
        }
    }
    if held > 0 {
        groups.push(group(&mut file, &mut columns, held)?);
    }
    let root = Struct::default().text(4, "row").i32(5, columns.len());
    let mut schema = vec![root];
    schema.extend(columns.iter().map(Column::schema));
    let metadata = Struct::default()
        .i32(1, 1)
        .structures(2, schema.into_iter())
        .i64(3, count)
        .structures(4, groups.into_iter())
        .text(6, concat!("surepose version ", env!("CARGO_PKG_VERSION")))
        .finished();
    file.write(&metadata)?;
    file.write(&(metadata.len() as u32).to_le_bytes())?;
    file.write(MAGIC)?;
    file.file.flush()
}

fn fields(row: &impl Serialize) -> Result<Map<String, Value>> {
    match serde_json::to_value(row) {
        Ok(Value::Object(fields)) => Ok(fields),
        _ => Err(Error::other("Parquet: a row is not a struct")),
    }
}

/// Writes the buffered rows as a row group, clears the columns, and returns the metadata of the group.
fn group(file: &mut Output, columns: &mut [Column], rows: usize) -> Result<Struct> {
    let begin = file.offset;
    let mut size = 0;
    let mut chunks = Vec::new();
    for column in columns {
        chunks.push(column.flush(file, &mut size)?);
    }
    let written = file.offset - begin;
    Ok(Struct::default().structures(1, chunks.into_iter()).i64(2, size).i64(3, rows).i64(6, written))
}

/// A file and the number of bytes written.
struct Output {
    file: BufWriter<File>,
    offset: usize,
}

impl Output {
    fn write(&mut self, bytes: &[u8]) -> Result<()> {
        self.offset += bytes.len();
        self.file.write_all(bytes)
    }
}

/// A column: its values, and for each row whether it has one.
struct Column {
    name: String,
    values: Values,
    present: Vec<bool>,
}

/// Values of one type.
enum Values {
    Truth(Vec<bool>),
    Count(Vec<i64>),
    Number(Vec<f64>),
}

impl Column {
    /// Creates an empty column for the type of `first`; null gives a column of numbers, the only type with gaps.
    fn like(name: &str, first: &Value) -> Self {
        let values = match first {
            Value::Bool(_) => Values::Truth(Vec::new()),
            Value::Number(number) if !number.is_f64() => Values::Count(Vec::new()),
            _ => Values::Number(Vec::new()),
        };
        Self { name: name.to_owned(), values, present: Vec::new() }
    }

    /// Returns the physical type in the format.
    fn kind(&self) -> usize {
        match self.values {
            Values::Truth(_) => 0,
            Values::Count(_) => 2,
            Values::Number(_) => 5,
        }
    }

    fn schema(&self) -> Struct {
        Struct::default().i32(1, self.kind()).i32(3, OPTIONAL).text(4, &self.name)
    }

    /// Appends a value; returns `false` if its name or type does not match the column.
    fn push(&mut self, name: &str, value: &Value) -> bool {
        self.present.push(!value.is_null());
        let taken = match (&mut self.values, value) {
            (_, Value::Null) => true,
            (Values::Truth(values), Value::Bool(value)) => {
                values.push(*value);
                true
            }
            (Values::Count(values), value) => value.as_i64().map(|value| values.push(value)).is_some(),
            (Values::Number(values), value) => value.as_f64().map(|value| values.push(value)).is_some(),
            (Values::Truth(_), _) => false,
        };
        taken && self.name == name
    }

    /// Writes the values as one page, clears them, and returns the metadata. Adds the uncompressed length to `size`.
    fn flush(&mut self, file: &mut Output, size: &mut usize) -> Result<Struct> {
        let (page, rows) = (self.page(), self.present.len());
        let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(&page)?;
        let packed = encoder.finish()?;
        let of_data = Struct::default().i32(1, rows).i32(2, PLAIN).i32(3, RLE).i32(4, RLE);
        let head = Struct::default()
            .i32(1, DATA_PAGE)
            .i32(2, page.len())
            .i32(3, packed.len())
            .structure(5, of_data)
            .finished();
        let offset = file.offset;
        file.write(&head)?;
        file.write(&packed)?;
        *size += head.len() + page.len();
        let place = Struct::default()
            .i32(1, self.kind())
            .i32s(2, &[PLAIN, RLE])
            .texts(3, &[&self.name])
            .i32(4, GZIP)
            .i64(5, rows)
            .i64(6, head.len() + page.len())
            .i64(7, head.len() + packed.len())
            .i64(9, offset);
        self.present.clear();
        self.values.clear();
        Ok(Struct::default().i64(2, offset).structure(3, place))
    }

    /// Encodes the definition levels as one bit-packed run, followed by the values.
    fn page(&self) -> Vec<u8> {
        let mut levels = Vec::new();
        varint(&mut levels, (self.present.len().div_ceil(8) as u64) << 1 | 1);
        levels.extend(bits(&self.present));
        let mut page = (levels.len() as u32).to_le_bytes().to_vec();
        page.extend(levels);
        match &self.values {
            Values::Truth(values) => page.extend(bits(values)),
            Values::Count(values) => page.extend(values.iter().flat_map(|value| value.to_le_bytes())),
            Values::Number(values) => page.extend(values.iter().flat_map(|value| value.to_le_bytes())),
        }
        page
    }
}

impl Values {
    fn clear(&mut self) {
        match self {
            Self::Truth(values) => values.clear(),
            Self::Count(values) => values.clear(),
            Self::Number(values) => values.clear(),
        }
    }
}

/// Packs Booleans into bytes, the first into the lowest bit.
fn bits(truths: &[bool]) -> impl Iterator<Item = u8> {
    truths.chunks(8).map(|eight| eight.iter().rev().fold(0, |byte, &truth| byte << 1 | u8::from(truth)))
}
