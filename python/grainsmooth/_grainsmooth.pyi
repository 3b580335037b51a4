import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any, final

import numpy as np
import numpy.typing as npt

__all__ = [
    "InternalError",
    "Network",
    "Polycrystal",
    "Tessellation",
    "__version__",
    "check",
    "generate",
    "measure",
    "of_arrays",
    "of_labels",
    "of_map",
    "of_orientations",
    "of_settings",
    "read",
    "subdivide",
    "tessellate",
    "tessellation_of",
]

__version__: str

class InternalError(RuntimeError): ...

@final
class Polycrystal:
    @property
    def dimension(self) -> int: ...
    @property
    def grain_count(self) -> int: ...
    @property
    def boundary_count(self) -> int: ...
    @property
    def bounds(self) -> tuple[list[float], list[float]]: ...
    @property
    def points(self) -> npt.NDArray[np.float64]: ...
    @property
    def elements(self) -> npt.NDArray[np.uint32]: ...
    @property
    def face_labels(self) -> npt.NDArray[np.int32]: ...
    @property
    def boundary_id(self) -> npt.NDArray[np.int32]: ...
    @property
    def node_types(self) -> npt.NDArray[np.int8]: ...
    @property
    def volumes(self) -> npt.NDArray[np.float64]: ...
    @property
    def settings(self) -> str | None: ...
    @property
    def euler_angles(self) -> npt.NDArray[np.float64]: ...
    @property
    def seed_id(self) -> npt.NDArray[np.uint32]: ...
    @property
    def phases(self) -> tuple[list[int], list[str]]: ...
    def statistics(self) -> str: ...
    def summary(self) -> str: ...
    def voxelize(self, shape: Sequence[int], threads: int) -> npt.NDArray[np.int32]: ...
    def png(self, size: Sequence[int], color_by: str, explode: float) -> bytes: ...
    def save(
        self,
        paths: Sequence[str | os.PathLike[str]],
        options: Mapping[str, Any],
        threads: int,
        progress: Callable[[str, int, int], object] | None,
    ) -> None: ...
    def tetrahedra(
        self, threads: int
    ) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.uint32], npt.NDArray[np.int32]]: ...
    def report(self, path: str | os.PathLike[str]) -> None: ...

@final
class Tessellation:
    @property
    def seeds(self) -> npt.NDArray[np.float64]: ...
    @property
    def vertices(self) -> npt.NDArray[np.float64]: ...
    @property
    def weights(self) -> npt.NDArray[np.float64]: ...
    @property
    def volumes(self) -> npt.NDArray[np.float64]: ...
    @property
    def centroids(self) -> npt.NDArray[np.float64]: ...
    def faces(self) -> list[tuple[list[int], list[int]]]: ...
    def face_counts(self) -> list[int]: ...
    def network(self, levels: int, threads: int) -> Network: ...

@final
class Network:
    @property
    def level(self) -> int: ...
    @property
    def levels(self) -> int: ...
    @property
    def points(self) -> npt.NDArray[np.float64]: ...
    @property
    def elements(self) -> npt.NDArray[np.uint32]: ...
    @property
    def face_labels(self) -> npt.NDArray[np.int32]: ...
    @property
    def volumes(self) -> npt.NDArray[np.float64]: ...
    @property
    def target_volumes(self) -> npt.NDArray[np.float64]: ...
    def relax(
        self, time: float | None, threads: int, progress: Callable[[str, int, int], object] | None
    ) -> Network: ...
    def subdivide(self, times: int | None, threads: int) -> Network: ...

def generate(
    options: Mapping[str, Any], threads: int, progress: Callable[[str, int, int], object] | None
) -> Polycrystal: ...
def of_settings(
    settings: str, threads: int, progress: Callable[[str, int, int], object] | None
) -> Polycrystal: ...
def of_arrays(
    points: npt.NDArray[np.float64],
    elements: npt.NDArray[np.uint32],
    face_labels: npt.NDArray[np.int32],
    ids: npt.NDArray[np.uint32],
    threads: int,
) -> Polycrystal: ...
def of_labels(
    labels: npt.NDArray[np.int32],
    shape: Sequence[int],
    spacing: Sequence[float],
    origin: Sequence[float],
    exterior_label: int | None,
    min_voxels: int,
    decimate: float | None,
    split_parts: bool,
    periodic: tuple[bool, bool, bool],
    threads: int,
    progress: Callable[[str, int, int], object] | None,
) -> Polycrystal: ...
def of_map(
    path: str | os.PathLike[str],
    options: Mapping[str, Any],
    threads: int,
    progress: Callable[[str, int, int], object] | None,
) -> Polycrystal: ...
def of_orientations(
    angles: npt.NDArray[np.float64],
    phase_of: npt.NDArray[np.int32],
    shape: Sequence[int],
    phases: Sequence[tuple[str, str]],
    options: Mapping[str, Any],
    threads: int,
    progress: Callable[[str, int, int], object] | None,
) -> Polycrystal: ...
def tessellate(
    options: Mapping[str, Any], threads: int, progress: Callable[[str, int, int], object] | None
) -> Tessellation: ...
def tessellation_of(
    seeds: npt.NDArray[np.float64],
    box_size: Sequence[float],
    dim: int,
    periodic: Sequence[bool],
    weights: npt.NDArray[np.float64] | None,
    threads: int,
) -> Tessellation: ...
def subdivide(
    points: npt.NDArray[np.float64],
    faces: Sequence[Sequence[int]],
    scheme: str,
    levels: int,
    creases: Sequence[tuple[Sequence[int], float]],
    corners: Sequence[tuple[int, float]],
    with_limits: bool,
) -> dict[str, Any]: ...
def read(path: str | os.PathLike[str]) -> dict[str, Any]: ...
def check(path: str | os.PathLike[str]) -> str: ...
def measure(path: str | os.PathLike[str], dim: int | None) -> str: ...
