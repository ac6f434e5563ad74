//! Importing tracked spots: TrackMate's table and any table with track, frame, x and y.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use ndarray::Array3;

use crate::boundary::Boundary;
use crate::dataset::DataSet;
use crate::error::{Error, TableFault, table_error};
use crate::field_of_view::SeenArea;
use crate::image_scale::{ImageScale, describe};
use crate::input::{InputFile, is_zarr, read_input};
use crate::memory::SIZE_LIMIT;
use crate::napari;
use crate::note::Note;
use crate::table::{ColumnNames, Layout, SpotTable, decompressed, read_spots};
use crate::trackmate_xml::{is_xml, read_trackmate};
use crate::validate::{ArrayNames, check_seen};
use crate::zarr::read_geff;

/// The most frames between the first and the last spot.
const FRAME_LIMIT: usize = 100_000;

/// The most bytes of an array for each spot that is put into it, beyond [`EMPTY`]: one place in ten thousand is taken.
const BYTES_OF_SPOT: u64 = 160_000;

/// The bytes of an array that may well have no spots.
const EMPTY: u64 = 100_000_000;

/// What a table does not say about itself. The default leaves everything open.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ImportOptions {
    /// Columns that are not to be recognised automatically.
    pub columns: ColumnNames,
    /// Length of one unit of the table (one pixel) and so on. Without `pixel_size` the unit of length is that of TrackMate's header rows.
    pub scale: ImageScale,
    /// What is around the cells; default open.
    pub boundary: Option<Boundary>,
    /// Width and height of the image, in units of the table: the field of view.
    pub image_size: Option<[f64; 2]>,
}

/// An imported data set and what became of the rows.
#[derive(Debug, Clone, PartialEq)]
pub struct Import {
    /// The data set; the cell axis is the tracks by ascending id.
    pub dataset: DataSet,
    /// The track id of each cell.
    pub track_ids: Vec<i64>,
    /// The counts to report.
    pub summary: ImportSummary,
    /// What was read, guessed and doubted.
    pub notes: Vec<Note>,
}

/// What became of the rows of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ImportSummary {
    /// Frames from the first to the last one with a spot, empty ones included.
    pub frames: usize,
    /// The table's number of the first frame.
    pub first_frame: i64,
    /// Frames in between without any spot; all cells are absent there.
    pub empty_frames: usize,
    /// Tracks, which is cells.
    pub tracks: usize,
    /// Spots taken into the data set.
    pub spots: usize,
    /// Spots that belong to no track.
    pub left_out_untracked: usize,
    /// Further spots of a track in the same frame, as splitting tracks have; the first is kept.
    pub left_out_duplicate: usize,
}

/// Imports the spots table that TrackMate exports, CSV or gzip-compressed CSV, or its XML: the file that it saves, or its exported tracks.
///
/// XML brings frame interval and units. Of a table, needs the columns `TRACK_ID`, `FRAME` and `POSITION_X`, `POSITION_Y` (or `X`, `Y`) in any
/// case. Up to three rows of labels and units below the header are skipped.
///
/// # Errors
/// [`Error::File`] and [`Error::Table`], the latter with the line; [`Error::Setting`] for options
/// out of range; [`Error::Value`] for two tracks in one place.
pub fn import_trackmate(path: &Path, options: &ImportOptions) -> Result<Import, Error> {
    import(path, options, Layout::TrackMate)
}

/// Imports any table with one row per spot, separated by commas, semicolons, tabs or blanks, compressed with gzip or not, in UTF-8,
/// UTF-16 or Latin-1; or a `.npy` array of rows track, frame, (z,) y, x, as napari keeps tracks.
///
/// Unless named in the options, columns are recognised by usual names: `track_id`, `track`,
/// `particle`, `cell`, `id` …; `frame`, `t`, `time_index` …; `x`, `position_x`, `pos_x` … The
/// earlier name wins where several are there. A track is in one place in each frame: unlike TrackMate's, tracks do not split.
/// z is left out.
///
/// # Errors
/// As [`import_trackmate`], and [`TableFault::SpotTwice`].
pub fn import_tracks(path: &Path, options: &ImportOptions) -> Result<Import, Error> {
    import(path, options, Layout::Tracks)
}

fn import(path: &Path, options: &ImportOptions, layout: Layout) -> Result<Import, Error> {
    options.scale.begin(Boundary::Open)?;
    if is_zarr(path) {
        let (table, record) = read_geff(path)?;
        return finish(path, options, record, (table, Layout::Tracks));
    }
    let (bytes, record) = read_input(path)?;
    let read = read_any(path, &bytes, layout, &options.columns)?;
    finish(path, options, record, read)
}

/// The data set of the spots of a file.
pub(crate) fn finish(
    path: &Path,
    options: &ImportOptions,
    record: InputFile,
    (table, layout): (SpotTable, Layout),
) -> Result<Import, Error> {
    let mut notes = table.notes.clone();
    let scale = table.stated.settle(&options.scale, &mut notes);
    let boundary = options.boundary.unwrap_or(Boundary::Open);
    let mut dataset = describe(
        boundary,
        scale.frame_interval,
        scale.y_axis,
        scale.length_unit.as_deref(),
        scale.time_unit.as_deref(),
    );
    dataset.check_settings().map_err(Error::Setting)?;
    dataset.inputs.push(record);
    let tracks = Tracks::arrange(&table, layout).map_err(|fault| table_error(path, fault))?;

    let pixel = scale.pixel_size.unwrap_or(1.0);
    dataset.positions = tracks.positions * pixel;
    dataset.check_arrays(&ArrayNames::of_one(path))?;
    dataset.y_axis.turn(&mut dataset.positions);
    if let Some(size) = options.image_size {
        dataset.field_of_view = Some(SeenArea::image(size.map(|length| length * pixel), dataset.y_axis));
        dataset.check_settings().map_err(Error::Setting)?;
        check_seen(path, &dataset)?;
    }
    Ok(Import { dataset, track_ids: tracks.ids, summary: tracks.summary, notes })
}

/// The spots of a table, of a file of TrackMate, or of an array of tracks, and whose tracks they are: whatever the file turns out to be.
fn read_any(
    path: &Path,
    bytes: &[u8],
    layout: Layout,
    columns: &ColumnNames,
) -> Result<(SpotTable, Layout), Error> {
    let unfolded = decompressed(bytes).map_err(|fault| table_error(path, fault))?;
    if is_xml(&unfolded) {
        return Ok((read_trackmate(path, &unfolded)?, Layout::TrackMate));
    }
    let table = match layout {
        Layout::Tracks if unfolded.starts_with(napari::SIGNATURE) => {
            napari::read_layer(path, &unfolded, layout)?
        }
        _ => read_spots(path, &unfolded, layout, columns)?,
    };
    Ok((table, layout))
}

/// Spots arranged as (frames, tracks, 2), in the coordinates of the table.
struct Tracks {
    positions: Array3<f64>,
    ids: Vec<i64>,
    summary: ImportSummary,
}

impl Tracks {
    fn arrange(table: &SpotTable, layout: Layout) -> Result<Self, TableFault> {
        let (first, frames) = frame_span(table.spots.iter().map(|spot| spot.frame))?;
        let ids: BTreeSet<i64> = table.spots.iter().map(|spot| spot.track).collect();
        let ids: Vec<i64> = ids.into_iter().collect();
        let bytes = 16 * frames as u64 * ids.len() as u64;
        let limit = SIZE_LIMIT.min(EMPTY + BYTES_OF_SPOT * table.spots.len() as u64);
        if bytes > limit {
            return Err(TableFault::TooLarge { frames, tracks: ids.len(), bytes, limit });
        }
        let cells: BTreeMap<i64, usize> = ids.iter().copied().zip(0..).collect();
        let mut positions = Array3::from_elem((frames, ids.len(), 2), f64::NAN);
        let mut occupied = vec![0_usize; frames];
        let mut duplicates = 0;
        for spot in &table.spots {
            let (frame, cell) = ((spot.frame - first) as usize, cells[&spot.track]);
            if positions[[frame, cell, 0]].is_nan() {
                positions[[frame, cell, 0]] = spot.x;
                positions[[frame, cell, 1]] = spot.y;
                occupied[frame] += 1;
            } else if layout == Layout::Tracks {
                return Err(TableFault::SpotTwice { track: spot.track, frame: spot.frame });
            } else {
                duplicates += 1;
            }
        }
        let summary = ImportSummary {
            frames,
            first_frame: first,
            empty_frames: occupied.iter().filter(|&&spots| spots == 0).count(),
            tracks: ids.len(),
            spots: table.spots.len() - duplicates,
            left_out_untracked: table.untracked,
            left_out_duplicate: duplicates,
        };
        Ok(Self { positions, ids, summary })
    }
}

/// The smallest frame number and how many frames there are up to the largest.
pub(crate) fn frame_span(frames: impl Iterator<Item = i64> + Clone) -> Result<(i64, usize), TableFault> {
    let (Some(first), Some(last)) = (frames.clone().min(), frames.max()) else {
        return Err(TableFault::NoRows);
    };
    let count = last.abs_diff(first).saturating_add(1);
    match usize::try_from(count) {
        Ok(count) if count <= FRAME_LIMIT => Ok((first, count)),
        _ => Err(TableFault::TooManyFrames { first, last, limit: FRAME_LIMIT }),
    }
}
