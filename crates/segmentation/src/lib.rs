//! Cells in images: what is seen of them, and which cell of a frame is which of the next.
//!
//! Cells are regions of a label image ([`Mask`]), polygons ([`Outline`]) or extrema of a field ([`extrema`]). Of regions and polygons come centroids,
//! areas, perimeters, contacts and the lines along which cells touch ([`Interface`](voronudge_geometry::Interface)); [`agreement`] says how well Voronoi
//! polygons stand for them. [`link_overlapping`] and [`link_nearest`] follow cells from frame to frame.
//!
//! Files, units and the sense of y are no concern of this crate.
//!
//! ```
//! use voronudge_segmentation::Mask;
//!
//! // Two cells beside each other, a line of background below them.
//! let labels = [3, 3, 7, 7, 3, 3, 7, 7, 0, 0, 0, 0];
//! let mask = Mask::new(&labels, [4, 3])?;
//! let cells = mask.cells();
//! assert_eq!((cells[0].label, cells[0].area, cells[0].centroid.x), (3, 4.0, 1.0));
//! assert!(mask.contacts(0).contains(&[3, 7]));
//! # Ok::<(), voronudge_segmentation::Error>(())
//! ```

mod agreement;
mod error;
mod extrema;
mod interface;
mod linking;
mod mask;
mod outline;
mod raster;

pub use agreement::{Agreement, MeasuredShape, agreement, comparable};
pub use error::Error;
pub use extrema::{Extremum, ExtremumKind, ExtremumSearch, extrema};
pub use interface::outline_interfaces;
pub use linking::{link_nearest, link_overlapping};
pub use mask::{Mask, MaskedCell};
pub use outline::{Outline, outline_contacts};
pub use raster::{Edge, smooth};
