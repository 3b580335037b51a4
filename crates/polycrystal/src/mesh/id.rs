/// A number as an id. All that is numbered is far fewer than 2^32: [`Network`](crate::Network) checks the number of triangles.
///
/// # Panics
/// When it is not.
pub(crate) fn id(index: usize) -> u32 {
    u32::try_from(index).expect("ids fit 32 bits")
}
