//! Which messages of the program refuse input for a reason that lies in it, and name that.
//!
//! All other messages of exit status 1 count as failed results. Exit status 2 is a mistake on the command line, always in the
//! input.

/// A kind of error, and what its message holds: all of the words of one row.
type Kind = (&'static str, &'static [&'static str]);

/// The refusals among the errors of `grainsmooth::Error`, `voronoi::VoronoiError` and `polycrystal::NetworkError`.
///
/// Not here, so failed results: `BoundaryTooSmall`, `CutCrosses`, `CutInvalid`, `VolumeNotRestored`, `Folded`,
/// `Invalid`, `RemeshInvalid` and `WorksWithShortLines`, which are the program's own limits, and `WriteOutput`.
pub const REFUSALS: &[Kind] = &[
    // Paths and formats.
    ("UnknownExtension", &["unknown extension; name the file"]),
    ("FormatDimension", &["this format holds", "choose another"]),
    ("NoVoxels", &["this format holds voxels", "--voxels"]),
    ("NoTexture", &["this format holds orientations", "--texture"]),
    ("FormatSeveralFiles", &["standard output takes a single file"]),
    ("NoOutputDirectory", &["no directory", "create it or choose another path"]),
    ("OutputNotAFile", &["is not a regular file"]),
    ("OutputDirectoryTaken", &["is not an empty directory"]),
    ("OutputNotWritable", &["cannot be written", "make it writable or choose another path"]),
    // Files of seeds and domains.
    ("Unreadable", &["cannot be read", "give the path of a readable"]),
    ("NoSeedsInFile", &["holds no seeds"]),
    ("NoLatticeSeeds", &["no point of the lattice lies in the domain", "more unit cells"]),
    ("SeedProblem::NotUtf8", &["not UTF-8 text"]),
    ("SeedProblem::ColumnNames", &["columns named"]),
    ("SeedProblem::ColumnCount", &["columns; write"]),
    ("SeedProblem::UnequalColumns", &["columns, but earlier lines have", "write the same number"]),
    ("SeedProblem::OpenQuote", &["a quote is not closed on its line"]),
    ("SeedProblem::NamedTwice, SizedTwice", &["rename one of them"]),
    ("SeedProblem::NotANumber", &["is not a number; write"]),
    ("SeedProblem::NotFinite", &["is not a finite number; correct or remove the seed"]),
    ("SeedProblem::NegativeRadius", &["radius is", "write 0 or more"]),
    ("SeedProblem::NegativeDiameter", &["diameter is", "write 0 or more"]),
    ("SeedProblem::Tess, of other cells", &["its cell has the", "whose cells are those of its seeds"]),
    ("SeedProblem::Tess, of the domain", &["the domain is a", "give a file whose domain is a"]),
    ("SeedProblem::BadId", &["is not a whole number from 0 to", "number the seeds"]),
    ("SeedProblem::EmptyId", &["the id is empty", "number each seed"]),
    ("SeedProblem::IdTwice, NoId", &["give each seed its own, or"]),
    ("SeedProblem::NotInPlane", &["in a 2D run"]),
    ("HalfSpaceInFile", &["half-space", "line"]),
    // Files of orientations.
    ("TextureSymmetry", &["its crystals are", "give --crystal-symmetry"]),
    ("NoPlace", &["there is room", "grains; give the phase a smaller share, fewer grains or another place"]),
    ("NoPlace, none", &["there is no place", "or another place"]),
    (
        "NoRoomAround",
        &["the phases with place= are too crowded", "give them smaller shares or smaller grains"],
    ),
    ("PhasesError::FewGrains", &["grains cannot be of", "seeds or more"]),
    ("BadLine, no orientation", &["holds no orientation"]),
    // Sizes that are asked for.
    ("BadLine, no diameters", &["holds no diameters"]),
    ("GrainTooLarge", &["does not fit", "use a larger domain"]),
    ("VolumeCount", &["volumes for", "seeds; give one for each"]),
    // Seeds and domains.
    ("OutsideDomain", &["lies outside the domain"]),
    ("MapProblem::NoCells", &["cells cannot be fitted to its grains", "leave --fit-cells out"]),
    ("DuplicateSeeds", &["have the same position", "remove one of them"]),
    ("DuplicateSeedsInFile", &["the same seed", "twice; remove one of them"]),
    ("EmptyGrains", &["weights leave", "without volume", "--drop-empty"]),
    ("UnboundedDomain", &["half-spaces are unbounded in the direction"]),
    ("EmptyDomain", &["has nothing in common with those before it"]),
    ("BadDomain", &["every side must be between"]),
    ("FlatDomain", &["the domain between", "is flat"]),
    ("TooManyWalls", &["walls that a domain can have"]),
    // Counts.
    ("CellsExceedMemory", &["cells would take", "of memory"]),
    ("InsideError::NothingDivided", &["divides no grain", "at most"]),
    ("VoxelsExceedMemory", &["with so many voxels", "of memory"]),
    ("PartsExceedMemory", &["parts of grains would take", "of memory"]),
    ("LevelsExceedMemory", &["levels would take", "of memory"]),
    ("LevelsExceedIds", &["levels would make", "more than ids can name"]),
    ("TooLarge", &["more than 32-bit ids can name"]),
    ("CoarseReference", &["elements of", "need a finer surface", "give -n"]),
    ("LineTooShort", &["a triple line is only", "without --relax 0 and --regularize 0"]),
    ("ElementsWithoutSize", &["changes sizes of elements", "--elements-per-grain"]),
    ("TrianglesWithoutSize", &["needs triangles, which have a size in 2D", "give --elements-per-grain"]),
    ("PlaneStateInSpace", &["--plane-state is for elements in 2D", "give --dim 2"]),
    ("NoElementSize", &["triangles that fill grains have a size", "give --elements-per-grain"]),
    ("EquationsWithoutPeriods", &["--periodic-equations ties nodes", "give --periodic"]),
    ("CohesiveOrder", &["--cohesive makes elements", "none of second order"]),
    ("CohesiveDeck", &["--cohesive makes elements", "leave one of them out"]),
    ("DeckDomain", &["--solver-deck loads a box", "leave --domain"]),
    ("TouchesItself", &["touches its own image", "give more seeds"]),
    // Lines that are to be kept however short they are, and grains far smaller than the others.
    ("KeptShortLines", &["; without --regularize 0,", "it works"]),
    ("TinyGrain", &["too small beside the others", "merge such cells with --min-diameter"]),
    // Measured maps.
    ("MapProblem::Unfit", &["has voxels without a grain, and cells fill a box"]),
    ("MapProblem::Unfit, small grains", &["or more voxels besides the exterior; lower --min-voxels"]),
    ("MapProblem::Unfit, no confidence", &["its points have no confidence index; leave --min-ci out"]),
    ("MapProblem::Unfit, sections", &["has sections that share no place after they are aligned"]),
    ("ShortPeriod", &["where it repeats; at least", "are needed there"]),
    ("MapProblem::Crop", &["--crop asks for", "give a part of"]),
    ("MixedVoxels", &["single voxels of different grains are too mixed", "--min-voxels"]),
    ("RelaxesFolded", &["and cannot relax from there", "leave out --relax"]),
    ("EndlessGrain", &["meets its own image through the sides", "or take a larger map"]),
    ("PeriodicPores", &["a map that repeats has no exterior", "or leave the periods out"]),
    // A grain that vanishes while it is free to, where the message names a time that works, or how to take such grains out.
    ("GrainVanished", &["shrinks to nothing by", "; --relax ", " works"]),
    ("GrainVanished, at any time", &["shrinks to nothing by", "--min-diameter"]),
];

/// The kind of refusal that a message is, if it is one.
pub fn refusal(message: &str) -> Option<&'static str> {
    let fits = |(_, parts): &&Kind| parts.iter().all(|part| message.contains(part));
    REFUSALS.iter().find(fits).map(|(name, _)| *name)
}

/// The message with its numbers replaced, so that messages of one kind are alike.
pub fn without_numbers(message: &str) -> String {
    let mut kind = String::new();
    let mut rest = message;
    while let Some(start) = rest.find(|character: char| character.is_ascii_digit()) {
        let end = rest[start..].find(|character: char| !"0123456789.eE+-".contains(character));
        let end = end.map_or(rest.len(), |end| start + end);
        kind += rest[..start].trim_end_matches('-');
        kind.push('#');
        // A full stop or a dash at the end is none of the number.
        let number = rest[start..end].trim_end_matches(['.', '-', '+', 'e', 'E']);
        rest = &rest[start + number.len()..];
    }
    kind + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_of_one_kind_are_alike() {
        let messages = [
            "grain 3 has the wrong volume after relaxation, with a relative error of 1.25e-3; relax for a shorter time",
            "grain 17 has the wrong volume after relaxation, with a relative error of -2; relax for a shorter time",
        ];
        let kind = "grain # has the wrong volume after relaxation, with a relative error of #; relax for a shorter time";
        assert_eq!(messages.map(without_numbers), [kind, kind]);
        assert_eq!(without_numbers("elements 1 and 25."), "elements # and #.");
    }

    #[test]
    fn failures_of_the_program_are_no_refusals() {
        use polycrystal::{GrainId, NetworkError, Side};
        let sides = [Side::Grain(GrainId(0)), Side::Exterior];
        let grain = GrainId(4);
        for error in [
            NetworkError::BoundaryTooSmall { sides },
            NetworkError::CutCrosses { axis: "x" },
            NetworkError::VolumeNotRestored { grain, relative_error: 1.0 },
            NetworkError::Folded { count: 2, grains: Vec::new() },
        ] {
            assert_eq!(refusal(&error.to_string()), None, "{error}");
        }
    }
}
