//! Images of one movie in several files, or in a folder.

use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use ndarray::{Array3, Axis, concatenate};

use crate::error::{Error, FileFault, ImageFault, ShapeFault, image_error};
use crate::image::{Described, Images, Wanted, check_total};
use crate::input::{InputFile, file_fault, is_zarr, read_input};
use crate::note::Note;
use crate::stated::Stated;
use crate::zarr::read_ome;

/// Files that are read, by the end of their names.
const KINDS: [&str; 4] = ["tif", "tiff", "png", "npy"];
/// How the names of masks end that stand beside images: those of Cellpose.
const MASKS: [&str; 2] = ["_cp_masks", "_seg"];

/// The frames of all files, one after the other.
pub(crate) struct Stack<T> {
    /// (frames, rows, columns).
    pub(crate) pixels: Array3<T>,
    pub(crate) stated: Stated,
    pub(crate) notes: Vec<Note>,
    pub(crate) inputs: Vec<InputFile>,
    /// The first frame of each file.
    starts: Vec<usize>,
}

impl<T> Stack<T> {
    /// The file that a frame is in, and its number there.
    pub(crate) fn location(&self, frame: usize) -> (&Path, usize) {
        let file = self.starts.partition_point(|&start| start <= frame).saturating_sub(1);
        (&self.inputs[file].path, frame - self.starts[file])
    }

    /// What faults of all frames are told of: the file, or the folder of several.
    pub(crate) fn name(&self) -> &Path {
        match self.inputs.as_slice() {
            [one] => &one.path,
            several => several.first().and_then(|first| first.path.parent()).unwrap_or(Path::new("")),
        }
    }
}

/// Reads files and folders: files in the natural order of the numbers in their names.
pub(crate) fn read_images<T: Clone>(
    paths: &[PathBuf],
    wanted: Wanted,
    parse: fn(&Path, &[u8]) -> Result<Images<T>, Error>,
) -> Result<Stack<T>, Error> {
    let mut notes = Vec::new();
    let files = files_of(paths, wanted, &mut notes)?;
    let (mut parts, mut inputs, mut starts) = (Vec::new(), Vec::new(), Vec::new());
    let (mut first, mut frames) = (None, 0);
    for path in &files {
        let (Images { pixels, described }, record) = match path.is_dir() {
            // Only stores are folders here.
            true => {
                let (bytes, described, record) = read_ome(path, wanted)?;
                (Images { described, ..parse(path, &bytes)? }, record)
            }
            false => {
                let (bytes, record) = read_input(path)?;
                (parse(path, &bytes)?, record)
            }
        };
        let (pages, rows, columns) = pixels.dim();
        let Described { stated, notes: own } = described;
        let (expected, of_first): &([usize; 2], Stated) =
            first.get_or_insert(([columns, rows], stated.clone()));
        if *expected != [columns, rows] {
            let fault = ImageFault::OtherSize { page: 0, found: [columns, rows], expected: *expected };
            return Err(image_error(path, fault));
        }
        if *of_first != stated {
            notes.push(Note::doubtful(format!(
                "{} states other units than {}, which are taken",
                path.display(),
                files[0].display()
            )));
        }
        notes.extend(own.into_iter().filter(|note| !notes.contains(note)).collect::<Vec<_>>());
        starts.push(frames);
        frames += pages;
        check_total(path, frames, [columns, rows])?;
        inputs.push(record);
        parts.push(pixels);
    }
    let views: Vec<_> = parts.iter().map(|part: &Array3<T>| part.view()).collect();
    let (Ok(pixels), Some((_, mut stated))) = (concatenate(Axis(0), &views), first) else {
        let found = vec![frames, 0, 0];
        let path = paths.first().cloned().unwrap_or_default();
        return Err(Error::Shape { path, fault: ShapeFault::Nothing { found, axis: "frames" } });
    };
    stated.is_still = frames == 1;
    Ok(Stack { pixels, stated, notes, inputs, starts })
}

/// All files, folders unfolded, in order.
fn files_of(paths: &[PathBuf], wanted: Wanted, notes: &mut Vec<Note>) -> Result<Vec<PathBuf>, Error> {
    let mut files = Vec::new();
    for path in paths {
        match path.is_dir() && !is_zarr(path) {
            true => files.extend(images_in(path, wanted, notes)?),
            false => files.push(path.clone()),
        }
    }
    files.sort_by(|a, b| natural(&a.to_string_lossy(), &b.to_string_lossy()));
    if let [first, .., last] = files.as_slice() {
        notes.push(Note::guessed(format!(
            "{} files are frames in the order of their numbers, from {} to {}",
            files.len(),
            file_name(first),
            file_name(last)
        )));
        notes.extend(uneven(&files));
    }
    Ok(files)
}

/// The images of a folder, of one kind.
fn images_in(folder: &Path, wanted: Wanted, notes: &mut Vec<Note>) -> Result<Vec<PathBuf>, Error> {
    let failure = |fault| Error::File { path: folder.to_path_buf(), fault };
    let mut found: BTreeMap<String, Vec<PathBuf>> = BTreeMap::new();
    let (mut masks, mut others) = (0, 0);
    for entry in fs::read_dir(folder).map_err(|source| failure(file_fault(source)))? {
        let path = entry.map_err(|source| failure(file_fault(source)))?.path();
        let kind = path.extension().map(|end| end.to_string_lossy().to_lowercase()).unwrap_or_default();
        if !KINDS.contains(&kind.as_str()) || file_name(&path).starts_with('.') || !path.is_file() {
            others += 1;
            continue;
        }
        let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
        let mask = MASKS.iter().find(|end| stem.ends_with(**end));
        masks += usize::from(mask.is_some());
        let kind = if kind == "tiff" { "tif".into() } else { kind };
        found.entry(format!("{}.{kind}", mask.unwrap_or(&""))).or_default().push(path);
    }
    let all: usize = found.values().map(Vec::len).sum();
    // Where there are masks beside images, masks are labels, and the others are not.
    if masks > 0 && (masks < all || wanted == Wanted::Field) {
        let is_mask = |kind: &str| MASKS.iter().any(|end| kind.starts_with(end));
        found.retain(|kind, _| is_mask(kind) == (wanted == Wanted::Labels));
    }
    // Cellpose may have written the same masks twice.
    if wanted == Wanted::Labels && found.len() > 1 && found.keys().any(|kind| kind.starts_with("_cp_masks")) {
        found.remove("_seg.npy");
    }
    if found.len() > 1 {
        let kinds = found.iter().map(|(kind, files)| format!("{} of *{kind}", files.len()));
        return Err(failure(FileFault::Mixed { kinds: kinds.collect::<Vec<_>>().join(", ") }));
    }
    let Some((kind, files)) = found.pop_first() else { return Err(failure(FileFault::NoImages)) };
    let left_out = all - files.len() + others;
    if left_out > 0 {
        notes.push(Note::guessed(format!("of the folder *{kind}; {left_out} other files are left out")));
    }
    Ok(files)
}

/// That the last numbers in names that are else alike are not evenly spaced.
fn uneven(files: &[PathBuf]) -> Option<Note> {
    let mut numbers: Vec<u64> = Vec::new();
    let mut around: Option<(String, String)> = None;
    for file in files {
        let name = file.to_string_lossy().into_owned();
        let end = name.rfind(|letter: char| letter.is_ascii_digit())? + 1;
        let start = name[..end]
            .rfind(|letter: char| !letter.is_ascii_digit())
            .map_or(0, |at| at + name[at..].chars().next().map_or(1, char::len_utf8));
        let own = (name[..start].to_owned(), name[end..].to_owned());
        if *around.get_or_insert(own.clone()) != own {
            return None;
        }
        numbers.push(name[start..end].parse().ok()?);
    }
    let steps = || numbers.windows(2).map(|pair| pair[1].saturating_sub(pair[0]));
    let least = steps().min()?;
    let gap = numbers.windows(2).find(|pair| pair[1].saturating_sub(pair[0]) > least)?;
    Some(Note::doubtful(format!(
        "files are not evenly numbered (after {} comes {}), but are taken for frames at even times",
        gap[0], gap[1]
    )))
}

fn file_name(path: &Path) -> String {
    path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

/// The order in which people count: t2 before t10.
fn natural(a: &str, b: &str) -> Ordering {
    let (mut left, mut right) = (a, b);
    loop {
        let (of_left, rest_of_left) = piece(left);
        let (of_right, rest_of_right) = piece(right);
        if of_left.is_empty() || of_right.is_empty() {
            return of_left.len().cmp(&of_right.len()).then_with(|| a.cmp(b));
        }
        let is_number = |piece: &str| piece.starts_with(|letter: char| letter.is_ascii_digit());
        let order = if is_number(of_left) && is_number(of_right) {
            let plain = |digits: &'_ str| digits.trim_start_matches('0').to_owned();
            let (left, right) = (plain(of_left), plain(of_right));
            left.len().cmp(&right.len()).then_with(|| left.cmp(&right))
        } else {
            of_left.cmp(of_right)
        };
        if order != Ordering::Equal {
            return order;
        }
        (left, right) = (rest_of_left, rest_of_right);
    }
}

/// The digits, or what is no digit, that a text begins with; and the rest.
fn piece(text: &str) -> (&str, &str) {
    let is_digit = text.starts_with(|letter: char| letter.is_ascii_digit());
    let end = text.find(|letter: char| letter.is_ascii_digit() != is_digit).unwrap_or(text.len());
    text.split_at(end)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sorted(names: &[&str]) -> Vec<PathBuf> {
        let mut files: Vec<PathBuf> = names.iter().map(PathBuf::from).collect();
        files.sort_by(|a, b| natural(&a.to_string_lossy(), &b.to_string_lossy()));
        files
    }

    #[test]
    fn files_are_in_the_order_in_which_people_count() {
        let names =
            ["a1.tif", "a2.tif", "a010.tif", "a11.tif", "b1t2.tif", "b1t10.tif", "b2t1.tif", "µ3.tif"];
        let mut shuffled = names;
        shuffled.reverse();
        assert_eq!(sorted(&shuffled), names.map(PathBuf::from));
    }

    #[test]
    fn gaps_in_numbers_are_noticed() {
        let gap = |names: &[&str]| uneven(&sorted(names)).map(|note| note.text);
        assert_eq!(gap(&["t1.tif", "t2.tif", "t3.tif"]), None);
        assert_eq!(gap(&["t000.tif", "t010.tif", "t020.tif"]), None);
        assert_eq!(gap(&["a1.tif", "b2.tif", "c9.tif"]), None);
        assert!(
            gap(&["t1_m.tif", "t2_m.tif", "t10_m.tif"]).is_some_and(|text| text.contains("after 2 comes 10"))
        );
        assert_eq!(gap(&["µ.tif", "x.tif"]), None);
    }
}
