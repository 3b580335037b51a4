"""The program's options as keywords. Written by the test `python_keywords` from the program's own: change options there."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Literal, TypedDict, Union

#: A number, a text or a path, as the command line has it.
Value = Union[int, float, str, "os.PathLike[str]"]

#: The value of an option that can be given several times: one, or a list; parts with names, as of a phase, are a dictionary.
Repeated = Union[Value, Mapping[str, Value], Sequence[Union[Value, Mapping[str, Value]]]]


class Options(TypedDict, total=False):
    """What shapes a polycrystal, and how its files are written.

    Names, defaults, ranges and messages are those of the program ``grainsmooth``: ``--rng-seed 7`` is ``rng_seed=7``. An option that is
    ``None`` is not given.
    """

    seeds: Value
    """Number of grains [default: 200, or what ``diameters`` or ``volumes`` ask for]

    Example of the command line: ``--seeds 5000``"""

    seeding: Literal["random", "poisson-disc", "packed"]
    """How seeds are placed: as centres of spheres that do not overlap, for grains of exact, realistic sizes (packed);
    uniformly at random (random); or at random but at least 0.75 mean spacings apart (poisson-disc)

    Packed grains have lognormal diameters with a coefficient of variation of 0.35, unless ``diameters`` or ``volumes`` ask
    for others. Random seeds give Poisson-Voronoi cells, whose statistics are known.

    Example of the command line: ``--seeding random``

    Default: ``packed``"""

    lattice: Sequence[Value]
    """Place seeds on a lattice instead: sc, bcc, fcc or hcp (square or hex in 2D), with N unit cells along the shortest side

    Example of the command line: ``--lattice bcc 4``"""

    seeds_file: Value
    """Read seeds from a file instead: text with x, y, z on each line (x, y in 2D), or with column names in the first line,
    where radius, diameter or weight makes power cells; .xyz; .json; or Neper's .tess, which also defines the box

    Example of the command line: ``--seeds-file seeds.csv``"""

    diameters: Value
    """Give the grains exact sizes: equivalent diameters from a distribution or a file, in the unit of ``box``

    Distributions are lognormal(mean=20, cv=0.35), normal(mean=20, sd=5), uniform(10, 30), weibull(shape=2.8, scale=20),
    gamma(mean=20, cv=0.35), equal(20), and sums of these weighted by number: '0.8*lognormal(mean=20, cv=0.3) +
    0.2*equal(60)'. Cut-offs, and weights by volume, follow after commas: ', from=5, to=80, by=volume'. A file (.csv, .txt)
    holds a list, a histogram or a cumulative distribution. There are as many grains as fill the domain; with ``seeds`` N,
    diameters are scaled to fill it.

    Example of the command line: ``--diameters 'lognormal(mean=20, cv=0.35)' --box 100 100 100``"""

    volumes: Value
    """Give each grain its own volume (area in 2D), scaled to fill the domain: a text file with one volume on each line

    Example of the command line: ``--volumes volumes.csv``"""

    aspect_ratio: Sequence[Value]
    """Elongate the grains along the axes, in these proportions: 3 1 1 for rolled, 1 1 4 for columnar grains (X Y in 2D)

    Grains are made and relaxed with equal axes, so triple lines have angles of 120 degrees at first, and then stretched.
    The final box is that of ``box``, and volumes stay exact.

    Example of the command line: ``--aspect-ratio 3 1 1``"""

    dim: Value
    """Dimensions: 3 for grains in a box, 2 for grains in a rectangle [default: 3, or those of a .tess file]

    Example of the command line: ``--dim 2``"""

    box: Sequence[Value]
    """Side lengths of the box in your unit of length, X Y in 2D; a corner is at 0 0 0 [default: 1 1 1, or those of a .tess
    file]

    Example of the command line: ``--box 100 100 20``"""

    domain: Value
    """Shape of the domain: box, sphere, cylinder (along z), disc (2D), or the file of a closed convex surface, such as .obj or
    .stl

    A sphere, cylinder or disc touches the sides of ``box``, which must be equal across its axis, and becomes a polyhedron
    of the same volume. A file has its own coordinates, so ``box`` does not apply.

    Example of the command line: ``--domain sphere``

    Default: ``box``"""

    half_spaces: Value
    """Define the domain by half-spaces n . x <= d in a text file: nx, ny, nz, d on each line (nx, ny, d in 2D)

    Example of the command line: ``--half-spaces octahedron.csv``"""

    chord_error: Value
    """How far the flat faces of a sphere, cylinder or disc may be from the true surface, in the unit of ``box`` [default:
    0.005 of its radius]

    Example of the command line: ``--chord-error 0.001``"""

    periodic: Value
    """Axes along which the box is periodic, such as x,y,z: grains continue across these walls and stay whole [default: none,
    or those of a .tess file]

    Example of the command line: ``--periodic x,y``"""

    faces: Literal["fan", "plain"]
    """Triangulate each boundary as a fan around a control point in its middle (fan), or without points inside (plain)

    Example of the command line: ``--faces plain``

    Default: ``fan``"""

    edge_length: Value
    """Refine the control mesh until no edge is longer than H, in the unit of ``box``; this replaces ``faces``

    Example of the command line: ``--edge-length 0.05``"""

    free: bool
    """Let grains grow and shrink by curvature instead of keeping their volumes (areas in 2D)

    Grains vanish and switch neighbours on the way. With ``regularize``, in 2D with ``edge_length``, and in grains of
    several cells, they cannot; a run that would need it stops with an error.

    Example of the command line: ``--dim 2 --relax 5 --free``"""

    rng_seed: Value
    """Seed of the random number generator: the same number gives the same grains on every machine

    Example of the command line: ``--rng-seed 7``

    Default: ``1``"""

    draw: Literal["quantiles", "random"]
    """Take the diameters at equally spaced quantiles of the distribution (quantiles), or draw each independently (random)

    Example of the command line: ``--diameters 'lognormal(mean=20, cv=0.35)' --draw random``

    Default: ``quantiles``"""

    gradient: Value
    """Vary the diameters along an axis of the box: a table of positions and of the factors by which diameters are multiplied
    there

    Example of the command line: ``--diameters 'lognormal(mean=20, cv=0.35)' --gradient z:factors.csv``"""

    phase: Repeated
    """Add a phase with an exact share of the volume (of the area in 2D); repeat for each phase

    Shares add up to 1. Each phase can have its own diameters=, texture= and symmetry=, with the values of ``diameters``,
    ``texture`` and ``crystal_symmetry``. place= says where its grains lie among the others: interior, boundaries,
    triple-lines, quadruple-points, clustered or dispersed.

    Example of the command line: ``--phase ferrite:0.8 --phase 'austenite:0.2,texture=goss(10)'``"""

    inside: Repeated
    """Subdivide the grains, or those of one phase, into lamellae of a given width or Voronoi cells of a given mean diameter,
    in the unit of ``box``; repeat for other phases

    Each part becomes a grain with its own orientation, and the array Parent names the grain that it belongs to. Those
    grains keep their volumes. Lamellae lie in a random direction in each grain, or across normal=; cells have lognormal
    diameters with a coefficient of variation of cv= (0.35).

    Example of the command line: ``--inside 'lamellae(width=0.05)'; --inside 'beta:voronoi(diameter=0.1)' for one phase``"""

    drop_empty: bool
    """Drop seeds without a cell, because their neighbours outweigh them; without this option they are an error

    Example of the command line: ``--seeds-file spheres.csv --drop-empty``"""

    min_diameter: Value
    """Merge cells smaller than F mean equivalent diameters into their surroundings; 0 keeps all

    The smallest such cell loses its seed and all cells are computed again, so that its neighbours fill its space, until no
    cell is too small. The grains have the volumes of these last cells. SeedId maps their numbers back to the seeds.

    Example of the command line: ``--min-diameter 0.2``

    Default: ``0``"""

    lloyd: Value
    """Make the grains more regular: move every seed to the centroid of its cell, N times; exact sizes are kept [default: 10
    where grains have given volumes, as packed ones do, unless ``seeds_file`` says where they are; otherwise 0]

    Example of the command line: ``--lloyd 10``"""

    grain_shapes: Value
    """Give each grain a shape: an ellipsoid (an ellipse in 2D) of the given axis ratios, in a random direction or aligned with
    x, y and z

    Each grain then consists of several cells, which make it as elongated as space allows. Volumes stay exact, and the
    summary reports the ratio that was reached. A file (.csv, .txt) has one line for each grain: lengths a, b, c and Bunge's
    Euler angles phi1, Phi, phi2 in degrees (a, b and phi1 in 2D). Relaxation makes grains rounder; ``relax`` sets for how
    long it acts.

    Example of the command line: ``--grain-shapes '3:1:1 aligned'``"""

    periodic_cut: Literal["wrap", "box"]
    """Keep the grains of a periodic box whole, sticking out where they cross its walls (wrap), or cut them at the walls (box)

    Example of the command line: ``--periodic x,y,z --periodic-cut box``

    Default: ``wrap``"""

    relax: Value
    """Relaxation time, in units of the mean grain size squared, or `equilibrium`; 0 keeps boundaries flat [default: 1.2, in 2D
    equilibrium; 0 with lamellae, 0.05 for grains of several cells, 0.3 with ``free`` or ``regularize``, in 2D with
    ``edge_length`` too]

    Example of the command line: ``--relax 0.1``"""

    wall_tension: Value
    """Tension of the walls, relative to that between grains, or with ``tension`` to the largest of these; with 0, boundaries
    meet the walls at right angles

    Example of the command line: ``--wall-tension 0.5``

    Default: ``0``"""

    tension: Repeated
    """Tension (energy per area) of boundaries between grains, in any unit: a number; read-shockley(15), a function of the
    disorientation, or a multiple of it; or a table of angles and tensions. PHASE/PHASE: in front makes it the tension
    between these phases [default: 1]

    Example of the command line: ``--texture 'goss(10)' --tension 'read-shockley(15)'``"""

    mobility: Repeated
    """Mobility of the boundaries between growing grains, in any unit: a law as for ``tension``, such as humphreys(15)
    [default: 1]

    Example of the command line: ``--relax 0.02 --free --texture 'goss(10)' --mobility 'humphreys(15)'``"""

    regularize: Value
    """Do not let grains switch neighbours; only edges shorter than L mean grain sizes become points. 0 keeps every edge

    Example of the command line: ``--regularize 0.05``"""

    levels: Value
    """Number of subdivisions; each divides every triangle into four (in 2D every segment into two)

    Example of the command line: ``-n 2``

    Default: ``3``"""

    junctions: Literal["crease", "corner"]
    """Smooth the triple lines (crease), or leave them as polylines through their control points (corner)

    Example of the command line: ``--junctions corner``

    Default: ``crease``"""

    element_size: Value
    """Remesh boundaries with triangles whose edges are H long, in the unit of ``box``

    Example of the command line: ``--element-size 0.02``"""

    elements_per_grain: Value
    """Set the edge length to 1/K of the mean grain diameter instead

    Example of the command line: ``--elements-per-grain 5 --relax equilibrium``"""

    adapt_curvature: Value
    """Use smaller triangles where boundaries are curved: edges no longer than S times the radius of curvature

    Example of the command line: ``--elements-per-grain 5 --adapt-curvature 0.3``"""

    size_growth: Value
    """How fast edges may grow with the distance from short triple lines and other narrow places, as length per length
    [default: 0.4]

    Example of the command line: ``--elements-per-grain 5 --size-growth 0.2``"""

    small_features: Literal["keep", "merge"]
    """Keep triple lines that are shorter than the elements, with smaller elements around them (keep), or turn them into points
    where every grain stays a closed ball (merge)

    Example of the command line: ``--elements-per-grain 3 --small-features merge``

    Default: ``keep``"""

    texture: Value
    """Give each grain an orientation: random, components with halfwidths in degrees, or a file

    Components are cube, goss, brass, copper, s and others; {112}<-1-11>(10); euler(30 45 60, 10); fiber(111||z, 10);
    gamma(10). Sums are weighted by volume: 'cube(5)*0.3 + random*0.7'. A file holds Euler angles with weights (.csv, .txt),
    Neper's orientations (.ori), or a measured map (.ang, .ctf).

    Example of the command line: ``--texture 'goss(10)'``"""

    crystal_symmetry: Value
    """Symmetry of the crystals: cubic, hexagonal, trigonal, tetragonal, orthorhombic, monoclinic, triclinic, or a group such
    as 432 or m-3m

    Example of the command line: ``--texture 'basal(20)' --crystal-symmetry hexagonal``

    Default: ``cubic``"""

    sample_symmetry: Value
    """Symmetry of the sample: triclinic (none), or orthorhombic as for rolled sheet, where each component has all its variants

    Example of the command line: ``--texture 'copper(8) + s(8) + brass(8)' --sample-symmetry orthorhombic``

    Default: ``triclinic``"""

    misorientations: Value
    """Swap orientations until the disorientations between neighbours, weighted by area, match a histogram: a file with the
    upper end of a bin in degrees and its weight on each line

    Example of the command line: ``--texture random --misorientations angles.csv``"""

    voxels: Sequence[Value]
    """Number of voxels along each axis, for formats that hold voxels; X Y in 2D [default with a map: those of the map]

    Example of the command line: ``--voxels 64 64 64 -o grains.vti``"""

    ascii: bool
    """Write STL files as text

    Example of the command line: ``--ascii -o grains.stl``"""

    names: Literal["grainsmooth", "dream3d", "pyvista", "virmat", "neper"]
    """Name and number the arrays as another program expects

    Example of the command line: ``--names dream3d``

    Default: ``grainsmooth``"""

    arrays: bool
    """Add measured quantities to VTK files as arrays: curvatures, dihedral angles, areas, volumes, growth rates

    Example of the command line: ``--arrays -o grains.vtm``"""

    volume_mesh: bool
    """Write tetrahedra (in 2D triangles) that fill the grains to .msh and .vtu, which otherwise hold boundaries; .inp and .bdf
    always hold such elements; with ``voxels`` .vtu holds hexahedra (squares)

    Example of the command line: ``--elements-per-grain 5 --volume-mesh -o grains.vtu``"""

    order: Value
    """Order of the tetrahedra or triangles: 1, or 2 for a node in the middle of each edge, on the smooth surface where
    boundaries are remeshed [default: 1]

    Example of the command line: ``--elements-per-grain 3 --order 2 -o grains.inp``"""

    periodic_equations: bool
    """Tie nodes of .inp that are one period apart by equations, with a node for each axis that controls the mean strain

    Example of the command line: ``--periodic x,y,z --elements-per-grain 4 --periodic-equations -o grains.inp``"""

    cohesive: bool
    """Give each grain of .inp its own nodes, and put cohesive elements (COH3D6 of Abaqus, in 2D COH2D4) between the grains

    Example of the command line: ``--elements-per-grain 4 --cohesive -o grains.inp``"""

    plane_state: Literal["stress", "strain"]
    """What holds across the plane of 2D elements: no stress (CPS3, CPS6 and CPS4 of .inp), or no strain (CPE3, CPE6, CPE4)
    [default: stress]

    Example of the command line: ``--dim 2 --elements-per-grain 5 --plane-state strain -o grains.inp``"""

    solver_deck: Literal["tension-x"]
    """Write a job for CalculiX and Abaqus next to .inp: the box is stretched along x, with the elastic constants of a crystal
    for each phase

    Example of the command line: ``--texture random --elements-per-grain 4 --solver-deck tension-x -o grains.inp``"""

    vtk_encoding: Literal["raw", "base64", "zlib"]
    """How .vtp, .vtu, .vti and .vtm store numbers: raw is fastest; more programs read base64 and zlib

    Example of the command line: ``--vtk-encoding zlib -o grains.vtu``

    Default: ``raw``"""


class MapOptions(TypedDict, total=False):
    """How a measured map is read: the options of ``grainsmooth smooth``, as :class:`Options` has those of the program."""

    label_array: Value
    """Array of the labels, if a file has several [default: the only integer array, or one with a usual name]

    Example of the command line: ``grainsmooth smooth map.vti --label-array FeatureIds``"""

    spacing: Union[Value, Sequence[Value]]
    """Edge of a voxel, one length or one along each axis [default: as the file says, else 1]

    Example of the command line: ``grainsmooth smooth map.npy --spacing 0.5 0.5 0.8``"""

    axes: Literal["xyz", "zyx"]
    """Order of the indices of an array: xyz, as in labels[x, y, z], or zyx [default: xyz]

    Example of the command line: ``grainsmooth smooth map.npy --axes zyx``"""

    shape: Sequence[Value]
    """Number of voxels along each axis, for files that hold only numbers; x varies fastest

    Example of the command line: ``grainsmooth smooth map.raw --shape 200 200 150 --type u16``"""

    type: Value
    """Type of the numbers in such a file, little-endian: u8, i8, u16, i16, u32, i32, u64, i64, f32 or f64

    Example of the command line: ``grainsmooth smooth map.raw --shape 200 200 150 --type u16``"""

    crop: Value
    """Part of the map: along each axis, the first voxel and the one after the last, from 0; in orientation maps, rows count
    from the top

    Example of the command line: ``grainsmooth smooth map.vti --crop 0:64,0:64,10:40``"""

    exterior_label: Value
    """Label of everything that is not a grain, such as pores or the surroundings; negative labels are never grains

    Example of the command line: ``grainsmooth smooth map.vti --exterior-label 0``"""

    min_voxels: Value
    """Least number of voxels, pixels or points of a grain; those of smaller grains go to the neighbours that they touch most

    Example of the command line: ``grainsmooth smooth map.vti --min-voxels 8``

    Default: ``1``"""

    parts: Literal["keep", "split"]
    """What becomes of a label whose voxels hang together in several parts: one grain of several bodies (`keep`), or a grain
    for each part (`split`)

    Voxels hang together through their faces. `SeedId` is the label of all parts.

    Example of the command line: ``grainsmooth smooth map.vti --parts split --min-voxels 8``

    Default: ``keep``"""

    periodic: Value
    """Axes along which the map repeats, such as x,y,z: its last voxels touch the first, and grains stay whole [default: none]

    Example of the command line: ``grainsmooth smooth phase_field.vti --periodic x,y,z``"""

    threshold: Value
    """Largest angle in degrees between neighbouring points of one grain [default: 5]

    Example of the command line: ``grainsmooth smooth map.ctf --threshold 10``"""

    min_ci: Value
    """Least confidence index of a point; points below it are filled from their neighbours

    Example of the command line: ``grainsmooth smooth map.ang --min-ci 0.1``"""

    min_iq: Value
    """Least image quality of a point, or band contrast in .ctf; points below it are filled from their neighbours

    Example of the command line: ``grainsmooth smooth map.ang --min-iq 120``"""

    min_pore: Value
    """Least number of connected points without a good solution that form a pore; fewer are filled from their neighbours
    [default: all are filled]

    Example of the command line: ``grainsmooth smooth map.ang --min-pore 200``"""

    merge_twins: Value
    """Merge twins into one grain: those rotated by this angle about this axis of the crystal

    The axis has components along the orthogonal axes of the crystal; in hexagonal ones x is along a and z along c. A grain
    of several twins has the orientation and the spread of its largest part.

    Example of the command line: ``grainsmooth smooth nickel.ang --merge-twins 60,1,1,1``"""

    twin_tolerance: Value
    """Tolerance of ``merge_twins`` in degrees [default: 3]

    Example of the command line: ``grainsmooth smooth nickel.ang --merge-twins 60,1,1,1 --twin-tolerance 5``"""

    rotate: Value
    """Rotate all crystals by an angle about an axis of the sample; points stay where they are

    Example of the command line: ``grainsmooth smooth map.ang --rotate 180,1,0,0``"""

    align: bool
    """Shift the sections of a stack so that crystals agree best with those of the section before

    Sections move by whole points; what is not in all of them afterwards is left out.

    Example of the command line: ``grainsmooth smooth sections --align --spacing 0.25 0.25 0.3``"""

    crystal_symmetry: Value
    """Symmetry of the crystals, if the file gives none

    Example of the command line: ``grainsmooth smooth map.ang --crystal-symmetry cubic``"""

    decimate: Value
    """Collapse edges of boundaries that are shorter than H voxels, and give grains their volumes again; 0 keeps all edges, and
    every voxel in its grain [default: 1.75; in the plane 0]

    Around small grains edges stay shorter, at most a quarter of the grain.

    Example of the command line: ``grainsmooth smooth map.vti --decimate 3``"""

    fit_cells: bool
    """Fit a power diagram instead of smooth boundaries: convex cells with the volumes of the grains, and with their centroids
    as far as that goes

    A synthetic twin of the map. The summary tells how many voxels agree.

    Example of the command line: ``grainsmooth smooth map.vti --fit-cells -o twin.vtp``"""

    levels: Value
    """Times that boundaries are subdivided in the end; each time, a triangle becomes four (in the plane, a segment two)

    The points that boundaries had before stay where they are, but for what gives grains their volumes again.

    Example of the command line: ``grainsmooth smooth map.vti --decimate 3 -n 2``

    Default: ``0``"""

    relax: Value
    """Move boundaries toward the equilibrium of their tension for this time, in units of the mean grain size squared, or to
    `equilibrium`; grains keep their volumes [default: 0]

    This moves boundaries away from where they were measured. Neighbours stay neighbours.

    Example of the command line: ``grainsmooth smooth map.vti --relax 0.1``"""
