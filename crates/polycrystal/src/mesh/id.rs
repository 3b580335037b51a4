/// A number as an id. Control points are far fewer than 2^32: [`Network`](crate::Network) has checked the number of their triangles.
pub(crate) fn id(index: usize) -> u32 {
    u32::try_from(index).expect("the control mesh was checked to fit 32-bit ids")
}
