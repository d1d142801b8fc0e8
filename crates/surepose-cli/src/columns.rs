//! Tables in columns: Apache Parquet, which pandas, polars, DuckDB and R read without being told any types.

use std::fs::File;
use std::path::Path;
use std::sync::Arc;

use parquet::basic::{Compression, Repetition, Type as Physical};
use parquet::data_type::{BoolType, DataType, DoubleType, Int64Type};
use parquet::errors::{ParquetError, Result};
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::Type;
use serde::Serialize;
use serde_json::{Map, Value};

/// Rows that are held in memory, and written together.
const GROUP: usize = 1 << 16;

/// Writes a table, one row for each of `rows`, under the names of its fields: the columns of the CSV of the same rows.
///
/// Fields are numbers, counts and truths; what is absent is null. The same rows give the same bytes.
///
/// # Errors
/// What cannot be written, and rows whose fields differ in name or kind.
pub(crate) fn write<T: Serialize>(path: &Path, rows: impl IntoIterator<Item = T>) -> Result<()> {
    let mut rows = rows.into_iter().map(|row| fields(&row)).peekable();
    let Some(first) = rows.peek() else { return Ok(()) };
    let mut columns: Vec<Column> = match first {
        Ok(first) => first.iter().map(|(name, value)| Column::like(name, value)).collect(),
        Err(why) => return Err(ParquetError::General(why.to_string())),
    };
    let fields = columns.iter().map(Column::field).collect::<Result<Vec<_>>>()?;
    let schema = Arc::new(Type::group_type_builder("row").with_fields(fields).build()?);
    // Measured numbers hardly repeat: a dictionary of them would be the column once more.
    let properties = WriterProperties::builder()
        .set_compression(Compression::GZIP(parquet::basic::GzipLevel::default()))
        .set_dictionary_enabled(false)
        .set_statistics_enabled(EnabledStatistics::Chunk)
        .build();
    let mut file = SerializedFileWriter::new(File::create(path)?, schema, Arc::new(properties))?;
    let mut held = 0;
    for row in rows {
        let row = row?;
        let fits = row.len() == columns.len()
            && row.iter().zip(&mut columns).all(|((name, value), column)| column.push(name, value));
        if !fits {
            return Err(ParquetError::General("rows differ in their fields".to_owned()));
        }
        held += 1;
        if held == GROUP {
            flush(&mut file, &mut columns)?;
            held = 0;
        }
    }
    if held > 0 {
        flush(&mut file, &mut columns)?;
    }
    file.close()?;
    Ok(())
}

fn fields(row: &impl Serialize) -> Result<Map<String, Value>> {
    match serde_json::to_value(row) {
        Ok(Value::Object(fields)) => Ok(fields),
        _ => Err(ParquetError::General("a row is no structure of fields".to_owned())),
    }
}

fn flush(file: &mut SerializedFileWriter<File>, columns: &mut [Column]) -> Result<()> {
    let mut group = file.next_row_group()?;
    for column in columns {
        column.flush(&mut group)?;
    }
    group.close()?;
    Ok(())
}

/// One column: its values, and for each row whether it has one.
struct Column {
    name: String,
    values: Values,
    present: Vec<i16>,
}

/// Values of one kind.
enum Values {
    Truth(Vec<bool>),
    Count(Vec<i64>),
    Number(Vec<f64>),
}

impl Column {
    /// An empty column for values of the kind of `first`; a number where there is none, as what may be absent is one.
    fn like(name: &str, first: &Value) -> Self {
        let values = match first {
            Value::Bool(_) => Values::Truth(Vec::new()),
            Value::Number(number) if !number.is_f64() => Values::Count(Vec::new()),
            _ => Values::Number(Vec::new()),
        };
        Self { name: name.to_owned(), values, present: Vec::new() }
    }

    fn field(&self) -> Result<Arc<Type>> {
        let physical = match self.values {
            Values::Truth(_) => Physical::BOOLEAN,
            Values::Count(_) => Physical::INT64,
            Values::Number(_) => Physical::DOUBLE,
        };
        let field = Type::primitive_type_builder(&self.name, physical);
        Ok(Arc::new(field.with_repetition(Repetition::OPTIONAL).build()?))
    }

    /// Takes a value, if it belongs here.
    fn push(&mut self, name: &str, value: &Value) -> bool {
        self.present.push(i16::from(!value.is_null()));
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

    fn flush(&mut self, group: &mut SerializedRowGroupWriter<'_, File>) -> Result<()> {
        match &mut self.values {
            Values::Truth(values) => put::<BoolType>(group, values, &self.present)?,
            Values::Count(values) => put::<Int64Type>(group, values, &self.present)?,
            Values::Number(values) => put::<DoubleType>(group, values, &self.present)?,
        }
        self.present.clear();
        Ok(())
    }
}

fn put<D: DataType>(
    group: &mut SerializedRowGroupWriter<'_, File>,
    values: &mut Vec<D::T>,
    present: &[i16],
) -> Result<()> {
    let Some(mut column) = group.next_column()? else {
        return Err(ParquetError::General("more columns than the schema has".to_owned()));
    };
    column.typed::<D>().write_batch(values, Some(present), None)?;
    column.close()?;
    values.clear();
    Ok(())
}
