//! Errors as the user sees them: `error: …`, an empty line, `hint: …`.

use std::fmt;

/// Why a command did not run to its end.
#[derive(Debug)]
pub(crate) struct Failure {
    message: String,
    hint: Option<String>,
    exit_code: u8,
}

impl Failure {
    pub fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), hint: None, exit_code: 2 }
    }

    pub fn with_hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }

    /// The end of a rehearsal: no fault, but what would be done, for stdout.
    pub fn rehearsed(told: impl Into<String>) -> Self {
        Self { message: told.into(), hint: None, exit_code: 0 }
    }

    /// Ctrl-C. Nothing has been written.
    pub fn interrupted() -> Self {
        Self { message: "interrupted; nothing was written".into(), hint: None, exit_code: 130 }
    }

    /// Ctrl-C during a run that can be taken up again.
    pub fn interrupted_at(message: impl Into<String>) -> Self {
        Self { exit_code: 130, ..Self::new(message) }
    }

    /// Says where the fault is.
    pub fn at(mut self, place: impl fmt::Display) -> Self {
        self.message = format!("{place}: {}", self.message);
        self
    }

    /// Says where the fault is, unless the user ended the command.
    pub fn at_unless_interrupted(self, place: impl fmt::Display) -> Self {
        if self.exit_code == 130 { self } else { self.at(place) }
    }

    /// What is wrong, without advice.
    pub fn message(&self) -> &str {
        &self.message
    }

    /// The advice.
    pub fn hint(&self) -> Option<&str> {
        self.hint.as_deref()
    }

    pub fn exit_code(&self) -> u8 {
        self.exit_code
    }

    fn from_parts(error: impl fmt::Display, hint: Option<impl Into<String>>) -> Self {
        Self { message: error.to_string(), hint: hint.map(Into::into), exit_code: 2 }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "error: {}", self.message)?;
        if let Some(hint) = &self.hint {
            write!(f, "\n\nhint: {hint}")?;
        }
        Ok(())
    }
}

impl From<clap::Error> for Failure {
    /// A command line that cannot be read, told like every other fault.
    fn from(error: clap::Error) -> Self {
        let text = error.render().to_string();
        let message = text.split("\n\n").next().unwrap_or_default().trim_start_matches("error: ");
        let message = message.lines().map(str::trim).collect::<Vec<_>>().join(" ");
        let reason = std::error::Error::source(&error);
        let reason = reason.and_then(|reason| reason.downcast_ref::<voronudge_io::Error>());
        let tip = || {
            let tips = text.lines().filter_map(|line| line.trim().strip_prefix("tip: "));
            // The advice to write `-- -1` helps nobody.
            tips.map(str::to_owned).find(|tip| !tip.starts_with("to pass"))
        };
        let hint = reason.and_then(voronudge_io::Error::hint).or_else(tip);
        Self::new(message).with_hint(hint.unwrap_or_else(|| "--help shows what can be given".into()))
    }
}

impl From<voronudge_io::Error> for Failure {
    fn from(error: voronudge_io::Error) -> Self {
        let hint = error.hint();
        Self::from_parts(error, hint)
    }
}

impl From<voronudge_geometry::Error> for Failure {
    fn from(error: voronudge_geometry::Error) -> Self {
        let hint = error.hint();
        Self::from_parts(error, hint)
    }
}

impl From<voronudge_infer::Error> for Failure {
    fn from(error: voronudge_infer::Error) -> Self {
        if error == voronudge_infer::Error::Interrupted {
            return Self::interrupted();
        }
        let hint = error.hint();
        Self::from_parts(error, hint)
    }
}

impl From<crate::problem::Error> for Failure {
    fn from(error: crate::problem::Error) -> Self {
        let hint = error.hint();
        Self::from_parts(error, hint)
    }
}

impl From<voronudge_simulate::Error> for Failure {
    fn from(error: voronudge_simulate::Error) -> Self {
        if error == voronudge_simulate::Error::Interrupted {
            return Self::interrupted();
        }
        let hint = error.hint();
        Self::from_parts(error, hint)
    }
}

impl From<voronudge_observables::Error> for Failure {
    fn from(error: voronudge_observables::Error) -> Self {
        if error == voronudge_observables::Error::Interrupted {
            return Self::interrupted();
        }
        let hint = error.hint();
        Self::from_parts(error, hint)
    }
}

impl From<voronudge_spectrum::Error> for Failure {
    fn from(error: voronudge_spectrum::Error) -> Self {
        let hint = error.hint();
        Self::from_parts(error, hint)
    }
}

impl From<voronudge_report::ReportError> for Failure {
    fn from(error: voronudge_report::ReportError) -> Self {
        Self::new(error.to_string())
    }
}

impl From<serde_json::Error> for Failure {
    fn from(error: serde_json::Error) -> Self {
        Self::new(error.to_string())
    }
}
