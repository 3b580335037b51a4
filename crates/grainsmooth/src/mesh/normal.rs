use glam::DVec3;

/// The unit normal of a triangle; zero where it has no area.
pub(crate) fn unit_normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    // Of edges of length one: the product of tiny ones would vanish.
    (b - a).normalize_or_zero().cross((c - a).normalize_or_zero()).normalize_or_zero()
}
