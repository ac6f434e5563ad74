//! TIFF files compressed with Zstandard, made into ones that are not compressed.

use std::collections::BTreeSet;
use std::io::Read;

use ruzstd::decoding::StreamingDecoder;

use crate::memory::{SIZE_LIMIT, machine_memory};

/// The numbers of the method, of today and of earlier drafts.
const METHODS: [u64; 2] = [50000, 34926];
const UNCOMPRESSED: u64 = 1;
/// The kind of values of two bytes.
const SHORT: u64 = 3;

/// Tags of a page.
mod tag {
    pub(super) const COMPRESSION: u16 = 259;
    /// Where strips or tiles begin, and how long they are.
    pub(super) const CHUNKS: [[u16; 2]; 2] = [[273, 279], [324, 325]];
}

/// The same file with the strips and tiles of such pages decompressed, at its end; `None` if there are none, or if the file is not
/// whole, which is told when it is read.
pub(super) fn unpacked(bytes: &[u8]) -> Result<Option<Vec<u8>>, String> {
    let Some(mut file) = File::new(bytes) else { return Ok(None) };
    let Some(pages) = file.pages() else { return Ok(None) };
    let mut is_packed = false;
    for page in pages {
        is_packed |= file.unpack(&page)?;
    }
    Ok(is_packed.then_some(file.bytes))
}

/// A file with its words.
struct File {
    bytes: Vec<u8>,
    is_big_endian: bool,
    /// Whether offsets have 8 bytes instead of 4.
    is_large: bool,
    /// The most that it may grow to.
    limit: u64,
}

/// An entry of a page: its tag, the kind and the number of its values, and where they or their place stand.
#[derive(Debug, Clone, Copy)]
struct Entry {
    tag: u16,
    kind: u16,
    count: usize,
    at: usize,
}

impl File {
    fn new(bytes: &[u8]) -> Option<Self> {
        let is_big_endian = match bytes.get(..2)? {
            b"II" => false,
            b"MM" => true,
            _ => return None,
        };
        let limit = machine_memory().map_or(SIZE_LIMIT, |memory| SIZE_LIMIT.min(memory / 4));
        let mut file = Self { bytes: Vec::new(), is_big_endian, is_large: false, limit };
        file.bytes.extend_from_slice(bytes);
        file.is_large = file.word(2, 2)? == 43;
        Some(file)
    }

    /// A number of so many bytes.
    fn word(&self, at: usize, length: usize) -> Option<u64> {
        let own = self.bytes.get(at..at.checked_add(length)?)?;
        let join = |all: u64, byte: &u8| all << 8 | u64::from(*byte);
        Some(if self.is_big_endian { own.iter().fold(0, join) } else { own.iter().rev().fold(0, join) })
    }

    fn write(&mut self, at: usize, length: usize, value: u64) -> Option<()> {
        let mut own = value.to_le_bytes();
        own[..length].reverse();
        if !self.is_big_endian {
            own[..length].reverse();
        }
        self.bytes.get_mut(at..at.checked_add(length)?)?.copy_from_slice(&own[..length]);
        Some(())
    }

    /// Bytes of an offset.
    fn width(&self) -> usize {
        if self.is_large { 8 } else { 4 }
    }

    /// The entries of all pages.
    fn pages(&self) -> Option<Vec<Vec<Entry>>> {
        let width = self.width();
        let (of_count, of_entry) = if self.is_large { (8, 20) } else { (2, 12) };
        let mut at = self.word(width, width)? as usize;
        let (mut pages, mut seen) = (Vec::new(), BTreeSet::new());
        while at != 0 && seen.insert(at) {
            let count = self.word(at, of_count)? as usize;
            let begin = at.checked_add(of_count)?;
            // More entries than the file has bytes for are no entries.
            let end =
                count.checked_mul(of_entry)?.checked_add(begin).filter(|end| *end <= self.bytes.len())?;
            let entry = |at: usize| {
                let count = self.word(at + 4, width)? as usize;
                Some(Entry { tag: self.word(at, 2)? as u16, kind: self.word(at + 2, 2)? as u16, count, at })
            };
            pages.push((begin..end).step_by(of_entry).map(entry).collect::<Option<Vec<_>>>()?);
            at = self.word(end, width)? as usize;
        }
        Some(pages)
    }

    /// The values of an entry.
    fn values(&self, entry: Entry) -> Option<Vec<u64>> {
        let length = match entry.kind {
            3 => 2,
            4 => 4,
            16 => 8,
            _ => return None,
        };
        let bytes = entry.count.checked_mul(length).filter(|bytes| *bytes <= self.bytes.len())?;
        let inline = entry.at + 4 + self.width();
        let from = if bytes <= self.width() { inline } else { self.word(inline, self.width())? as usize };
        (0..entry.count).map(|k| self.word(from.checked_add(k * length)?, length)).collect()
    }

    /// Replaces the values of an entry by offsets or lengths.
    fn replace(&mut self, entry: Entry, values: &[u64]) -> Option<()> {
        let width = self.width();
        let inline = entry.at + 4 + width;
        self.write(entry.at + 2, 2, if self.is_large { 16 } else { 4 })?;
        if let [value] = values {
            return self.write(inline, width, *value);
        }
        let from = self.bytes.len();
        self.bytes.resize(from + values.len() * width, 0);
        for (k, value) in values.iter().enumerate() {
            self.write(from + k * width, width, *value)?;
        }
        self.write(inline, width, from as u64)
    }

    /// Decompresses the chunks of a page, if they are of this kind.
    fn unpack(&mut self, page: &[Entry]) -> Result<bool, String> {
        let find = |tag: u16| page.iter().copied().find(|entry| entry.tag == tag);
        let Some(compression) = find(tag::COMPRESSION) else { return Ok(false) };
        let method = self.values(compression).and_then(|values| values.first().copied());
        if !method.is_some_and(|method| METHODS.contains(&method)) {
            return Ok(false);
        }
        let chunks = tag::CHUNKS.into_iter().find_map(|[begin, length]| find(begin).zip(find(length)));
        let (begins, lengths) = chunks.ok_or("strips and tiles are missing")?;
        let cut = || "strips or tiles are cut".to_owned();
        let places = self.values(begins).zip(self.values(lengths)).ok_or_else(cut)?;
        let (mut at, mut long) = (Vec::new(), Vec::new());
        for (begin, length) in places.0.into_iter().zip(places.1) {
            let range = begin as usize..(begin as usize).saturating_add(length as usize);
            let packed = self.bytes.get(range).ok_or_else(cut)?;
            let room = self.limit.saturating_sub(self.bytes.len() as u64);
            let mut own = Vec::new();
            let decoder = StreamingDecoder::new(packed).map_err(|error| error.to_string())?;
            decoder.take(room + 1).read_to_end(&mut own).map_err(|error| error.to_string())?;
            if own.len() as u64 > room {
                return Err(format!("decompresses to more than {} bytes", self.limit));
            }
            at.push(self.bytes.len() as u64);
            long.push(own.len() as u64);
            self.bytes.extend(own);
        }
        if !self.is_large && self.bytes.len() as u64 > u64::from(u32::MAX) {
            return Err(
                "decompresses to more than 4 GB; write it as a large TIFF or without compression".into()
            );
        }
        let inline = compression.at + 4 + self.width();
        let replaced = self.replace(begins, &at).and_then(|()| self.replace(lengths, &long));
        let replaced = replaced.and_then(|()| self.write(compression.at + 2, 2, SHORT));
        replaced.and_then(|()| self.write(inline, 2, UNCOMPRESSED)).ok_or_else(cut)?;
        Ok(true)
    }
}
