//! The boundary of a data set, for commands that do not know of all there are.

use crate::failure::Failure;
use voronudge_geometry::Domain;
use voronudge_io::{DataSet, Error, SettingFault};

/// The boundary as the geometry knows it, for what does not know of boxes that change.
pub(crate) fn domain(data: &DataSet) -> Result<Domain, Failure> {
    data.domain().map_err(unknown)
}

/// The boundary of a frame.
pub(crate) fn domain_at(data: &DataSet, frame: usize) -> Result<Domain, Failure> {
    data.domain_at(frame).map_err(unknown)
}

/// What a command says of a boundary that it does not know of.
pub(crate) fn unknown(error: Error) -> Failure {
    let hint = match &error {
        Error::Setting(SettingFault::Sheared) => "evaluate, spectrum and simulate --start do",
        Error::Setting(SettingFault::Walled { .. }) => {
            "only simulate, channel and spectrum do; without the line walls the box would be periodic, which is another tissue"
        }
        _ => return error.into(),
    };
    Failure::new(format!("{error}, which this command does not know of")).with_hint(hint)
}
