//! The fields of a record, little-endian, each checked against the remaining length.

/// Record that is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::bag) enum Record<'a> {
    Schema {
        id: u16,
        name: &'a str,
    },
    Channel {
        id: u16,
        schema_id: u16,
        topic: &'a str,
        encoding: &'a str,
    },
    /// `log_time` is in nanoseconds.
    Message {
        channel_id: u16,
        log_time: u64,
        data: &'a [u8],
    },
}

/// Remaining content of a record. Every method returns `None` where the field does not fit.
pub(super) struct Content<'a> {
    bytes: &'a [u8],
}

impl<'a> Content<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }

    /// Remaining bytes.
    pub(super) fn rest(&self) -> &'a [u8] {
        self.bytes
    }

    pub(super) fn schema(&mut self) -> Option<Record<'a>> {
        let (id, name) = (self.u16()?, self.text()?);
        Some(Record::Schema { id, name })
    }

    pub(super) fn channel(&mut self) -> Option<Record<'a>> {
        let (id, schema_id) = (self.u16()?, self.u16()?);
        let (topic, encoding) = (self.text()?, self.text()?);
        Some(Record::Channel { id, schema_id, topic, encoding })
    }

    pub(super) fn message(&mut self) -> Option<Record<'a>> {
        let channel_id = self.u16()?;
        let _sequence = self.u32()?;
        let log_time = self.u64()?;
        let _publish_time = self.u64()?;
        Some(Record::Message { channel_id, log_time, data: self.bytes })
    }

    pub(super) fn u8(&mut self) -> Option<u8> {
        self.array().map(u8::from_le_bytes)
    }

    pub(super) fn u16(&mut self) -> Option<u16> {
        self.array().map(u16::from_le_bytes)
    }

    pub(super) fn u32(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    pub(super) fn u64(&mut self) -> Option<u64> {
        self.array().map(u64::from_le_bytes)
    }

    /// Text with a length prefix.
    pub(super) fn text(&mut self) -> Option<&'a str> {
        let length = self.u32()?;
        std::str::from_utf8(self.take(u64::from(length))?).ok()
    }

    pub(super) fn take(&mut self, length: u64) -> Option<&'a [u8]> {
        let (taken, rest) = self.bytes.split_at_checked(usize::try_from(length).ok()?)?;
        self.bytes = rest;
        Some(taken)
    }

    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (taken, rest) = self.bytes.split_first_chunk()?;
        self.bytes = rest;
        Some(*taken)
    }
}
