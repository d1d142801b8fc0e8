//! Encodes the Thrift compact protocol, which Parquet uses for metadata: <https://thrift.apache.org>.

/// A Thrift struct, written field by field in ascending order of the field ids.
#[derive(Default)]
pub(super) struct Struct {
    bytes: Vec<u8>,
    last: u8,
}

const I32: u8 = 5;
const I64: u8 = 6;
const BINARY: u8 = 8;
const LIST: u8 = 9;
const STRUCT: u8 = 12;

impl Struct {
    /// Appends a 32-bit integer field.
    pub(super) fn i32(mut self, field: u8, value: usize) -> Self {
        self.head(field, I32);
        varint(&mut self.bytes, zigzag(value));
        self
    }

    /// Appends a 64-bit integer field.
    pub(super) fn i64(mut self, field: u8, value: usize) -> Self {
        self.head(field, I64);
        varint(&mut self.bytes, zigzag(value));
        self
    }

    pub(super) fn text(mut self, field: u8, text: &str) -> Self {
        self.head(field, BINARY);
        binary(&mut self.bytes, text);
        self
    }

    pub(super) fn structure(mut self, field: u8, value: Self) -> Self {
        self.head(field, STRUCT);
        self.bytes.extend(value.finished());
        self
    }

    pub(super) fn structures(mut self, field: u8, values: impl ExactSizeIterator<Item = Self>) -> Self {
        self.list(field, STRUCT, values.len());
        values.for_each(|value| self.bytes.extend(value.finished()));
        self
    }

    pub(super) fn i32s(mut self, field: u8, values: &[usize]) -> Self {
        self.list(field, I32, values.len());
        for &value in values {
            varint(&mut self.bytes, zigzag(value));
        }
        self
    }

    pub(super) fn texts(mut self, field: u8, values: &[&str]) -> Self {
        self.list(field, BINARY, values.len());
        for text in values {
            binary(&mut self.bytes, text);
        }
        self
    }

    /// Returns the bytes with the stop field.
    pub(super) fn finished(mut self) -> Vec<u8> {
        self.bytes.push(0);
        self.bytes
    }

    /// Appends a field header with the difference of the field ids, which is at most 15 here.
    fn head(&mut self, field: u8, kind: u8) {
        self.bytes.push((field - self.last) << 4 | kind);
        self.last = field;
    }

    fn list(&mut self, field: u8, kind: u8, length: usize) {
        self.head(field, LIST);
        if length < 15 {
            self.bytes.push((length as u8) << 4 | kind);
        } else {
            self.bytes.push(0xf0 | kind);
            varint(&mut self.bytes, length as u64);
        }
    }
}

/// Appends an unsigned LEB128 integer: groups of seven bits, the lowest first.
pub(super) fn varint(bytes: &mut Vec<u8>, mut number: u64) {
    while number >= 0x80 {
        bytes.push(number as u8 | 0x80);
        number >>= 7;
    }
    bytes.push(number as u8);
}

fn binary(bytes: &mut Vec<u8>, text: &str) {
    varint(bytes, text.len() as u64);
    bytes.extend(text.as_bytes());
}

/// Encodes a nonnegative integer in zigzag form, with the sign in the lowest bit.
fn zigzag(number: usize) -> u64 {
    (number as u64) << 1
}
