//! Decodes Zstandard streams block by block, in bounded memory.

use std::io::{BufRead, Error, ErrorKind, Read};

use ruzstd::decoding::errors::{FrameDecoderError, ReadFrameHeaderError};
use ruzstd::decoding::{BlockDecodingStrategy, FrameDecoder};

/// First bytes of a Zstandard frame (RFC 8878, section 3.1.1).
pub(super) const MAGIC: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];

/// Decodes every frame of a Zstandard stream.
///
/// Memory is bounded by the window that a frame declares, at most 128 MiB. A stream that ends within a frame yields its
/// complete blocks, then an error of kind [`ErrorKind::UnexpectedEof`]. Damage gives [`ErrorKind::InvalidData`].
pub struct ZstdReader<R> {
    source: R,
    decoder: FrameDecoder,
    in_frame: bool,
    is_cut: bool,
}

/// An empty last block and space for a checksum. It ends a truncated frame, so that the decoder releases the data of the
/// complete blocks.
const LAST_BLOCK: [u8; 7] = [1, 0, 0, 0, 0, 0, 0];

impl<R: BufRead> ZstdReader<R> {
    /// Creates a decoder of the frames of `source`.
    pub fn new(source: R) -> Self {
        Self { source, decoder: FrameDecoder::new(), in_frame: false, is_cut: false }
    }

    /// Reads the next frame header and skips skippable frames; returns `false` at the end of the stream.
    fn open_frame(&mut self) -> std::io::Result<bool> {
        while !self.source.fill_buf()?.is_empty() {
            match self.decoder.reset(&mut self.source) {
                Ok(()) => return Ok(true),
                Err(problem) => match skippable_length(&problem) {
                    Some(length) => self.skip(u64::from(length))?,
                    None => return Err(self.failure(&problem)),
                },
            }
        }
        Ok(false)
    }

    fn skip(&mut self, length: u64) -> std::io::Result<()> {
        let skipped = std::io::copy(&mut self.source.by_ref().take(length), &mut std::io::sink())?;
        if skipped < length { Err(ErrorKind::UnexpectedEof.into()) } else { Ok(()) }
    }

    /// Decodes one block of the frame.
    fn decode_block(&mut self) -> std::io::Result<()> {
        let one = || BlockDecodingStrategy::UptoBlocks(1);
        let Err(problem) = self.decoder.decode_blocks(&mut self.source, one()) else { return Ok(()) };
        let failure = self.failure(&problem);
        self.is_cut = failure.kind() == ErrorKind::UnexpectedEof;
        if self.is_cut && self.decoder.decode_blocks(&LAST_BLOCK[..], one()).is_ok() {
            return Ok(());
        }
        Err(failure)
    }

    /// Converts a decoder error: truncated if the source is at its end, else damaged.
    fn failure(&mut self, problem: &FrameDecoderError) -> Error {
        match self.source.fill_buf() {
            Ok([]) => Error::new(ErrorKind::UnexpectedEof, problem.to_string()),
            Ok(_) => Error::new(ErrorKind::InvalidData, problem.to_string()),
            Err(unreadable) => unreadable,
        }
    }
}

impl<R: BufRead> Read for ZstdReader<R> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        if buffer.is_empty() {
            return Ok(0);
        }
        loop {
            if !self.in_frame {
                if self.is_cut {
                    return Err(Error::new(ErrorKind::UnexpectedEof, "zstd: the stream ends within a frame"));
                }
                self.in_frame = self.open_frame()?;
                if !self.in_frame {
                    return Ok(0);
                }
            }
            if self.decoder.can_collect() == 0 && !self.decoder.is_finished() {
                self.decode_block()?;
            }
            let read = self.decoder.read(buffer)?;
            if read > 0 {
                return Ok(read);
            }
            self.in_frame = !self.decoder.is_finished();
        }
    }
}

/// Returns the length of a skippable frame, which the decoder reports as an error; `None` for other errors.
fn skippable_length(problem: &FrameDecoderError) -> Option<u32> {
    match problem {
        FrameDecoderError::ReadFrameHeaderError(ReadFrameHeaderError::SkipFrame { length, .. }) => {
            Some(*length)
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use std::io::{ErrorKind, Read};

    use ruzstd::encoding::{CompressionLevel, compress_to_vec};

    use super::ZstdReader;

    /// Decodes `bytes`; returns the data and how the stream ended.
    fn decoded(bytes: &[u8]) -> (Vec<u8>, Result<usize, ErrorKind>) {
        let mut plain = Vec::new();
        let read = ZstdReader::new(bytes).read_to_end(&mut plain);
        (plain, read.map_err(|error| error.kind()))
    }

    #[test]
    fn all_frames_are_decoded() {
        let text: Vec<u8> = (0..300_000_u32).flat_map(|i| (i / 7).to_le_bytes()).collect();
        let frame = compress_to_vec(&text[..], CompressionLevel::Fastest);
        assert_eq!(decoded(&frame), (text.clone(), Ok(text.len())));
        let skippable = [0x50, 0x2a, 0x4d, 0x18, 3, 0, 0, 0, 7, 7, 7];
        let (plain, end) = decoded(&[&frame[..], &skippable, &frame].concat());
        assert!(plain == [&text[..], &text].concat() && end == Ok(2 * text.len()));
        assert_eq!(decoded(&[]), (Vec::new(), Ok(0)));
    }

    #[test]
    fn complete_blocks_of_a_truncated_stream_are_decoded() {
        let text: Vec<u8> = (0..300_000_u32).flat_map(|i| (i / 7).to_le_bytes()).collect();
        let frame = compress_to_vec(&text[..], CompressionLevel::Fastest);
        let (plain, end) = decoded(&frame[..frame.len() / 2]);
        assert_eq!(end, Err(ErrorKind::UnexpectedEof));
        assert!(plain.len() > text.len() / 4 && text.starts_with(&plain), "{}", plain.len());
    }

    #[test]
    fn damaged_streams_give_errors() {
        let frame = compress_to_vec(&[7_u8; 1000][..], CompressionLevel::Fastest);
        for place in 0..frame.len() {
            let mut damaged = frame.clone();
            damaged[place] ^= 0x55;
            let _ = decoded(&damaged);
        }
        let (plain, end) = decoded(b"\x28\xb5\x2f\xfdno frame, and more of it");
        assert!(plain.is_empty() && end.is_err());
        // A window of 2^41 bytes is declared.
        assert_eq!(decoded(&[0x28, 0xb5, 0x2f, 0xfd, 0, 0xf8, 1, 0, 0, 9]).1, Err(ErrorKind::InvalidData));
    }
}
