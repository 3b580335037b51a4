"""The program's options as keywords. Written by tools/options.py from the program's own table: change options there."""

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
    """Number of grains, grown from random seeds [default: 200, or what --diameters or --volumes ask for]

    Example of the command line: ``--seeds 5000``"""

    seeding: Literal["random", "poisson-disc", "packed"]
    """Seeds as the centres of spheres that do not overlap, for grains of exact sizes as in metals (packed); random, uniform
    (random) or at least 0.75 mean spacings apart (poisson-disc)

    Packed grains have lognormal diameters with a coefficient of variation of 0.35, unless --diameters or --volumes ask for
    others. Random seeds make Voronoi cells, for the exact statistics of those.

    Example of the command line: ``--seeding random``

    Default: ``packed``"""

    lattice: Sequence[Value]
    """Seeds on a lattice instead: sc, bcc, fcc or hcp (square or hex in 2D), with N unit cells along the shortest side

    Example of the command line: ``--lattice bcc 4``"""

    seeds_file: Value
    """Read seeds from a file instead: text with x, y, z on each line (x, y in 2D), or with names of columns in the first line,
    where radius, diameter or weight makes power cells; .xyz; .json; or Neper's .tess, which tells the box as well

    Example of the command line: ``--seeds-file seeds.csv``"""

    diameters: Value
    """Give grains exact sizes: equivalent diameters of a distribution, in words or from a file, in the unit of --box

    Words are lognormal(mean=20, cv=0.35), normal(mean=20, sd=5), uniform(10, 30), weibull(shape=2.8, scale=20),
    gamma(mean=20, cv=0.35), equal(20), and sums of these with weights by number: '0.8*lognormal(mean=20, cv=0.3) +
    0.2*equal(60)'. Behind them may stand cut-offs, and that weights are by volume: ', from=5, to=80, by=volume'. A file
    (.csv, .txt) holds a list, a histogram or a distribution function. As many grains are made as fill the domain; with
    --seeds N, diameters are scaled to fill it.

    Example of the command line: ``--diameters 'lognormal(mean=20, cv=0.35)' --box 100 100 100``"""

    volumes: Value
    """Give each grain a volume of its own (in 2D an area), scaled to fill the domain: one on each line of a text file

    Example of the command line: ``--volumes volumes.csv``"""

    aspect_ratio: Sequence[Value]
    """Grains long along some axes, in proportion: 3 1 1 for rolled, 1 1 4 for columnar ones (X Y in 2D)

    Cells, network and relaxation are made where grains are as long along all axes, and stretched in the end: angles at
    triple lines are 120 degrees before. The box is as --box says, and volumes are as without.

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

    A sphere, cylinder or disc touches the sides of --box, which must be equal across its axis, and becomes a polyhedron of
    the same volume. A file has its own coordinates, so --box has no meaning with it.

    Example of the command line: ``--domain sphere``

    Default: ``box``"""

    half_spaces: Value
    """Read the domain as half-spaces n . x <= d from a text file: nx, ny, nz, d on each line (nx, ny, d in 2D)

    Example of the command line: ``--half-spaces octahedron.csv``"""

    chord_error: Value
    """How far the flat faces of a sphere, cylinder or disc may be from the true surface, in the unit of --box [default: 0.005
    of its radius]

    Example of the command line: ``--chord-error 0.001``"""

    periodic: Value
    """Axes along which the box repeats, such as x,y,z: grains are whole there and grow through the walls [default: none, or
    those of a .tess file]

    Example of the command line: ``--periodic x,y``"""

    faces: Literal["fan", "plain"]
    """Control points inside boundaries: a fan of triangles round one in the middle (fan), or none (plain)

    Example of the command line: ``--faces plain``

    Default: ``fan``"""

    edge_length: Value
    """Refine the control mesh instead until no edge is longer than H, in the unit of --box; a grain is about as wide as the
    cube root of its volume

    Example of the command line: ``--edge-length 0.05``"""

    free: bool
    """Let grains grow and shrink by curvature instead of keeping their volumes (in 2D: areas)

    In 2D grains vanish and switch neighbours on the way. In 3D, and with --regularize or --edge-length, they cannot: a run
    that would come to that is refused.

    Example of the command line: ``--dim 2 --relax 5 --free``"""

    rng_seed: Value
    """Start of the random generator: the same number gives the same grains on every machine

    Example of the command line: ``--rng-seed 7``

    Default: ``1``"""

    draw: Literal["quantiles", "random"]
    """Draw diameters as the middles of equal shares of the distribution (quantiles), or each by itself (random)

    Example of the command line: ``--diameters 'lognormal(mean=20, cv=0.35)' --draw random``

    Default: ``quantiles``"""

    gradient: Value
    """Change the diameters along an axis of the box: a table of positions, and what diameters are multiplied by there

    Example of the command line: ``--diameters 'lognormal(mean=20, cv=0.35)' --gradient z:factors.csv``"""

    phase: Repeated
    """Make a phase of a name, with a share of the volume that is exact (in 2D of the area); give it again for each phase

    Shares add up to 1. Behind them may stand what the grains of a phase have of their own: diameters= as of --diameters,
    texture= as of --texture, symmetry= as of --crystal-symmetry; and place=, where its grains are among the others:
    interior, boundaries, triple-lines, quadruple-points, clustered, dispersed.

    Example of the command line: ``--phase ferrite:0.8 --phase 'austenite:0.2,texture=goss(10)'``"""

    inside: Repeated
    """Divide the grains, or those of one phase, by a second tessellation: layers of a width, or Voronoi cells of a mean
    diameter, in the unit of --box; give it again for other phases

    Each part is a grain of its own, with an orientation of its own, and Parent tells whose part it is. Grains keep their
    volumes. Layers lie in a random direction in each grain, or across normal=; cells have lognormal diameters of a
    coefficient of variation cv= (0.35).

    Example of the command line: ``--inside 'lamellae(width=0.05)'; --inside 'beta:voronoi(diameter=0.1)' for one phase``"""

    drop_empty: bool
    """Go on without seeds whose neighbours outweigh them; else that is an error

    Example of the command line: ``--seeds-file spheres.csv --drop-empty``"""

    min_diameter: Value
    """Merge cells below F mean equivalent diameters into what surrounds them; 0 keeps all

    The smallest cell below loses its seed and the cells are made again, so that its neighbours grow into its place, until
    none is below. The grains have the volumes of these cells. SeedId leads from their numbers back to the seeds.

    Example of the command line: ``--min-diameter 0.2``

    Default: ``0``"""

    lloyd: Value
    """Even out the grains: move every seed to the centroid of its cell, N times; exact sizes are kept [default: 10 for packed
    grains, and where else --diameters or --volumes give sizes, but no --seeds-file the places; 0 for others]

    Example of the command line: ``--lloyd 10``"""

    grain_shapes: Value
    """Give each grain a shape: an ellipsoid (in 2D an ellipse) with lengths in proportion, in a random direction or along x, y
    and z

    Grains are several cells each, which makes them as long as there is room for; volumes are as exact as without, and the
    summary tells the ratio that was reached. A file (.csv, .txt) has a line for each grain: lengths a, b, c and Bunge's
    Euler angles phi1, Phi, phi2 in degrees, in 2D a, b and phi1. Relaxation rounds grains: --relax tells how far.

    Example of the command line: ``--grain-shapes '3:1:1 aligned'``"""

    periodic_cut: Literal["wrap", "box"]
    """Grains of a periodic box whole, sticking out of it where they grow through a wall (wrap), or cut at its walls (box)

    Example of the command line: ``--periodic x,y,z --periodic-cut box``

    Default: ``wrap``"""

    relax: Value
    """Relaxation time, in units of the mean grain size squared, or `equilibrium`; 0 keeps boundaries flat [default: 1.2, in 2D
    equilibrium; 0 with lamellae, 0.05 with --grain-shapes, 0.3 with --free or --regularize, in 2D with --edge-length too]

    Example of the command line: ``--relax 0.1``"""

    wall_tension: Value
    """Tension of the walls, in units of that between grains, of the largest with --tension; 0 lets boundaries meet walls at
    right angles

    Example of the command line: ``--wall-tension 0.5``

    Default: ``0``"""

    tension: Repeated
    """Tension of boundaries between grains, in any unit: a number, read-shockley(15) over the disorientation, that times a
    number, or a table of angles and tensions; with PHASE/PHASE: before it, of boundaries between these [default: 1]

    Example of the command line: ``--texture 'goss(10)' --tension 'read-shockley(15)'``"""

    mobility: Repeated
    """Mobility of boundaries between grains that grow, in any unit: a law as of --tension, such as humphreys(15) [default: 1]

    Example of the command line: ``--relax 0.02 --free --texture 'goss(10)' --mobility 'humphreys(15)'``"""

    regularize: Value
    """Keep the neighbours of the cells instead of letting grains switch them, but for edges shorter than L mean grain sizes,
    which become points; 0 keeps all

    Example of the command line: ``--regularize 0.05``"""

    levels: Value
    """Number of subdivisions; each makes four triangles of one (two segments in 2D)

    Example of the command line: ``-n 2``

    Default: ``3``"""

    junctions: Literal["crease", "corner"]
    """Triple lines as smooth curves (crease) or as polylines through all their control points (corner)

    Example of the command line: ``--junctions corner``

    Default: ``crease``"""

    element_size: Value
    """Remesh boundaries with triangles whose edges are H long, in the unit of --box

    Example of the command line: ``--element-size 0.02``"""

    elements_per_grain: Value
    """The same with edges of which K make the mean diameter of the grains

    Example of the command line: ``--elements-per-grain 5 --relax equilibrium``"""

    adapt_curvature: Value
    """Smaller triangles where boundaries are curved: edges no longer than S times the radius of curvature

    Example of the command line: ``--elements-per-grain 5 --adapt-curvature 0.3``"""

    size_growth: Value
    """How much longer edges may become per length, away from short triple lines and other narrow places [default: 0.4]

    Example of the command line: ``--elements-per-grain 5 --size-growth 0.2``"""

    texture: Value
    """Give each grain an orientation: random, components with halfwidths in degrees, or a file

    Components are cube, goss, brass, copper, s and others; {112}<-1-11>(10); euler(30 45 60, 10); fiber(111||z, 10);
    gamma(10). Sums have weights by volume: 'cube(5)*0.3 + random*0.7'. A file holds Euler angles with weights (.csv, .txt),
    Neper's orientations (.ori), or a measured map (.ang, .ctf).

    Example of the command line: ``--texture 'goss(10)'``"""

    crystal_symmetry: Value
    """Symmetry of the crystals: cubic, hexagonal, trigonal, tetragonal, orthorhombic, monoclinic, triclinic, or a group such
    as 432 or m-3m

    Example of the command line: ``--texture 'basal(20)' --crystal-symmetry hexagonal``

    Default: ``cubic``"""

    sample_symmetry: Value
    """Symmetry of the sample: triclinic (none) or orthorhombic, as of rolled sheet, where each component comes in all its
    variants

    Example of the command line: ``--texture 'copper(8) + s(8) + brass(8)' --sample-symmetry orthorhombic``

    Default: ``triclinic``"""

    misorientations: Value
    """Swap orientations until the disorientations of neighbours, by area, have the histogram in a file: on each line the upper
    end of a bin in degrees, and its weight

    Example of the command line: ``--texture random --misorientations angles.csv``"""

    voxels: Sequence[Value]
    """Number of voxels along each axis, for formats that hold voxels, X Y in 2D

    Example of the command line: ``--voxels 64 64 64 -o grains.vti``"""

    ascii: bool
    """Write STL as text

    Example of the command line: ``--ascii -o grains.stl``"""

    names: Literal["grainsmooth", "dream3d", "pyvista", "virmat", "neper"]
    """Names and numbers of arrays as another tool expects them

    Example of the command line: ``--names dream3d``

    Default: ``grainsmooth``"""

    arrays: bool
    """Add arrays of what is measured to VTK files: curvatures, dihedral angles, areas, volumes, growth rates

    Example of the command line: ``--arrays -o grains.vtm``"""

    volume_mesh: bool
    """Write tetrahedra that fill the grains to .msh and .vtu, which else hold boundaries; .inp and .bdf always have them

    Example of the command line: ``--elements-per-grain 5 --volume-mesh -o grains.vtu``"""

    periodic_equations: bool
    """Tie the nodes of .inp that stand a period apart by equations, with a node for each axis that moves as the box is to be
    stretched

    Example of the command line: ``--periodic x,y,z --elements-per-grain 4 --periodic-equations -o grains.inp``"""

    cohesive: bool
    """Give each grain of .inp nodes of its own, and put cohesive elements (COH3D6 of Abaqus) between the grains, which may
    part

    Example of the command line: ``--elements-per-grain 4 --cohesive -o grains.inp``"""

    solver_deck: Literal["tension-x"]
    """Write a job for CalculiX and Abaqus beside .inp: the box pulled along x, with the elasticity of a crystal for each phase

    Example of the command line: ``--texture random --elements-per-grain 4 --solver-deck tension-x -o grains.inp``"""

    vtk_encoding: Literal["raw", "base64", "zlib"]
    """How .vtp, .vtu, .vti and .vtm hold their numbers: raw is the fastest; base64 and zlib are read by more programs

    Example of the command line: ``--vtk-encoding zlib -o grains.vtu``

    Default: ``raw``"""
