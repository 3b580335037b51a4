//! HKL's conventions, read and written.

use texture::CrystalSymmetry;

/// HKL's numbers of the Laue groups, from 1.
pub(crate) const LAUE_GROUPS: [CrystalSymmetry; 11] = [
    CrystalSymmetry::Triclinic,
    CrystalSymmetry::Monoclinic,
    CrystalSymmetry::Orthorhombic,
    CrystalSymmetry::TetragonalLow,
    CrystalSymmetry::Tetragonal,
    CrystalSymmetry::TrigonalLow,
    CrystalSymmetry::Trigonal,
    CrystalSymmetry::HexagonalLow,
    CrystalSymmetry::Hexagonal,
    CrystalSymmetry::Tetrahedral,
    CrystalSymmetry::Octahedral,
];

/// The symmetry by HKL's number of its Laue group.
pub(crate) fn hkl_symmetry(number: usize) -> Option<CrystalSymmetry> {
    LAUE_GROUPS.get(number.checked_sub(1)?).copied()
}

/// By how many degrees HKL's phi2 is larger than ours: in trigonal and hexagonal crystals its x is along the normal of (10-10), ours along
/// a two-fold axis.
pub(crate) fn hkl_turn(symmetry: CrystalSymmetry) -> f64 {
    let is_turned = matches!(
        symmetry,
        CrystalSymmetry::TrigonalLow
            | CrystalSymmetry::Trigonal
            | CrystalSymmetry::HexagonalLow
            | CrystalSymmetry::Hexagonal
    );
    if is_turned { 30.0 } else { 0.0 }
}
