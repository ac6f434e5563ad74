//! What a test of an effect that was added comes to, with all others in the model.

/// One effect added, tested with all others in the model.
pub(super) struct Tested {
    pub candidate: usize,
    pub p: f64,
    pub adjusted_p: f64,
    pub(super) statistic: f64,
    pub(super) size: f64,
    /// Why it does not stand without some of the data, if it does not.
    pub(super) weakness: Option<&'static str>,
    /// Other candidates in its place: lead over them in the linear problem, and their coefficients.
    pub(super) others: Vec<(usize, f64, Vec<f64>)>,
}

impl Tested {
    /// Why it is taken back at a level, if it is.
    pub fn reason_against(&self, level: f64) -> Option<&'static str> {
        match self.adjusted_p >= level {
            true => Some("with all else in the model it is no more than chance"),
            false => self.weakness,
        }
    }
}
