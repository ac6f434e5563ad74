//! Blocks of derivatives: of one vector in the plane by another.

/// A 2 × 2 block, `[xx, xy, yx, yy]`.
pub(super) type Block = [f64; 4];

/// The block of a place by itself.
pub(super) const IDENTITY: Block = [1.0, 0.0, 0.0, 1.0];

/// Adds the product of two blocks.
pub(super) fn accumulate(sum: &mut Block, a: &Block, b: &Block) {
    sum[0] += a[0] * b[0] + a[1] * b[2];
    sum[1] += a[0] * b[1] + a[1] * b[3];
    sum[2] += a[2] * b[0] + a[3] * b[2];
    sum[3] += a[2] * b[1] + a[3] * b[3];
}
