"""Subdivision of meshes and polylines."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple, Union

import numpy as np
import numpy.typing as npt

from . import _grainsmooth, _inputs

Floats = npt.NDArray[np.float64]

#: Edges as pairs of points, or with a sharpness for each: after so many levels they smooth out.
Creases = Union[Sequence[tuple[int, int]], Mapping[tuple[int, int], float]]

#: Points, or points with a sharpness for each.
Corners = Union[Sequence[int], Mapping[int, float]]


class Subdivided(NamedTuple):
    """A mesh after subdivision."""

    #: Its points, float64 of shape (n, 3).
    points: Floats
    #: Its triangles, uint32 of shape (m, 3); of other schemes a list of the points of each face, or of each polyline.
    faces: Any
    #: Where each point ends up on the limit surface, float64 of shape (n, 3); None for schemes without such a formula, or where it was not asked for.
    limits: Floats | None
    #: Unit normals of the limit surface there, float64 of shape (n, 3), NaN where there is none or more than one.
    normals: Floats | None


def subdivide(
    points: npt.ArrayLike,
    faces: Any,
    scheme: str = "loop",
    levels: int = 1,
    *,
    creases: Creases = (),
    corners: Corners = (),
    limits: bool = False,
) -> Subdivided:
    """Subdivide a mesh, or polylines.

    Parameters
    ----------
    points : array_like of float, shape (n, 3) or (n, 2)
        Coordinates.
    faces : array_like of int, shape (m, k), or a list of lists
        The points of each face, counted from 0; of schemes of curves, of each polyline, whose first point comes again where it is closed.
    scheme : str, optional
        ``loop``, ``butterfly``, ``modified-butterfly`` or ``midpoint`` on triangles; ``doo-sabin`` or ``catmull-clark`` on polygons;
        ``b-spline`` or ``four-point`` on polylines.
    levels : int, optional
        How often.
    creases : sequence of pairs, or mapping, optional
        Sharp edges; a mapping gives each a sharpness.
    corners : sequence of int, or mapping, optional
        Points that stay where they are; a mapping gives each a sharpness.
    limits : bool, optional
        Whether limits and normals are wanted: of ``loop``, ``catmull-clark`` and ``b-spline``.

    Returns
    -------
    Subdivided

    Raises
    ------
    ValueError
        No such scheme, or a mesh that it cannot work with.

    Examples
    --------
    >>> tetrahedron = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
    >>> subdivide(*tetrahedron, levels=2).faces.shape
    (64, 3)
    """
    array = _inputs.points("points", points)
    count = _inputs.count("levels", levels, 0, 99)
    if not isinstance(faces, np.ndarray) and not isinstance(faces, Sequence):
        raise TypeError(f"faces: give an array or a list of lists, not {faces!r}")
    lists = [_inputs.indices(f"faces[{number}]", face, len(array)).tolist() for number, face in enumerate(faces)]
    edges = []
    for pair, sharpness in _sharp("creases", creases):
        ends = _inputs.indices("creases", pair, len(array))
        if ends.shape != (2,):
            raise ValueError(f"creases: {pair!r} is no edge; give two points")
        edges.append(((int(ends[0]), int(ends[1])), sharpness))
    kept = []
    for corner, sharpness in _sharp("corners", corners):
        point = _inputs.indices("corners", corner, len(array))
        if point.shape != ():
            raise ValueError(f"corners: {corner!r} is no point; give its number")
        kept.append((int(point), sharpness))
    made = _grainsmooth.subdivide(array, lists, _inputs.text("scheme", scheme), count, edges, kept, limits)
    return Subdivided(made["points"], made["faces"], made.get("limits"), made.get("normals"))


def _sharp(name: str, given: Any) -> list[tuple[Any, float]]:
    """Edges or points, each with its sharpness."""
    if not isinstance(given, (Mapping, Sequence, np.ndarray)) or isinstance(given, str):
        raise TypeError(f"{name}: give a list, or a mapping to sharpnesses, not {given!r}")
    if not isinstance(given, Mapping):
        return [(one, np.inf) for one in given]
    for one, sharpness in given.items():
        if not isinstance(sharpness, (int, float, np.number)) or not sharpness >= 0.0:
            raise ValueError(f"{name}: a sharpness is 0 or a positive number, not {sharpness!r} as of {one!r}")
    return [(one, float(sharpness)) for one, sharpness in given.items()]
