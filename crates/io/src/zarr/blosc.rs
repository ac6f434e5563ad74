//! Buffers as Blosc 1 packs them: blocks, of which each may be compressed in parts, with bytes of a kind put side by side.

use super::Fault;
use super::compression::{inflated, unpacked};

/// Bytes before the blocks.
const HEADER: usize = 16;
/// Parts of a block are at least so long, in elements.
const SHORTEST_PART: usize = 128;
/// Elements of more bytes are not split.
const WIDEST_SPLIT: usize = 16;

/// What the flags of a buffer say.
mod flag {
    pub(super) const SHUFFLED: u8 = 1;
    pub(super) const COPIED: u8 = 2;
    pub(super) const BITS_SHUFFLED: u8 = 4;
    pub(super) const WHOLE_BLOCKS: u8 = 16;
}

/// What a buffer holds, if it is no more than `most` bytes.
pub(super) fn unpack(bytes: &[u8], most: usize) -> Result<Vec<u8>, Fault> {
    let cut = || "a chunk of Blosc is cut".to_owned();
    let word = |at: usize| -> Result<usize, Fault> {
        let own: [u8; 4] = bytes.get(at..at + 4).and_then(|own| own.try_into().ok()).ok_or_else(cut)?;
        Ok(u32::from_le_bytes(own) as usize)
    };
    let &[_, _, flags, width, ..] = bytes else { return Err(cut()) };
    let (total, block, width) = (word(4)?, word(8)?, usize::from(width).max(1));
    if total > most {
        return Err(format!("a chunk has {total} bytes, and should have {most} at most"));
    }
    if flags & flag::COPIED != 0 {
        return Ok(bytes.get(HEADER..HEADER + total).ok_or_else(cut)?.to_vec());
    }
    if flags & flag::BITS_SHUFFLED != 0 {
        return Err("its chunks are compressed by Blosc with bits shuffled".into());
    }
    if block == 0 && total > 0 {
        return Err(cut());
    }
    let mut all = Vec::with_capacity(total);
    for (number, begin) in (0..total).step_by(block.max(1)).enumerate() {
        let length = block.min(total - begin);
        let is_split = flags & flag::WHOLE_BLOCKS == 0
            && width <= WIDEST_SPLIT
            && block / width >= SHORTEST_PART
            && length == block;
        let parts = if is_split { width } else { 1 };
        let mut at = word(HEADER + 4 * number)?;
        let mut own = Vec::with_capacity(length);
        for _ in 0..parts {
            let packed = word(at)?;
            let body = at.checked_add(4).and_then(|from| bytes.get(from..from.checked_add(packed)?));
            let body = body.ok_or_else(cut)?;
            let part = length / parts;
            own.extend(if packed == part { body.to_vec() } else { decompressed(flags >> 5, body, part)? });
            at += 4 + packed;
        }
        if own.len() != length {
            return Err(cut());
        }
        let is_shuffled = flags & flag::SHUFFLED != 0 && width > 1;
        all.extend(if is_shuffled { unshuffled(&own, width) } else { own });
    }
    Ok(all)
}

fn decompressed(method: u8, body: &[u8], length: usize) -> Result<Vec<u8>, Fault> {
    match method {
        1 => {
            let mut own = vec![0; length];
            let found =
                lz4_flex::block::decompress_into(body, &mut own).map_err(|error| error.to_string())?;
            own.truncate(found);
            Ok(own)
        }
        3 => inflated(flate2::read::ZlibDecoder::new(body), length),
        4 => unpacked(body, length),
        0 => Err("its chunks are compressed by Blosc with BloscLZ".into()),
        other => Err(format!("its chunks are compressed by Blosc with method {other}")),
    }
}

/// The first bytes of all elements come first, then the second, and so on; what is no whole element stands at the end.
fn unshuffled(bytes: &[u8], width: usize) -> Vec<u8> {
    let count = bytes.len() / width;
    let mut own = vec![0; bytes.len()];
    for (element, out) in own.chunks_exact_mut(width).enumerate() {
        out.iter_mut().enumerate().for_each(|(byte, out)| *out = bytes[byte * count + element]);
    }
    let rest = count * width;
    own[rest..].copy_from_slice(&bytes[rest..]);
    own
}
