"""The stages on the way to a polycrystal, one by one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from . import _grainsmooth, _inputs
from ._options import Options
from ._progress import Progress, told

if TYPE_CHECKING:
    from typing_extensions import Unpack

Floats = npt.NDArray[np.float64]


class Tessellation:
    """Voronoi or power cells, flat.

    Parameters
    ----------
    seeds : array_like of float, shape (n, 3), or (n, 2) in the plane
        Each within the box.
    box : float or tuple of float, optional
        Side lengths of the box, which begins in the origin.
    periodic : str, optional
        Axes along which it repeats, such as ``"xyz"``.
    weights : array_like of float, shape (n,), optional
        Power weights, in the unit of length squared: a sphere of radius r has r^2.
    threads : int, optional
        Number of threads; one a processor where it is not given.

    Raises
    ------
    ValueError
        A seed outside of the box, or two at one place.
    """

    _cells: _grainsmooth.Tessellation

    def __init__(
        self,
        seeds: npt.ArrayLike,
        *,
        box: float | tuple[float, ...] = 1.0,
        periodic: str = "",
        weights: npt.ArrayLike | None = None,
        threads: int | None = None,
    ) -> None:
        given = _inputs.array("seeds", seeds)
        array = _inputs.points("seeds", given)
        dimension = int(given.shape[1])
        if not isinstance(periodic, str) or not set(periodic) <= set("xyz"[:dimension]):
            raise ValueError(f"periodic: give some of the axes {'xyz'[:dimension]}, not {periodic!r}")
        of_seeds = None if weights is None else _inputs.numbers("weights", weights, 1)
        if of_seeds is not None and len(of_seeds) != len(array):
            raise ValueError(f"weights: give one for each of the {len(array)} seeds, not {len(of_seeds)}")
        self._cells = _grainsmooth.tessellation_of(
            array,
            _inputs.edges("box", box, dimension),
            dimension,
            ("x" in periodic, "y" in periodic, "z" in periodic),
            of_seeds,
            _inputs.thread_count(threads),
        )

    @property
    def seeds(self) -> Floats:
        """The seeds, float64 of shape (n, 3)."""
        return self._cells.seeds

    @property
    def weights(self) -> Floats:
        """The power weight of each seed, float64 of shape (n,); 0 for Voronoi cells."""
        return self._cells.weights

    @property
    def volumes(self) -> Floats:
        """Volume of each cell, float64 of shape (n,); in the plane its area."""
        return self._cells.volumes

    @property
    def centroids(self) -> Floats:
        """Centroid of each cell, float64 of shape (n, 3)."""
        return self._cells.centroids

    @property
    def vertices(self) -> Floats:
        """Vertices of the cells, each once, float64 of shape (v, 3)."""
        return self._cells.vertices

    @property
    def face_counts(self) -> npt.NDArray[np.int64]:
        """Number of faces of each cell, int64 of shape (n,)."""
        return np.array(self._cells.face_counts(), dtype=np.int64)

    @property
    def faces(self) -> list[tuple[list[int], tuple[int, int]]]:
        """The vertices of each face, in order round it, and the cells that it lies between; -1 stands for a wall."""
        return [(corners, (first, second)) for corners, (first, second) in self._cells.faces()]

    def network(self, levels: int = 3, *, threads: int | None = None) -> Network:
        """The flat network of the cells, to be relaxed and subdivided.

        Parameters
        ----------
        levels : int, optional
            How often it can be subdivided: connectivity of all levels is made at once.
        threads : int, optional
            As of :class:`Tessellation`.

        Returns
        -------
        Network
            At level 0.
        """
        count = _inputs.count("levels", levels, 0, 12)
        return Network._of(self._cells.network(count, _inputs.thread_count(threads)))


def tessellate(
    *, threads: int | None = None, progress: Progress = False, **options: Unpack[Options]
) -> Tessellation:
    """Make the flat cells that :meth:`Polycrystal.generate` would begin with.

    Parameters
    ----------
    threads, progress, **options
        As of :meth:`Polycrystal.generate`.

    Returns
    -------
    Tessellation
        With sizes, shapes and periods as the options ask.
    """
    tessellation = Tessellation.__new__(Tessellation)
    with told(progress) as tell:
        tessellation._cells = _grainsmooth.tessellate(dict(options), _inputs.thread_count(threads), tell)
    return tessellation


class Network:
    """Boundaries, triple lines and quadruple points at one level of subdivision.

    Made by :meth:`Tessellation.network`. Its methods give new networks, which share connectivity with it.
    """

    _network: _grainsmooth.Network

    def __init__(self) -> None:
        raise TypeError("make networks with Tessellation.network")

    @classmethod
    def _of(cls, network: _grainsmooth.Network) -> Network:
        made = cls.__new__(cls)
        made._network = network
        return made

    @property
    def level(self) -> int:
        """How often it was subdivided."""
        return self._network.level

    @property
    def points(self) -> Floats:
        """Points of this level, float64 of shape (n, 3)."""
        return self._network.points

    @property
    def elements(self) -> npt.NDArray[np.uint32]:
        """Triangles, uint32 of shape (m, 3); in the plane segments, of shape (m, 2)."""
        return self._network.elements

    @property
    def face_labels(self) -> npt.NDArray[np.int32]:
        """The two sides of each element, int32 of shape (m, 2), as of :attr:`Polycrystal.face_labels`."""
        return self._network.face_labels

    @property
    def volumes(self) -> Floats:
        """Volume of each grain at this level, float64 of shape (grains,); in the plane its area."""
        return self._network.volumes

    @property
    def target_volumes(self) -> Floats:
        """The volumes of the cells, which relaxation keeps on the finest level."""
        return self._network.target_volumes

    def relax(
        self, time: float | None = None, *, threads: int | None = None, progress: Progress = False
    ) -> Network:
        """Move control points toward equilibrium of the boundaries' tension, at fixed volumes.

        No boundary vanishes and no neighbours switch on the way: where one would, that is an error. :meth:`Polycrystal.generate` lets them.

        Parameters
        ----------
        time : float, optional
            In units of the mean grain size squared; to equilibrium where it is not given.
        threads, progress
            As of :meth:`Polycrystal.generate`.

        Returns
        -------
        Network
            At the level whose points were moved.
        """
        end = None if time is None else _inputs.number("time", time)
        if end is not None and end < 0.0:
            raise ValueError(f"time: give 0 or a positive number, not {time!r}")
        with told(progress) as tell:
            return Network._of(self._network.relax(end, _inputs.thread_count(threads), tell))

    def subdivide(self, times: int | None = None, *, threads: int | None = None) -> Network:
        """Make boundaries smooth by Loop's scheme, with triple lines as B-splines.

        Parameters
        ----------
        times : int, optional
            Number of subdivisions; up to the finest level where it is not given.
        threads : int, optional
            As of :meth:`Polycrystal.generate`.

        Returns
        -------
        Network
            At the level that was reached.
        """
        count = None if times is None else _inputs.count("times", times, 0, 99)
        return Network._of(self._network.subdivide(count, _inputs.thread_count(threads)))

    def __repr__(self) -> str:
        return f"<grainsmooth.Network: level {self.level} of {self._network.levels}, {len(self.points)} points>"

    def __reduce__(self) -> Any:
        raise TypeError("networks do not pickle; take their arrays, or make a Polycrystal")
