//! Frames written one after another by a long run that can be taken up again where it was cut off.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use crate::digest::{hexadecimal, sha256};
use crate::error::{Error, OutputFault};
use crate::output::run::{self, CHECKPOINT, RUN, remove};
use crate::output::run_folder::RunFolder;
use crate::output::{OutputDirectory, OutputFolder, output_error};

/// An unfinished run inside its output directory: arrays of frames on disk, and a checkpoint.
///
/// Frames are appended to `.npy` files whose headers state the final shape. A checkpoint is replaced in one move, after the
/// frames before it have reached the disk; so whenever the program dies, the last checkpoint and its frames are whole. It holds
/// checksums of itself and of the frames, so that a run is not taken up from others.
///
/// ```
/// # let scratch = tempfile::tempdir()?;
/// # let out = scratch.path().join("out");
/// use voronudge_io::{OutputFolder, Recording};
/// let folder = OutputFolder::claim(&out)?;
/// let arrays = [("positions.npy", [3, 2, 2])]; // three frames of two cells
/// let mut recording = Recording::begin(&folder, &arrays)?;
/// recording.append(0, &[0.0, 0.1, 1.0, 1.1])?;
/// recording.checkpoint(b"one frame")?;
/// assert_eq!(recording.frame(0, 0)?, [0.0, 0.1, 1.0, 1.1]);
/// recording.append(0, &[f64::NAN; 4])?; // after the checkpoint; the program dies
/// drop(recording);
///
/// assert_eq!(Recording::find(&out)?.as_deref(), Some(b"one frame".as_slice()));
/// let mut recording = Recording::resume(&folder, &arrays, 1)?;
/// recording.append(0, &[0.2, 0.3, 1.2, 1.3])?;
/// recording.append(0, &[0.4, 0.5, 1.4, 1.5])?;
/// recording.results()?.commit()?;
/// let positions = voronudge_io::read_vectors(&out.join("positions.npy"))?;
/// assert_eq!(positions[[2, 1, 0]], 1.4);
/// assert_eq!(Recording::find(&out)?, None);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Recording {
    arrays: Vec<FrameFile>,
    run: RunFolder,
}

#[derive(Debug)]
struct FrameFile {
    name: String,
    path: PathBuf,
    file: BufWriter<File>,
    shape: [usize; 3],
    /// Bytes before the first frame, and of each.
    lengths: [u64; 2],
    /// Frames so far.
    frames: usize,
    /// Of all frames so far.
    sum: Sha256,
}

impl Recording {
    /// Begins a recording of arrays of (frames, rows, columns) in an output directory. An unfinished one is given up.
    ///
    /// # Errors
    /// [`Error::Output`] where a file cannot be written.
    pub fn begin(folder: &OutputFolder, arrays: &[(&str, [usize; 3])]) -> Result<Self, Error> {
        let run = RunFolder::begin(folder)?;
        let arrays = arrays.iter().map(|(name, shape)| FrameFile::create(run.path(), name, *shape));
        Ok(Self { arrays: arrays.collect::<Result<_, _>>()?, run })
    }

    /// The last checkpoint of an unfinished run in an output directory, or nothing.
    ///
    /// # Errors
    /// [`Error::File`] where it cannot be read, [`Error::Output`] where it was changed.
    pub fn find(out: &Path) -> Result<Option<Vec<u8>>, Error> {
        Ok(read_checkpoint(&out.join(RUN))?.map(|(_, content)| content))
    }

    /// Takes up an unfinished recording after its first `frames` frames.
    ///
    /// # Errors
    /// [`Error::Output`] where a file is missing, too short, not as it was at the checkpoint, or cannot be written.
    pub fn resume(
        folder: &OutputFolder,
        arrays: &[(&str, [usize; 3])],
        frames: usize,
    ) -> Result<Self, Error> {
        let run = RunFolder::resume(folder);
        let sums = read_checkpoint(run.path())?.map(|(sums, _)| sums).unwrap_or_default();
        let arrays = arrays.iter().zip(sums.split(' '));
        let arrays =
            arrays.map(|((name, shape), sum)| FrameFile::open(run.path(), name, *shape, (frames, sum)));
        Ok(Self { arrays: arrays.collect::<Result<_, _>>()?, run })
    }

    /// Appends a frame, in C order, to the array of a number.
    ///
    /// # Errors
    /// [`Error::Output`] where it cannot be written.
    pub fn append(&mut self, array: usize, frame: &[f64]) -> Result<(), Error> {
        let Some(array) = self.arrays.get_mut(array) else {
            return Ok(());
        };
        let bytes: Vec<u8> = frame.iter().copied().flat_map(f64::to_le_bytes).collect();
        array.sum.update(&bytes);
        array.frames += 1;
        array.file.write_all(&bytes).map_err(|source| output_error(&array.path, OutputFault::Write(source)))
    }

    /// A frame that was appended, in C order, of the array of a number; nothing if there is none.
    ///
    /// # Errors
    /// [`Error::Output`] where it cannot be read.
    pub fn frame(&mut self, array: usize, frame: usize) -> Result<Vec<f64>, Error> {
        let Some(array) = self.arrays.get_mut(array) else {
            return Ok(Vec::new());
        };
        array.read(frame).map_err(|source| output_error(&array.path, OutputFault::Write(source)))
    }

    /// Replaces the checkpoint by one that stands for all frames appended so far.
    ///
    /// # Errors
    /// [`Error::Output`] where it cannot be written.
    pub fn checkpoint(&mut self, content: &[u8]) -> Result<(), Error> {
        self.flush()?;
        let folder = self.run.path();
        let (path, fresh) = (folder.join(CHECKPOINT), folder.join("checkpoint.new"));
        let sums: Vec<String> = self.arrays.iter().map(FrameFile::sum).collect();
        let sealed = [sums.join(" ").as_bytes(), b"\n", content].concat();
        let write = || {
            let mut file = File::create(&fresh)?;
            file.write_all(sha256(&sealed).as_bytes())?;
            file.write_all(b"\n")?;
            file.write_all(&sealed)?;
            file.sync_all()?;
            fs::rename(&fresh, &path)
        };
        write().map_err(|source| output_error(&path, OutputFault::Write(source)))
    }

    /// The results of the output directory, with the finished arrays among them. These also stay here until the results are
    /// committed, so that a program that dies before loses nothing.
    ///
    /// # Errors
    /// As [`OutputDirectory::write_array`].
    pub fn results(mut self) -> Result<OutputDirectory, Error> {
        self.flush()?;
        let mut results = OutputDirectory::of_run(self.run)?;
        for array in &self.arrays {
            results.link(&array.name, (&array.path, array.file.get_ref()))?;
        }
        Ok(results)
    }

    /// Frames that all arrays have so far.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.arrays.iter().map(|array| array.frames).min().unwrap_or(0)
    }

    /// Writes the frames so far as arrays of their own, for a run that does not come to its end.
    ///
    /// # Errors
    /// As [`OutputDirectory::write_array`].
    pub fn write_so_far(&mut self, out: &mut OutputDirectory) -> Result<(), Error> {
        self.flush()?;
        let frames = self.frames();
        for array in &mut self.arrays {
            let ([_, rows, columns], [before, each]) = (array.shape, array.lengths);
            let file = array.file.get_mut();
            out.stage(&array.name, |target| {
                file.seek(SeekFrom::Start(before))?;
                target.write_all(&header([frames, rows, columns]))?;
                io::copy(&mut file.take(frames as u64 * each), target).map(|_| ())
            })?;
        }
        Ok(())
    }

    /// Gives the recording up.
    ///
    /// # Errors
    /// [`Error::Output`] where it cannot be removed.
    pub fn discard(self) -> Result<(), Error> {
        remove(self.run.path())
    }

    fn flush(&mut self) -> Result<(), Error> {
        for array in &mut self.arrays {
            let flushed = array.file.flush().and_then(|()| array.file.get_ref().sync_data());
            flushed.map_err(|source| output_error(&array.path, OutputFault::Write(source)))?;
        }
        Ok(())
    }
}

impl FrameFile {
    fn create(folder: &Path, name: &str, shape: [usize; 3]) -> Result<Self, Error> {
        let path = folder.join(name);
        let create = || {
            let file = OpenOptions::new().read(true).write(true).create(true).truncate(true).open(&path)?;
            let mut file = BufWriter::new(file);
            file.write_all(&header(shape))?;
            Ok(file)
        };
        let file = create().map_err(|source| output_error(&path, OutputFault::Write(source)))?;
        let (lengths, sum) = (lengths(shape), Sha256::new());
        Ok(Self { name: name.into(), path, file, shape, lengths, frames: 0, sum })
    }

    fn open(
        folder: &Path,
        name: &str,
        shape: [usize; 3],
        (frames, expected): (usize, &str),
    ) -> Result<Self, Error> {
        let path = folder.join(name);
        let header = header(shape);
        let lengths @ [before, each] = lengths(shape);
        let length = before + frames as u64 * each;
        let open = || {
            let mut file = OpenOptions::new().read(true).write(true).open(&path)?;
            let mut found = vec![0; header.len()];
            file.read_exact(&mut found)?;
            let (sum, read) = sum_of((&mut file).take(length - before))?;
            let is_whole = found == header && read == length - before;
            if !is_whole || hexadecimal(&sum.clone().finalize()) != expected {
                return Ok(None);
            }
            file.set_len(length)?;
            Ok(Some((BufWriter::new(file), sum)))
        };
        match open() {
            Ok(Some((file, sum))) => Ok(Self { name: name.into(), path, file, shape, lengths, frames, sum }),
            Ok(None) => Err(output_error(&path, OutputFault::Damaged { place: "these frames are".into() })),
            Err(source) => Err(output_error(&path, OutputFault::Write(source))),
        }
    }

    /// The checksum of all frames so far.
    fn sum(&self) -> String {
        hexadecimal(&self.sum.clone().finalize())
    }

    fn read(&mut self, frame: usize) -> io::Result<Vec<f64>> {
        self.file.flush()?;
        let [before, each] = self.lengths;
        let mut bytes = vec![0; each as usize];
        let file = self.file.get_mut();
        file.seek(SeekFrom::Start(before + frame as u64 * each))?;
        let read = file.read_exact(&mut bytes);
        file.seek(SeekFrom::End(0))?;
        read?;
        let value = |chunk: &[u8]| {
            let mut value = [0; size_of::<f64>()];
            value.copy_from_slice(chunk);
            f64::from_le_bytes(value)
        };
        Ok(bytes.chunks_exact(size_of::<f64>()).map(value).collect())
    }
}

/// Bytes of the header of an array, and of one frame.
fn lengths(shape: [usize; 3]) -> [u64; 2] {
    [header(shape).len() as u64, (shape[1] * shape[2] * size_of::<f64>()) as u64]
}

/// The header of a `.npy` file, version 1.0, of 64-bit floats in C order.
fn header([frames, rows, columns]: [usize; 3]) -> Vec<u8> {
    let mut text =
        format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({frames}, {rows}, {columns}), }}");
    // Magic, version, length of the text: 10 bytes. The whole is a multiple of 64 and ends with a new line.
    let padding = 63 - (10 + text.len()) % 64;
    text.extend(std::iter::repeat_n(' ', padding));
    text.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend_from_slice(&(text.len() as u16).to_le_bytes());
    bytes.extend_from_slice(text.as_bytes());
    bytes
}

/// The sum of all bytes, and how many there are.
fn sum_of(mut source: impl Read) -> io::Result<(Sha256, u64)> {
    let (mut sum, mut read, mut piece) = (Sha256::new(), 0, vec![0; 1 << 16]);
    loop {
        match source.read(&mut piece)? {
            0 => return Ok((sum, read)),
            count => {
                sum.update(&piece[..count]);
                read += count as u64;
            }
        }
    }
}

/// The sums of the frames and the content of a checkpoint, if there is one.
fn read_checkpoint(run: &Path) -> Result<Option<(String, Vec<u8>)>, Error> {
    let path = run.join(CHECKPOINT);
    let Some(bytes) = run::read(&path)? else { return Ok(None) };
    match sealed(&bytes) {
        Some((sums, content)) => Ok(Some((sums.to_owned(), content.to_vec()))),
        None => Err(output_error(&path, OutputFault::Damaged { place: "it is".into() })),
    }
}

fn sealed(bytes: &[u8]) -> Option<(&str, &[u8])> {
    let line = |bytes: &[u8]| bytes.iter().position(|byte| *byte == b'\n');
    let end = line(bytes)?;
    let (sum, rest) = (&bytes[..end], &bytes[end + 1..]);
    if sum != sha256(rest).as_bytes() {
        return None;
    }
    let end = line(rest)?;
    Some((std::str::from_utf8(&rest[..end]).ok()?, &rest[end + 1..]))
}
