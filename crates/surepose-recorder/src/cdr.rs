//! CDR, the encoding of ROS 2 messages: little-endian, each number aligned to its size.

/// Header of plain little-endian CDR.
const HEADER: [u8; 4] = [0, 1, 0, 0];

/// Encoder of a message.
#[derive(Clone, Debug)]
pub(crate) struct CdrWriter(Vec<u8>);

impl CdrWriter {
    pub(crate) fn new() -> Self {
        Self(HEADER.to_vec())
    }

    pub(crate) fn finished(self) -> Vec<u8> {
        self.0
    }

    pub(crate) fn u32(&mut self, value: u32) {
        self.put(&value.to_le_bytes());
    }

    pub(crate) fn u64(&mut self, value: u64) {
        self.put(&value.to_le_bytes());
    }

    pub(crate) fn i64(&mut self, value: i64) {
        self.put(&value.to_le_bytes());
    }

    pub(crate) fn f32(&mut self, value: f32) {
        self.put(&value.to_le_bytes());
    }

    pub(crate) fn f64(&mut self, value: f64) {
        self.put(&value.to_le_bytes());
    }

    /// A fixed number of `float64`, without a length.
    pub(crate) fn array(&mut self, values: &[f64]) {
        for value in values {
            self.f64(*value);
        }
    }

    /// A sequence of `float64`.
    pub(crate) fn sequence(&mut self, values: &[f64]) {
        self.u32(values.len() as u32);
        self.array(values);
    }

    /// A sequence of `float32`.
    pub(crate) fn singles(&mut self, values: impl ExactSizeIterator<Item = f32>) {
        self.u32(values.len() as u32);
        for value in values {
            self.f32(value);
        }
    }

    pub(crate) fn text(&mut self, text: &str) {
        self.u32(text.len() as u32 + 1);
        self.0.extend(text.as_bytes());
        self.0.push(0);
    }

    fn put<const N: usize>(&mut self, bytes: &[u8; N]) {
        let end = self.0.len() - HEADER.len();
        self.0.resize(HEADER.len() + end.next_multiple_of(N), 0);
        self.0.extend(bytes);
    }
}

/// Decoder of a message. Every method returns `None` where the message ends before.
#[derive(Clone, Debug)]
pub(crate) struct CdrReader<'a> {
    body: &'a [u8],
    at: usize,
}

impl<'a> CdrReader<'a> {
    pub(crate) fn new(message: &'a [u8]) -> Option<Self> {
        Some(Self { body: message.strip_prefix(&HEADER)?, at: 0 })
    }

    pub(crate) fn u32(&mut self) -> Option<u32> {
        self.get().map(u32::from_le_bytes)
    }

    pub(crate) fn u64(&mut self) -> Option<u64> {
        self.get().map(u64::from_le_bytes)
    }

    pub(crate) fn i64(&mut self) -> Option<i64> {
        self.get().map(i64::from_le_bytes)
    }

    pub(crate) fn f64(&mut self) -> Option<f64> {
        self.get().map(f64::from_le_bytes)
    }

    pub(crate) fn sequence(&mut self) -> Option<Vec<f64>> {
        self.list(Self::f64)
    }

    pub(crate) fn text(&mut self) -> Option<String> {
        let length = self.u32()? as usize;
        let bytes = self.body.get(self.at..self.at.checked_add(length)?)?;
        self.at += length;
        String::from_utf8(bytes.strip_suffix(&[0])?.to_vec()).ok()
    }

    /// A sequence of values that `value` reads. Memory grows with the message, not with the declared length.
    pub(crate) fn list<T>(&mut self, mut value: impl FnMut(&mut Self) -> Option<T>) -> Option<Vec<T>> {
        let length = self.u32()?;
        (0..length).map(|_| value(self)).collect()
    }

    fn get<const N: usize>(&mut self) -> Option<[u8; N]> {
        let start = self.at.next_multiple_of(N);
        let bytes = self.body.get(start..start + N)?;
        self.at = start + N;
        bytes.try_into().ok()
    }
}
