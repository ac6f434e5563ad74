//! The text of a table, whatever it is compressed, encoded and separated by.

use std::borrow::Cow;
use std::io::Read;

use encoding_rs::{UTF_16BE, UTF_16LE, WINDOWS_1252};
use flate2::read::MultiGzDecoder;

use crate::error::TableFault;
use crate::note::Note;

/// The most that a compressed table may grow to: far above any real one, far below what would
/// exhaust a machine.
const DECOMPRESSED_LIMIT: u64 = 1 << 30;

/// How files of other kinds begin, what they are, and how they become a table.
const OTHER_KINDS: [(&[u8], &str, &str); 16] = [
    (b"PAR1", "a Parquet file", PARQUET),
    (b"MATLAB 7.3", "a MATLAB file of version 7.3 (HDF5)", MATLAB_7_3),
    (b"MATLAB ", "a MATLAB file", MATLAB),
    (b"{", "JSON", OTHER),
    (b"[{", "JSON", OTHER),
    (b"[[", "JSON", OTHER),
    (b"<", "XML or HTML", OTHER),
    (b"PK\x03\x04", "a zip archive or a spreadsheet", SPREADSHEET),
    (b"\xd0\xcf\x11\xe0", "an old spreadsheet", SPREADSHEET),
    (b"\x89HDF", "an HDF5 file", HDF5),
    (b"\x93NUMPY", "a .npy array", OTHER),
    (b"\x80\x04\x95", "a pickled Python object", OTHER),
    (b"ARROW1", "a Feather file", FEATHER),
    (b"II*\0", "a TIFF image", OTHER),
    (b"MM\0*", "a TIFF image", OTHER),
    (b"\x89PNG", "a PNG image", OTHER),
];

const OTHER: &str = "export what it holds as text, for instance as comma-separated values";
const PARQUET: &str = "write it as text, as comma-separated values: in Python, \
     pandas.read_parquet(\"x.parquet\").to_csv(\"x.csv\", index=False); in R, write.csv(arrow::read_parquet(\"x.parquet\"), \"x.csv\")";
const FEATHER: &str = "write it as text, as comma-separated values: in Python, \
     pandas.read_feather(\"x.feather\").to_csv(\"x.csv\", index=False)";
const MATLAB: &str = "import flow reads what PIVlab saves for MATLAB; export other things as text, as comma-separated values: \
     writetable(array2table(x), \"x.csv\")";
const MATLAB_7_3: &str = "save it in MATLAB again with save(\"x.mat\", \"-v7\") after load, which import flow reads if it is from PIVlab, \
     or as text, as comma-separated values";
const HDF5: &str = "export what it holds as text, as comma-separated values: from ilastik by its table export, from Imaris as statistics, \
     in Python by pandas.DataFrame(h5py.File(\"x.h5\")[\"name\"][:]).to_csv(\"x.csv\", index=False); label images as TIFF";
const SPREADSHEET: &str = "save the sheet with the table as text, as comma-separated values";

/// The text of a table in UTF-8, without a byte order mark.
pub(super) struct Text<'a> {
    pub(super) bytes: Cow<'a, [u8]>,
    /// The encoding, where it is not UTF-8.
    pub(super) encoding: Option<&'static str>,
}

impl Text<'_> {
    /// What is to be said of the encoding.
    pub(super) fn note(&self) -> Option<Note> {
        self.encoding
            .map(|encoding| Note::guessed(format!("the text is in {encoding}, since it is not UTF-8")))
    }
}

/// Decompresses what begins like gzip, whatever its name, and decodes it.
pub(super) fn text_of(bytes: &[u8]) -> Result<Text<'_>, TableFault> {
    let bytes = decompressed(bytes)?;
    let begin = bytes.trim_ascii_start();
    if let Some((_, kind, advice)) = OTHER_KINDS.iter().find(|(first, ..)| begin.starts_with(first)) {
        return Err(TableFault::AnotherKind { kind, advice });
    }
    decoded(bytes)
}

/// The text of a file that is no table, in UTF-8.
pub(crate) fn text_in_utf8(bytes: &[u8]) -> Result<String, TableFault> {
    let text = decoded(Cow::Borrowed(bytes))?.bytes.into_owned();
    String::from_utf8(text).map_err(|_| TableFault::NotText)
}

fn decoded(bytes: Cow<'_, [u8]>) -> Result<Text<'_>, TableFault> {
    let (mark, wide) = match *bytes {
        [0xff, 0xfe, ..] => (2, Some((UTF_16LE, "UTF-16"))),
        [0xfe, 0xff, ..] => (2, Some((UTF_16BE, "UTF-16"))),
        [0xef, 0xbb, 0xbf, ..] => (3, None),
        _ => (0, None),
    };
    if let Some((encoding, name)) = wide {
        let (text, _) = encoding.decode_without_bom_handling(&bytes[mark..]);
        return Ok(Text { bytes: Cow::Owned(text.into_owned().into_bytes()), encoding: Some(name) });
    }
    // Text has no zero bytes; images and what PIVlab saves for MATLAB have.
    if bytes.contains(&0) {
        return Err(TableFault::NotText);
    }
    if std::str::from_utf8(&bytes).is_err() {
        let (text, _) = WINDOWS_1252.decode_without_bom_handling(&bytes);
        let bytes = Cow::Owned(text.into_owned().into_bytes());
        return Ok(Text { bytes, encoding: Some("Latin-1 (Windows-1252)") });
    }
    let bytes = match bytes {
        Cow::Borrowed(bytes) => Cow::Borrowed(&bytes[mark..]),
        Cow::Owned(mut bytes) => {
            bytes.drain(..mark);
            Cow::Owned(bytes)
        }
    };
    Ok(Text { bytes, encoding: None })
}

/// What a file holds, compressed with gzip or not.
pub(crate) fn decompressed(bytes: &[u8]) -> Result<Cow<'_, [u8]>, TableFault> {
    if !bytes.starts_with(&[0x1f, 0x8b]) {
        return Ok(Cow::Borrowed(bytes));
    }
    let mut text = Vec::new();
    MultiGzDecoder::new(bytes)
        .take(DECOMPRESSED_LIMIT + 1)
        .read_to_end(&mut text)
        .map_err(|source| TableFault::Gzip(source.to_string()))?;
    if text.len() as u64 > DECOMPRESSED_LIMIT {
        let limit = DECOMPRESSED_LIMIT;
        return Err(TableFault::TooLong { limit });
    }
    Ok(Cow::Owned(text))
}

/// The commonest of comma, semicolon and tab in the first line that is not blank; `None` where it has none of them but blanks.
pub(super) fn delimiter(text: &[u8]) -> Option<u8> {
    let mut lines = text.split(|byte| matches!(byte, b'\n' | b'\r'));
    let first = lines.find(|line| !line.trim_ascii().is_empty()).unwrap_or_default();
    let count = |delimiter| first.iter().filter(|&&byte| byte == delimiter).count();
    // Of equals max_by_key takes the last: the comma.
    let candidates = [b'\t', b';', b','];
    let commonest = candidates.into_iter().max_by_key(|&candidate| count(candidate))?;
    let has_blanks = first.trim_ascii().contains(&b' ');
    (count(commonest) > 0 || !has_blanks).then_some(commonest)
}

/// The same text with points in the place of decimal commas; lines and fields stay where they are. Commas stay where they separate, and
/// where numbers with points are in the same table, since nobody knows then what they mean.
pub(super) fn with_points(text: Cow<'_, [u8]>, separator: u8) -> (Cow<'_, [u8]>, Option<Note>) {
    if separator == b',' {
        return (text, None);
    }
    let ends = |byte: &u8| *byte == separator || matches!(byte, b'\n' | b'\r');
    let has = |mark: u8| text.split(ends).any(|field| is_number_with(mark, field));
    if !has(b',') || has(b'.') {
        return (text, None);
    }
    let mut own = text.into_owned();
    for field in own.split_mut(ends).filter(|field| is_number_with(b',', field)) {
        field.iter_mut().filter(|byte| **byte == b',').for_each(|byte| *byte = b'.');
    }
    (Cow::Owned(own), Some(Note::guessed("commas within numbers are decimal commas")))
}

/// Whether a field is a number of which this mark separates the digits before and after the point.
fn is_number_with(mark: u8, field: &[u8]) -> bool {
    let field = field.trim_ascii();
    let field = field.strip_prefix(b"\"").and_then(|own| own.strip_suffix(b"\"")).unwrap_or(field);
    let Some(at) = field.iter().position(|byte| *byte == mark) else { return false };
    let whole = field[..at].strip_prefix(b"-").or(field[..at].strip_prefix(b"+")).unwrap_or(&field[..at]);
    let rest = &field[at + 1..];
    let digits = rest.iter().take_while(|byte| byte.is_ascii_digit()).count();
    let exponent = match &rest[digits..] {
        [] => true,
        [b'e' | b'E', power @ ..] => {
            let power = power.strip_prefix(b"-").or(power.strip_prefix(b"+")).unwrap_or(power);
            !power.is_empty() && power.iter().all(u8::is_ascii_digit)
        }
        _ => false,
    };
    whole.iter().all(u8::is_ascii_digit) && whole.len() + digits > 0 && exponent
}

/// Text with a tab wherever there are blanks between fields; lines stay as they are.
pub(super) fn tabbed(text: &[u8]) -> Vec<u8> {
    let text = String::from_utf8_lossy(text);
    let mut out = String::with_capacity(text.len());
    for line in text.split('\n') {
        let line = line.trim();
        // The mark of a comment belongs to the first field.
        let (mark, rest) = match line.strip_prefix('#') {
            Some(rest) => ("#", rest),
            None => ("", line),
        };
        out.push_str(mark);
        let mut before: Option<&str> = None;
        for word in rest.split_whitespace() {
            // A unit belongs to the name before it, and PIVlab has a column "vector type".
            let goes_on =
                word.starts_with(['[', '(']) || (before == Some("vector") && word.starts_with("type"));
            if before.is_some() {
                out.push(if goes_on { ' ' } else { '\t' });
            }
            out.push_str(word);
            before = Some(word);
        }
        out.push('\n');
    }
    out.into_bytes()
}
