//! The fields of a record, little-endian, each checked against the remaining length.

/// McapRecord that is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum McapRecord<'a> {
    /// Message type.
    Schema {
        /// Number of the type.
        id: u16,
        /// Its name.
        name: &'a str,
    },
    /// Topic.
    Channel {
        /// Number of the topic.
        id: u16,
        /// Number of its message type.
        schema_id: u16,
        /// Its name.
        topic: &'a str,
        /// Encoding of its messages.
        encoding: &'a str,
    },
    /// Message.
    Message {
        /// Number of the topic.
        channel_id: u16,
        /// Time of the log \[ns].
        log_time: u64,
        /// Encoded message.
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

    pub(super) fn schema(&mut self) -> Option<McapRecord<'a>> {
        let (id, name) = (self.u16()?, self.text()?);
        Some(McapRecord::Schema { id, name })
    }

    pub(super) fn channel(&mut self) -> Option<McapRecord<'a>> {
        let (id, schema_id) = (self.u16()?, self.u16()?);
        let (topic, encoding) = (self.text()?, self.text()?);
        Some(McapRecord::Channel { id, schema_id, topic, encoding })
    }

    pub(super) fn message(&mut self) -> Option<McapRecord<'a>> {
        let channel_id = self.u16()?;
        let _sequence = self.u32()?;
        let log_time = self.u64()?;
        let _publish_time = self.u64()?;
        Some(McapRecord::Message { channel_id, log_time, data: self.bytes })
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
