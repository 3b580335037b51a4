"""Finished polycrystals."""

from __future__ import annotations

import inspect
import itertools
import json
import os
import pathlib
import tempfile
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import numpy.typing as npt

from . import _grainsmooth, _inputs
from ._options import MapOptions, Options
from ._progress import Progress, told
from .notebook import View

if TYPE_CHECKING:
    import meshio
    import pandas as pd
    import pyvista as pv
    from typing_extensions import Unpack

Floats = npt.NDArray[np.float64]

#: Of the state that is pickled: raised when it changes.
_FORMAT = 2

_ARRAYS = ("points", "elements", "face_labels", "boundary_id", "node_types")

#: Units of the columns of tables, L being the unit of ``box``.
_UNITS = {
    **dict.fromkeys(("volume",), "L^3"),
    **dict.fromkeys(("area",), "L^2"),
    **dict.fromkeys(("x", "y", "z", "length", "perimeter", "equivalent_diameter", "mean_width"), "L"),
    **dict.fromkeys(("centroid_x", "centroid_y", "centroid_z", "triple_line_length"), "L"),
    "integral_mean_curvature": "L",
    "mean_curvature": "1/L",
    **dict.fromkeys(("inertia_xx", "inertia_yy", "inertia_zz", "inertia_xy", "inertia_xz", "inertia_yz"), "L^5"),
    **dict.fromkeys(("moment_xx", "moment_yy", "moment_xy"), "L^4"),
    **dict.fromkeys(("smallest_angle", "largest_angle", "mean_angle", "mean_angles", "angles", "turning"), "degree"),
    **dict.fromkeys(("EulerAngles", "Disorientation"), "degree"),
}


class Tetrahedra(NamedTuple):
    """Tetrahedra that fill grains."""

    #: Points, float64 of shape (n, 3): those of the network first.
    points: Floats
    #: The corners of each, uint32 of shape (m, 4).
    tetrahedra: npt.NDArray[np.uint32]
    #: The grain of each, int32 of shape (m,).
    grains: npt.NDArray[np.int32]


class Polycrystal:
    """Grains that fill a domain, and the smooth boundaries between them.

    Made by :meth:`generate` and :meth:`from_settings`, of what was measured by :meth:`from_labels`, :meth:`from_map` and :meth:`from_orientations`,
    of a network that is there by :meth:`from_arrays` and :func:`grainsmooth.read`.

    Arrays are read-only views on the library's memory: none is copied, and each keeps that memory alive. Lengths are in the unit
    of the option ``box``.
    """

    __slots__ = ("_arrays", "_made", "_settings", "_statistics")

    _arrays: dict[str, npt.NDArray[Any]]
    _made: _grainsmooth.Polycrystal | None
    _settings: str | None
    _statistics: dict[str, Any] | None

    def __init__(self) -> None:
        raise TypeError("make polycrystals with Polycrystal.generate, Polycrystal.from_labels or grainsmooth.read")

    @classmethod
    def _of(
        cls, made: _grainsmooth.Polycrystal | None, arrays: Mapping[str, npt.NDArray[Any]], settings: str | None
    ) -> Polycrystal:
        polycrystal = cls.__new__(cls)
        polycrystal._made = made
        polycrystal._arrays = dict(arrays)
        polycrystal._settings = settings
        polycrystal._statistics = None
        return polycrystal

    @classmethod
    def generate(
        cls, *, threads: int | None = None, progress: Progress = False, **options: Unpack[Options]
    ) -> Polycrystal:
        """Make a polycrystal.

        Parameters
        ----------
        threads : int, optional
            Number of threads; one a processor where it is not given. No result depends on it.
        progress : bool or callable, optional
            Whether a bar of tqdm is shown; or a function that is called with the name of a stage, the steps done and their number.
        **options
            The program's options, see :class:`grainsmooth.Options`: names, defaults and messages are the same.

        Returns
        -------
        Polycrystal
            As the program writes it, with each of its promises checked.

        Raises
        ------
        ValueError
            A mistaken option, options that do not go together, or grains that no valid network can be made of.
        OSError
            A file that an option names cannot be read.
        MemoryError
            What is asked for does not fit.

        Examples
        --------
        >>> grains = Polycrystal.generate(seeds=20, levels=1, rng_seed=3)
        >>> grains.grain_count
        20
        """
        with told(progress) as tell:
            made = _grainsmooth.generate(dict(options), _inputs.thread_count(threads), tell)
        return cls._of(made, {}, made.settings)

    @classmethod
    def from_settings(
        cls, settings: str, *, threads: int | None = None, progress: Progress = False
    ) -> Polycrystal:
        """Make a polycrystal once more.

        Parameters
        ----------
        settings : str
            The options as TOML: :attr:`settings` of another one, or the text of a file for the program's ``--config``.
        threads, progress
            As of :meth:`generate`.

        Returns
        -------
        Polycrystal
            With the same bits, if this version is the same.
        """
        with told(progress) as tell:
            made = _grainsmooth.of_settings(settings, _inputs.thread_count(threads), tell)
        return cls._of(made, {}, made.settings)

    @classmethod
    def from_labels(
        cls,
        labels: npt.ArrayLike,
        *,
        spacing: float | tuple[float, ...] = 1.0,
        origin: tuple[float, ...] | None = None,
        exterior_label: int | None = None,
        min_voxels: int = 1,
        parts: str = "keep",
        periodic: str = "",
        decimate: float | None = None,
        threads: int | None = None,
        progress: Progress = False,
    ) -> Polycrystal:
        """Make the smooth network of labelled voxels, as a measured map has them.

        Every grain keeps the volume of its voxels, and no point is farther than half a voxel from where it was.

        Parameters
        ----------
        labels : array_like of int, shape (nx, ny, nz) or (nx, ny)
            The grain of each voxel, indexed as ``labels[x, y, z]``; below 0 there is none.
        spacing : float or tuple of float, optional
            Edge of a voxel, or one along each axis.
        origin : tuple of float, optional
            Lower corner of the first voxel; 0 where it is not given.
        exterior_label : int, optional
            Label of what is no grain.
        min_voxels : int, optional
            Grains with fewer voxels go to their neighbours.
        parts : {"keep", "split"}, optional
            What becomes of a label whose voxels hang together in several parts: one grain, or a grain for each.
        periodic : str, optional
            Axes along which the labels repeat, such as ``"xyz"`` or ``"x,y"``: grains are whole there.
        decimate : float, optional
            Edges shorter than so many voxels collapse; 1.75 where it is not given, in the plane 0. With 0 every voxel stays in its grain.
        threads, progress
            As of :meth:`generate`.

        Returns
        -------
        Polycrystal
            Its grains count from 0 in the order of their labels, which :attr:`seed_id` has.
        """
        array = _inputs.whole_numbers("labels", labels)
        if array.ndim not in (2, 3) or array.size == 0:
            raise ValueError(f"labels: give an array of shape (nx, ny, nz) or (nx, ny), not {array.shape}")
        if decimate is not None and not 0 <= decimate < np.inf:
            raise ValueError(f"decimate: give a finite number of voxels, 0 or more, not {decimate}")
        if not isinstance(parts, str) or parts not in ("keep", "split"):
            raise ValueError(f"parts: give 'keep' or 'split', not {parts!r}")
        axes = _inputs.text("periodic", periodic).replace(",", "")
        if not set(axes) <= set("xyz"[: array.ndim]):
            raise ValueError(f"periodic: give axes among {', '.join('xyz'[: array.ndim])}, not {periodic!r}")
        nx, ny, nz = (*array.shape, 1)[:3]
        place = (0.0,) * array.ndim if origin is None else origin
        corner = _inputs.numbers("origin", place, 1)
        if corner.shape != (array.ndim,):
            raise ValueError(f"origin: give {array.ndim} coordinates, not {origin!r}")
        x, y, z = (*(float(at) for at in corner), 0.0)[:3]
        with told(progress) as tell:
            made = _grainsmooth.of_labels(
                array.ravel(order="F"),
                (nx, ny, nz),
                _inputs.edges("spacing", spacing, array.ndim),
                (x, y, z),
                None if exterior_label is None else _inputs.count("exterior_label", exterior_label, -(2**31), 2**31 - 1),
                _inputs.count("min_voxels", min_voxels, 1, 2**63),
                decimate,
                parts == "split",
                ("x" in axes, "y" in axes, "z" in axes),
                _inputs.thread_count(threads),
                tell,
            )
        return cls._of(made, {}, None)

    @classmethod
    def from_map(
        cls,
        path: str | os.PathLike[str],
        *,
        threads: int | None = None,
        progress: Progress = False,
        **options: Unpack[MapOptions],
    ) -> Polycrystal:
        """Make the smooth network of a measured map from a file, as the program's command ``smooth`` does.

        Parameters
        ----------
        path : str or path
            Labels (.vti, .npy, .nrrd, .mhd, .tesr, .raw) or orientations as EBSD measures them (.ang, .ctf).
        threads, progress
            As of :meth:`generate`.
        **options
            How the map is read and cleaned, see :class:`grainsmooth.MapOptions`.

        Returns
        -------
        Polycrystal
            Its grains count from 0 in the order of their labels, which :attr:`seed_id` has.
        """
        with told(progress) as tell:
            made = _grainsmooth.of_map(os.fspath(path), dict(options), _inputs.thread_count(threads), tell)
        return cls._of(made, {}, None)

    @classmethod
    def from_orientations(
        cls,
        euler_angles: npt.ArrayLike,
        *,
        spacing: float | tuple[float, float] = 1.0,
        phases: Mapping[str, str] | None = None,
        phase: npt.ArrayLike | None = None,
        threshold: float = 5.0,
        min_voxels: int = 1,
        min_pore: int | None = None,
        threads: int | None = None,
        progress: Progress = False,
    ) -> Polycrystal:
        """Find the grains of a map of orientations, as EBSD measures it, and make their smooth network.

        Parameters
        ----------
        euler_angles : array_like of float, shape (nx, ny, 3)
            Bunge's angles of each point in degrees, indexed as ``euler_angles[x, y]``; NaN where the pattern has no solution.
        spacing : float or tuple of float, optional
            Distance of neighbouring points, or that along x and that along y.
        phases : mapping of str to str, optional
            The crystal symmetry of each phase by its name, such as ``{"iron": "cubic"}``; where it is not given there is one, which is cubic.
        phase : array_like of int, shape (nx, ny), optional
            The phase of each point, by its place among ``phases`` from 0; below 0 the point has none.
        threshold : float, optional
            Degrees: neighbouring points of one phase that differ by more are in different grains.
        min_voxels : int, optional
            Grains of fewer points go to their neighbours.
        min_pore : int, optional
            So many points side by side without a solution are a pore; fewer, and all where it is not given, are filled from their neighbours.
        threads, progress
            As of :meth:`generate`.

        Returns
        -------
        Polycrystal
            In the plane; each grain has the mean orientation of its points, see :attr:`euler_angles`.
        """
        angles = _inputs.array("euler_angles", euler_angles)
        if angles.ndim != 3 or angles.shape[2] != 3 or angles.size == 0:
            raise ValueError(f"euler_angles: give an array of shape (nx, ny, 3), not {angles.shape}")
        is_solved = np.ones(angles.shape[:2], dtype=bool)
        if angles.dtype.kind == "f":
            is_solved = ~np.isnan(angles).any(axis=2)
            angles = np.where(is_solved[..., np.newaxis], angles, 0.0)
        rows = _inputs.numbers("euler_angles", angles.swapaxes(0, 1), 3).reshape(-1, 3)
        nx, ny, _ = angles.shape
        if phases is not None and not isinstance(phases, Mapping):
            raise TypeError(f"phases: give a mapping of names to symmetries, not {phases!r}")
        known = {"grains": "cubic"} if phases is None else {name: _inputs.text("phases", of) for name, of in phases.items()}
        of_points = np.zeros((nx, ny), np.int32) if phase is None else _inputs.whole_numbers("phase", phase)
        if of_points.shape != (nx, ny) or (of_points >= len(known)).any():
            raise ValueError(f"phase: give a number below {len(known)} for each of {nx} x {ny} points")
        of_points = np.where(is_solved, of_points, np.int32(-1))
        width, height, _ = _inputs.edges("spacing", spacing, 2)
        options = {"threshold": threshold, "min_voxels": min_voxels, "min_pore": min_pore, "spacing": [width, height]}
        with told(progress) as tell:
            made = _grainsmooth.of_orientations(
                rows,
                of_points.ravel(order="F"),
                (nx, ny),
                list(known.items()),
                options,
                _inputs.thread_count(threads),
                tell,
            )
        return cls._of(made, {}, None)

    @classmethod
    def from_arrays(
        cls, points: npt.ArrayLike, elements: npt.ArrayLike, face_labels: npt.ArrayLike, *, threads: int | None = None
    ) -> Polycrystal:
        """Take a network that is there, such as another program's.

        Parameters
        ----------
        points : array_like of float, shape (n, 3), or (n, 2) in the plane
            Each point once: boundaries that meet share points.
        elements : array_like of int, shape (m, 3), in the plane (m, 2)
            The points of triangles, in the plane of segments.
        face_labels : array_like of int, shape (m, 2)
            The grains on both sides of each, below 0 outside. Normals point from the first side to the second, or all of them the other way.
        threads : int, optional
            As of :meth:`generate`.

        Returns
        -------
        Polycrystal
            Its grains count from 0 in the order of their labels, which :attr:`seed_id` has.

        Raises
        ------
        ValueError
            Grains that are not closed, or cross.
        """
        places = _inputs.points("points", points)
        given = _inputs.array("elements", elements)
        if given.ndim != 2 or given.shape[1] not in (2, 3):
            raise ValueError(f"elements: give an array of shape (m, 3), or (m, 2) in the plane, not {given.shape}")
        labels = _inputs.whole_numbers("face_labels", face_labels)
        if labels.shape != (len(given), 2) or len(labels) == 0:
            raise ValueError(f"face_labels: give an array of shape ({len(given)}, 2), not {labels.shape}")
        grains, numbers = np.unique(np.maximum(labels, -1), return_inverse=True)
        first = int(np.searchsorted(grains, 0))
        made = _grainsmooth.of_arrays(
            places,
            _inputs.indices("elements", given, len(places)),
            np.ascontiguousarray(numbers.reshape(labels.shape) - first, dtype=np.int32),
            np.ascontiguousarray(grains[first:], dtype=np.uint32),
            _inputs.thread_count(threads),
        )
        return cls._of(made, {}, None)

    def _whole(self) -> _grainsmooth.Polycrystal:
        """All that is known of it. Where it came as arrays, these are measured, or it is made once more by its settings and compared."""
        if self._made is None:
            if self._settings is None:
                known = self._arrays
                self._made = _grainsmooth.of_arrays(
                    known["points"], known["elements"], known["face_labels"], known["seed_id"], 0
                )
                return self._made
            made = _grainsmooth.of_settings(self._settings, 0, None)
            if not np.array_equal(made.points, self._arrays["points"]):
                raise ValueError(
                    "its settings make other points here: it comes from another version of grainsmooth; take its arrays by Polycrystal.from_arrays"
                )
            self._made = made
        return self._made

    def _array(self, name: str) -> npt.NDArray[Any]:
        known = self._arrays.get(name)
        array: npt.NDArray[Any] = getattr(self._whole(), name) if known is None else known
        return array

    @property
    def points(self) -> Floats:
        """Points of the finest level, float64 of shape (n, 3); in the plane z is 0."""
        return self._array("points")

    @property
    def triangles(self) -> npt.NDArray[np.uint32]:
        """Corners of the triangles, uint32 of shape (m, 3). Normals point from the first of ``face_labels`` to the second."""
        if self.dimension == 2:
            raise ValueError("grains in the plane have no triangles; their boundaries are segments")
        return self._array("elements")

    @property
    def segments(self) -> npt.NDArray[np.uint32]:
        """Ends of the segments of boundaries in the plane, uint32 of shape (m, 2)."""
        if self.dimension == 3:
            raise ValueError("boundaries in space have no segments, but triangles")
        return self._array("elements")

    @property
    def face_labels(self) -> npt.NDArray[np.int32]:
        """The two sides of each triangle (segment), int32 of shape (m, 2): grains from 0, the exterior -1.

        In a periodic box a boundary with a copy has -2 - b second, b being its copy's ``boundary_id``.
        """
        return self._array("face_labels")

    @property
    def boundary_id(self) -> npt.NDArray[np.int32]:
        """The boundary of each triangle (segment), int32 of shape (m,), from 0."""
        return self._array("boundary_id")

    @property
    def node_types(self) -> npt.NDArray[np.int8]:
        """What each point is part of, int8 of shape (n,): 2 boundary, 3 triple line, 4 quadruple point; 10 more on the outer surface."""
        return self._array("node_types")

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return int(self._array("elements").shape[1])

    @property
    def grain_count(self) -> int:
        """Number of grains."""
        if self._made is None:
            return int(self.face_labels.max()) + 1
        return self._made.grain_count

    @property
    def volumes(self) -> Floats:
        """Volume of each grain, float64 of shape (grains,), in L^3; in the plane its area in L^2."""
        return self._whole().volumes

    @property
    def euler_angles(self) -> Floats:
        """Bunge's angles phi1, Phi, phi2 of each grain in degrees, float64 of shape (grains, 3); a ValueError without a texture."""
        return self._whole().euler_angles

    @property
    def seed_id(self) -> npt.NDArray[np.uint32]:
        """The number of each grain's seed, or its label in the map, uint32 of shape (grains,)."""
        return self._array("seed_id")

    @property
    def phases(self) -> list[str]:
        """The name of each grain's phase; a ValueError where there are no phases."""
        of_grains, names = self._whole().phases
        return [names[phase] for phase in of_grains]

    @property
    def settings(self) -> str | None:
        """The options that make it again, as TOML; None where none were given."""
        return self._settings

    def statistics(self) -> dict[str, Any]:
        """All that is measured: what the program writes with ``--stats`` as JSON."""
        if self._statistics is None:
            self._statistics = json.loads(self._whole().statistics())
        return self._statistics

    def summary(self) -> dict[str, Any]:
        """The figures of the program's summary, as it writes them with ``--json-summary``."""
        summary: dict[str, Any] = json.loads(self._whole().summary())
        return summary

    def _table(self, name: str) -> pd.DataFrame:
        pandas = _inputs.require("pandas", "pandas")
        rows = self.statistics().get(name)
        if rows is None:
            raise ValueError(f"grains in {'the plane' if self.dimension == 2 else 'space'} have no {name.replace('_', ' ')}")
        table: pd.DataFrame = pandas.DataFrame(rows)
        units = {**_UNITS, "area": "L^2"}
        table.attrs["units"] = {column: units[column] for column in table.columns if column in units}
        return table

    @property
    def grains(self) -> pd.DataFrame:
        """A row for each grain. ``attrs["units"]`` has the units of columns."""
        return self._table("grains")

    @property
    def boundaries(self) -> pd.DataFrame:
        """A row for each boundary."""
        return self._table("boundaries")

    @property
    def triple_lines(self) -> pd.DataFrame:
        """A row for each triple line; in space only."""
        return self._table("triple_lines")

    @property
    def quadruple_points(self) -> pd.DataFrame:
        """A row for each quadruple point; in space only."""
        return self._table("quadruple_points")

    @property
    def triple_points(self) -> pd.DataFrame:
        """A row for each triple point; in the plane only."""
        return self._table("triple_points")

    def voxelize(self, shape: int | tuple[int, ...], *, threads: int | None = None) -> npt.NDArray[np.int32]:
        """The grain at the centre of each voxel of a regular grid over the box.

        Parameters
        ----------
        shape : int or tuple of int
            Number of voxels along each axis.
        threads : int, optional
            As of :meth:`generate`.

        Returns
        -------
        numpy.ndarray of int32, shape (nx, ny, nz), in the plane (nx, ny)
            Grains from 0, -1 outside; in Fortran order, as DAMASK takes it.
        """
        counts = np.atleast_1d(_inputs.whole_numbers("shape", shape))
        dimension = self.dimension
        if counts.shape == (1,):
            counts = np.repeat(counts, dimension)
        if counts.shape != (dimension,) or (counts < 1).any() or (counts > 65_536).any():
            raise ValueError(f"shape: give {dimension} whole numbers from 1 to 65536, not {shape!r}")
        nx, ny, nz = (*(int(count) for count in counts), 1)[:3]
        labels = self._whole().voxelize((nx, ny, nz), _inputs.thread_count(threads))
        return labels[:, :, 0] if dimension == 2 else labels

    def save(
        self,
        *paths: str | os.PathLike[str],
        threads: int | None = None,
        progress: Progress = False,
        **options: Unpack[Options],
    ) -> None:
        """Write files, each in the format of its extension. All appear together, complete, or none.

        Parameters
        ----------
        *paths : str or path
            Such as ``"grains.vtp"``; the formats are those of the program.
        threads, progress
            As of :meth:`generate`.
        **options
            How files are written: ``voxels``, ``names``, ``arrays``, ``ascii``, ``vtk_encoding``; the others were those of the run.
        """
        with told(progress) as tell:
            self._whole().save([os.fspath(path) for path in paths], dict(options), _inputs.thread_count(threads), tell)

    def report(self, path: str | os.PathLike[str]) -> None:
        """Write a page (.html) with a view of the grains to rotate, histograms and the figures of the run."""
        self._whole().report(os.fspath(path))

    def view(self) -> View:
        """Grains to turn, hide and cut in a notebook, where a cell ends with this; about 2 MB are kept in the notebook."""
        with tempfile.TemporaryDirectory() as folder:
            page = pathlib.Path(folder) / "view.html"
            self.report(page)
            return View(page.read_text(encoding="utf-8"))

    def tetrahedra(self, *, threads: int | None = None) -> Tetrahedra:
        """Fill the grains with tetrahedra between the triangles of their boundaries, which stay as they are. Needs Gmsh.

        Parameters
        ----------
        threads : int, optional
            As of :meth:`generate`.

        Returns
        -------
        Tetrahedra
            Its first points are those of the network, by the same numbers.
        """
        if self.dimension == 2:
            raise ValueError("grains in the plane hold no tetrahedra")
        return Tetrahedra(*self._whole().tetrahedra(_inputs.thread_count(threads)))

    def picture(
        self,
        path: str | os.PathLike[str] | None = None,
        *,
        size: tuple[int, int] = (1200, 900),
        color_by: str = "grain",
        explode: float = 0.0,
    ) -> bytes:
        """Draw the grains; no display is needed.

        Parameters
        ----------
        path : str or path, optional
            File to write as well.
        size : tuple of int, optional
            Width and height in pixels.
        color_by : str, optional
            As of the program's ``--color-by``: grain, diameter, neighbors, phase, ipf-x, ipf-y, ipf-z or disorientation.
        explode : float, optional
            How far each grain is moved from the middle, as a share of its distance from there.

        Returns
        -------
        bytes
            The picture as PNG.
        """
        pixels = _inputs.whole_numbers("size", size)
        if pixels.shape != (2,) or (pixels < 16).any() or (pixels > 16_384).any():
            raise ValueError(f"size: give two numbers of pixels from 16 to 16384, not {size!r}")
        png = self._whole().png(pixels.tolist(), _inputs.text("color_by", color_by), _inputs.number("explode", explode))
        if path is not None:
            with open(path, "wb") as file:
                file.write(png)
        return png

    def to_pyvista(self) -> pv.PolyData:
        """The network as a mesh of pyvista, with the arrays of the program's VTK files.

        Points and arrays are copies, for pyvista changes meshes in place.
        """
        pyvista = _inputs.require("pyvista", "pyvista")
        points, elements = np.array(self.points), np.array(self._array("elements"), dtype=np.int64)
        if self.dimension == 3:
            mesh = pyvista.PolyData.from_regular_faces(points, elements)
        else:
            lines = np.column_stack([np.full(len(elements), 2), elements])
            mesh = pyvista.PolyData(points, lines=lines.ravel())
        mesh.cell_data["FaceLabels"] = np.array(self.face_labels)
        mesh.cell_data["BoundaryId"] = np.array(self.boundary_id)
        mesh.point_data["NodeTypes"] = np.array(self.node_types)
        result: pv.PolyData = mesh
        return result

    def to_meshio(self) -> meshio.Mesh:
        """The network as a mesh of meshio, with the arrays of the program's VTK files."""
        package = _inputs.require("meshio", "meshio")
        kind = "triangle" if self.dimension == 3 else "line"
        mesh: meshio.Mesh = package.Mesh(
            np.array(self.points),
            [(kind, np.array(self._array("elements")))],
            point_data={"NodeTypes": np.array(self.node_types)},
            cell_data={"FaceLabels": [np.array(self.face_labels)], "BoundaryId": [np.array(self.boundary_id)]},
        )
        return mesh

    def plot(self, *, explode: float = 0.0, **options: Any) -> Any:
        """Show the grains in a window to rotate, in a notebook below the cell.

        Parameters
        ----------
        explode : float, optional
            How far each grain is moved from the middle, as a share of its distance from there.
        **options
            Of ``pyvista.Plotter.show``, such as ``screenshot="grains.png"``; ``off_screen=True`` needs no display.

        Returns
        -------
        Any
            What ``pyvista.Plotter.show`` gives.
        """
        pyvista = _inputs.require("pyvista", "pyvista")
        plotter = pyvista.Plotter(off_screen=options.pop("off_screen", None))
        mesh = self.to_pyvista()
        if self.dimension == 2:
            plotter.add_mesh(mesh, color="black", line_width=2, lighting=False)
            plotter.view_xy()
            return plotter.show(**options)
        labels = mesh.cell_data["FaceLabels"]
        if explode > 0.0:
            parts = [_surface(mesh, labels, grain, explode) for grain in range(self.grain_count)]
            mesh = pyvista.merge(parts)
        else:
            mesh = mesh.extract_cells(np.flatnonzero(labels[:, 1] < 0).tolist())
            mesh.cell_data["Grain"] = mesh.cell_data["FaceLabels"][:, 0]
        colors = _colors(self.grain_count, self.face_labels)[np.asarray(mesh.cell_data["Grain"])]
        mesh.cell_data["Color"] = colors
        plotter.add_mesh(mesh, scalars="Color", rgb=True, ambient=0.3)
        return plotter.show(**options)

    def _repr_png_(self) -> bytes:
        return self.picture(size=(800, 600))

    def __repr__(self) -> str:
        where = "in the plane" if self.dimension == 2 else "in space"
        return f"<grainsmooth.Polycrystal: {self.grain_count} grains {where}, {len(self.points)} points>"

    def __str__(self) -> str:
        return str(self._whole())

    def __reduce__(self) -> tuple[Any, ...]:
        names = _ARRAYS if self._settings is not None else (*_ARRAYS, "seed_id")
        arrays = {name: np.array(self._array(name)) for name in names}
        return (_unpickled, (_FORMAT, arrays, self._settings))


def _unpickled(version: int, arrays: dict[str, npt.NDArray[Any]], settings: str | None) -> Polycrystal:
    if version != _FORMAT:
        raise ValueError(f"this pickle has format {version}, and this version of grainsmooth reads {_FORMAT}")
    for array in arrays.values():
        array.flags.writeable = False
    return Polycrystal._of(None, arrays, settings)


def _surface(mesh: pv.PolyData, labels: npt.NDArray[np.int32], grain: int, explode: float) -> Any:
    """The closed surface of a grain, moved from the middle."""
    part: Any = mesh.extract_cells(np.flatnonzero((labels == grain).any(axis=1)).tolist())
    part.cell_data["Grain"] = np.full(part.n_cells, grain)
    part.points = part.points + explode * (np.mean(part.points, axis=0) - np.asarray(mesh.center))
    return part


#: Okabe and Ito's colours without black, which readers who are colour-blind can tell apart.
_PALETTE = np.array(
    [[230, 159, 0], [86, 180, 233], [0, 158, 115], [240, 228, 66], [0, 114, 178], [213, 94, 0], [204, 121, 167], [153, 153, 153]]
)


def _colors(count: int, labels: npt.NDArray[np.int32]) -> npt.NDArray[np.uint8]:
    """A colour for each grain, which no neighbour has."""
    beside: list[list[int]] = [[] for _ in range(count)]
    for first, second in np.unique(labels[(labels >= 0).all(axis=1)], axis=0).tolist():
        beside[first].append(second)
        beside[second].append(first)
    numbers = [-1] * count
    for grain in sorted(range(count), key=lambda grain: -len(beside[grain])):
        taken = {numbers[other] for other in beside[grain]}
        numbers[grain] = next(number for number in itertools.count() if number not in taken)
    rounds, places = np.divmod(numbers, len(_PALETTE))
    # Lighter each time that the palette begins again.
    return np.asarray(255 - (255 - _PALETTE[places]) * 0.6 ** rounds[:, np.newaxis], dtype=np.uint8)


def _show_options() -> None:
    """Lets ``generate`` show its options to notebooks, which complete keywords by the signature."""
    generate = Polycrystal.generate.__func__  # type: ignore[attr-defined]
    own = [one for one in inspect.signature(generate).parameters.values() if one.kind is not one.VAR_KEYWORD]
    given = [inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None) for name in Options.__annotations__]
    generate.__signature__ = inspect.Signature([*own, *given])


_show_options()
