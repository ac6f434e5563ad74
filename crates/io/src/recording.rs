//! Frames written one after another by a long run that can be taken up again where it was cut off.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::error::{Error, OutputFault};
use crate::output::{OutputDirectory, output_error};

/// The hidden folder of an unfinished run.
pub(crate) const FOLDER: &str = ".voronudge-run";
const CHECKPOINT: &str = "checkpoint";

/// An unfinished run inside its output directory: arrays of frames on disk, and a checkpoint.
///
/// Frames are appended to `.npy` files whose headers state the final shape. A checkpoint is replaced in one move, after the
/// frames before it have reached the disk; so whenever the program dies, the last checkpoint and its frames are whole.
///
/// ```
/// # let folder = tempfile::tempdir()?;
/// # let out = folder.path().join("out");
/// use voronudge_io::Recording;
/// let arrays = [("positions.npy", [3, 2, 2])]; // three frames of two cells
/// let mut recording = Recording::begin(&out, &arrays)?;
/// recording.append(0, &[0.0, 0.1, 1.0, 1.1])?;
/// recording.checkpoint(b"one frame")?;
/// assert_eq!(recording.frame(0, 0)?, [0.0, 0.1, 1.0, 1.1]);
/// recording.append(0, &[f64::NAN; 4])?; // after the checkpoint; the program dies
/// drop(recording);
///
/// assert_eq!(Recording::find(&out)?.as_deref(), Some(b"one frame".as_slice()));
/// let mut recording = Recording::resume(&out, &arrays, 1)?;
/// recording.append(0, &[0.2, 0.3, 1.2, 1.3])?;
/// recording.append(0, &[0.4, 0.5, 1.4, 1.5])?;
/// recording.results()?.commit()?;
/// recording.discard()?;
/// let positions = voronudge_io::read_vectors(&out.join("positions.npy"))?;
/// assert_eq!(positions[[2, 1, 0]], 1.4);
/// assert_eq!(Recording::find(&out)?, None);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Recording {
    folder: PathBuf,
    arrays: Vec<FrameFile>,
    /// The output directory, if it was made here.
    made: Option<PathBuf>,
}

#[derive(Debug)]
struct FrameFile {
    name: String,
    path: PathBuf,
    file: BufWriter<File>,
    /// Bytes before the first frame, and of each.
    lengths: [u64; 2],
}

impl Recording {
    /// Begins a recording of arrays of (frames, rows, columns) in an output directory, which is made if need be. An
    /// unfinished one is given up.
    ///
    /// # Errors
    /// [`Error::Output`] where a file cannot be written.
    pub fn begin(out: &Path, arrays: &[(&str, [usize; 3])]) -> Result<Self, Error> {
        if out.as_os_str().is_empty() {
            return Err(output_error(out, OutputFault::Unnamed));
        }
        if out.is_file() {
            return Err(output_error(out, OutputFault::NotADirectory));
        }
        let folder = out.join(FOLDER);
        let made = (!out.exists()).then(|| out.to_path_buf());
        fs::create_dir_all(out).map_err(|source| output_error(out, OutputFault::Create(source)))?;
        remove(&folder)?;
        fs::create_dir(&folder).map_err(|source| output_error(out, OutputFault::NotWritable(source)))?;
        let arrays = arrays.iter().map(|(name, shape)| FrameFile::create(&folder, name, *shape));
        Ok(Self { arrays: arrays.collect::<Result<_, _>>()?, folder, made })
    }

    /// The last checkpoint of an unfinished run in an output directory, or nothing.
    ///
    /// # Errors
    /// [`Error::Output`] where it cannot be read.
    pub fn find(out: &Path) -> Result<Option<Vec<u8>>, Error> {
        let path = out.join(FOLDER).join(CHECKPOINT);
        match fs::read(&path) {
            Ok(bytes) => Ok(Some(bytes)),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(source) => Err(output_error(&path, OutputFault::Write(source))),
        }
    }

    /// Takes up an unfinished recording after its first `frames` frames.
    ///
    /// # Errors
    /// [`Error::Output`] where a file is missing, too short, or cannot be written.
    pub fn resume(out: &Path, arrays: &[(&str, [usize; 3])], frames: usize) -> Result<Self, Error> {
        let folder = out.join(FOLDER);
        let arrays = arrays.iter().map(|(name, shape)| FrameFile::open(&folder, name, *shape, frames));
        Ok(Self { arrays: arrays.collect::<Result<_, _>>()?, folder, made: None })
    }

    /// Appends a frame, in C order, to the array of a number.
    ///
    /// # Errors
    /// [`Error::Output`] where it cannot be written.
    pub fn append(&mut self, array: usize, frame: &[f64]) -> Result<(), Error> {
        let Some(array) = self.arrays.get_mut(array) else {
            return Ok(());
        };
        let write = |file: &mut BufWriter<File>| {
            frame.iter().try_for_each(|value| file.write_all(&value.to_le_bytes()))
        };
        write(&mut array.file).map_err(|source| output_error(&array.path, OutputFault::Write(source)))
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
        let (path, fresh) = (self.folder.join(CHECKPOINT), self.folder.join("checkpoint.new"));
        let write = || {
            let mut file = File::create(&fresh)?;
            file.write_all(content)?;
            file.sync_all()?;
            fs::rename(&fresh, &path)
        };
        write().map_err(|source| output_error(&path, OutputFault::Write(source)))
    }

    /// The results of the output directory, with the finished arrays among them. These also stay here, until
    /// [`discard`](Self::discard), so that a program that dies in between loses nothing.
    ///
    /// # Errors
    /// As [`OutputDirectory::write_array`].
    pub fn results(&mut self) -> Result<OutputDirectory, Error> {
        self.flush()?;
        let out = self.folder.parent().unwrap_or(&self.folder);
        let mut results = OutputDirectory::staged_in(out, &self.folder)?;
        self.arrays.iter().try_for_each(|array| results.link(&array.name, &array.path))?;
        Ok(results)
    }

    /// Removes the recording, once the results are in place; and the output directory if it was made for it and is empty.
    ///
    /// # Errors
    /// [`Error::Output`] where it cannot be removed.
    pub fn discard(self) -> Result<(), Error> {
        remove(&self.folder)?;
        if let Some(out) = &self.made {
            // Fails, as it should, where the directory holds results.
            let _ = fs::remove_dir(out);
        }
        Ok(())
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
        Ok(Self { name: name.into(), path, file, lengths: lengths(shape) })
    }

    fn open(folder: &Path, name: &str, shape: [usize; 3], frames: usize) -> Result<Self, Error> {
        let path = folder.join(name);
        let header = header(shape);
        let [before, each] = lengths(shape);
        let length = before + frames as u64 * each;
        let open = || {
            let mut file = OpenOptions::new().read(true).write(true).open(&path)?;
            let mut found = vec![0; header.len()];
            file.read_exact(&mut found)?;
            if found != header || file.metadata()?.len() < length {
                return Err(io::Error::other("it is not the array of the checkpoint"));
            }
            file.set_len(length)?;
            file.seek(SeekFrom::End(0))?;
            Ok(BufWriter::new(file))
        };
        let file = open().map_err(|source| output_error(&path, OutputFault::Write(source)))?;
        Ok(Self { name: name.into(), path, file, lengths: lengths(shape) })
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

pub(crate) fn remove(folder: &Path) -> Result<(), Error> {
    match fs::remove_dir_all(folder) {
        Err(source) if source.kind() != io::ErrorKind::NotFound => {
            Err(output_error(folder, OutputFault::Write(source)))
        }
        _ => Ok(()),
    }
}
