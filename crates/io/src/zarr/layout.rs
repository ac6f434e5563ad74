//! An array in chunks: how they are compressed, and where their numbers belong.

use flate2::read::{MultiGzDecoder, ZlibDecoder};

use super::compression::{inflated, unpacked};
use super::{Fault, blosc};

/// An array in chunks.
#[derive(Debug, Clone)]
pub(super) struct Layout {
    pub(super) shape: Vec<usize>,
    pub(super) chunk: Vec<usize>,
    /// The type of its numbers, such as `<u2`.
    pub(super) item: String,
    /// Bytes of a number.
    pub(super) width: usize,
    /// From the numbers of a chunk to its file.
    pub(super) codecs: Vec<Codec>,
    /// What stands before the numbers of a chunk in the name of its file, and between them.
    pub(super) key: [String; 2],
    /// What missing chunks are full of, where it is not zero.
    pub(super) fill: Option<String>,
}

/// A step from the bytes of a chunk to those of its file.
#[derive(Debug, Clone)]
pub(super) enum Codec {
    Zstd,
    Gzip,
    Zlib,
    Blosc,
    /// Four bytes at the end.
    Checksum,
    /// Smaller chunks in one file, with a list of their places at its end or at its beginning.
    Shards {
        inner: Box<Layout>,
        index_bytes: usize,
        is_index_first: bool,
    },
}

impl Layout {
    /// Bytes of the numbers of an array or of a chunk.
    pub(super) fn bytes(&self, lengths: &[usize]) -> usize {
        lengths.iter().product::<usize>() * self.width
    }

    /// Chunks along each axis.
    pub(super) fn grid(&self) -> Vec<usize> {
        self.shape.iter().zip(&self.chunk).map(|(all, own)| all.div_ceil(*own)).collect()
    }

    /// The numbers of a chunk from the bytes of its file.
    pub(super) fn decode(&self, bytes: Vec<u8>) -> Result<Vec<u8>, Fault> {
        let most = self.bytes(&self.chunk);
        // Before the last step come the checksum and what is longer compressed than not.
        let own = self
            .codecs
            .iter()
            .rev()
            .try_fold(bytes, |bytes, codec| codec.decode(bytes, most + most / 8 + 1024))?;
        match own.len() == most {
            true => Ok(own),
            false => Err(format!("a chunk has {} bytes, and should have {most}", own.len())),
        }
    }

    /// Puts the numbers of a chunk into those of the array.
    pub(super) fn put(&self, index: &[usize], chunk: &[u8], all: &mut [u8]) {
        let origin: Vec<usize> = index.iter().zip(&self.chunk).map(|(own, length)| own * length).collect();
        let extent: Vec<usize> = (0..origin.len())
            .map(|axis| self.chunk[axis].min(self.shape[axis].saturating_sub(origin[axis])))
            .collect();
        let Some((run, outer)) = extent.split_last() else { return };
        let place =
            |lengths: &[usize], at: &[usize]| lengths.iter().zip(at).fold(0, |all, (own, at)| all * own + at);
        for mut row in 0..outer.iter().product::<usize>() {
            let mut at = vec![0; extent.len()];
            for axis in (0..outer.len()).rev() {
                at[axis] = row % outer[axis];
                row /= outer[axis];
            }
            let from = place(&self.chunk, &at) * self.width;
            at.iter_mut().zip(&origin).for_each(|(own, origin)| *own += origin);
            let to = place(&self.shape, &at) * self.width;
            let length = run * self.width;
            if let (Some(to), Some(from)) = (all.get_mut(to..to + length), chunk.get(from..from + length)) {
                to.copy_from_slice(from);
            }
        }
    }

    /// The indices of all chunks.
    pub(super) fn indices(&self) -> impl Iterator<Item = Vec<usize>> {
        let grid = self.grid();
        (0..grid.iter().product::<usize>()).map(move |mut number| {
            let mut index = vec![0; grid.len()];
            for axis in (0..grid.len()).rev() {
                index[axis] = number % grid[axis];
                number /= grid[axis];
            }
            index
        })
    }

    /// The numbers of a file of several chunks, of which this is the layout.
    fn of_shard(&self, bytes: &[u8], index_bytes: usize, is_index_first: bool) -> Result<Vec<u8>, Fault> {
        let cut = || "a file of several chunks is cut".to_owned();
        let start = if is_index_first { 0 } else { bytes.len().checked_sub(index_bytes).ok_or_else(cut)? };
        let list = bytes.get(start..start.saturating_add(index_bytes)).ok_or_else(cut)?;
        let mut all = vec![0; self.bytes(&self.shape)];
        for (index, entry) in self.indices().zip(list.chunks_exact(16)) {
            let word = |at: usize| {
                entry[at..at + 8].iter().rev().fold(0_u64, |all, byte| all << 8 | u64::from(*byte))
            };
            let (from, length) = (word(0), word(8));
            // A chunk that is full of the same number is not there.
            if from == u64::MAX && length == u64::MAX {
                continue;
            }
            let (from, length) = (from as usize, length as usize);
            let own = from.checked_add(length).and_then(|end| bytes.get(from..end)).ok_or_else(cut)?;
            self.put(&index, &self.decode(own.to_vec())?, &mut all);
        }
        Ok(all)
    }
}

impl Codec {
    /// The bytes before this step, no more than `most`.
    fn decode(&self, bytes: Vec<u8>, most: usize) -> Result<Vec<u8>, Fault> {
        match self {
            Self::Zstd => unpacked(&bytes, most),
            Self::Gzip => inflated(MultiGzDecoder::new(bytes.as_slice()), most),
            Self::Zlib => inflated(ZlibDecoder::new(bytes.as_slice()), most),
            Self::Blosc => blosc::unpack(&bytes, most),
            Self::Checksum => {
                let length = bytes.len().checked_sub(4).ok_or("a chunk is cut")?;
                Ok(bytes[..length].to_vec())
            }
            Self::Shards { inner, index_bytes, is_index_first } => {
                inner.of_shard(&bytes, *index_bytes, *is_index_first)
            }
        }
    }
}
