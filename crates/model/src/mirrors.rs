//! What mirrors do to vectors.

/// What an image does to the components of a vector: bit `k` of its number among the images says that mirror `k` reverses it.
pub fn signs_of(image: usize, mirrors: &[usize]) -> [f64; 2] {
    let mut signs = [1.0; 2];
    for (bit, &axis) in mirrors.iter().enumerate() {
        if image >> bit & 1 == 1 {
            signs[axis] = -1.0;
        }
    }
    signs
}
