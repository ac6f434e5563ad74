//! Points of a triangulation.

/// What a point of a triangulation is: a cell or a periodic image of one.
#[derive(Clone, Copy)]
pub(super) struct Site {
    pub cell: u32,
    pub image: [i16; 2],
    pub role: Role,
}

/// Whether a site's ring is wanted, or only its presence.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Role {
    Own,
    Ghost,
}
