"""Reads with VTK and orix what the test has written of orientations, and compares angles, quaternions, colours and disorientations.

No other test uses orix: two programs that import it for the first time at once may crash (numba/numba#10128).
"""
import pathlib
import sys

import numpy as np
import orix.io
import pyvista
from orix.plot import IPFColorKeyTSL
from orix.quaternion import Orientation
from orix.quaternion.symmetry import D6h, Oh
from orix.vector import Vector3d

folder = pathlib.Path(sys.argv[1])
for name, symmetry in (("cubic", Oh), ("hexagonal", D6h)):
    blocks = pyvista.read(folder / f"{name}.vtm")
    voxels = pyvista.read(folder / f"{name}.vti")
    euler, quaternions = voxels.field_data["EulerAngles"], voxels.field_data["Quaternion"]
    assert euler.shape == (len(quaternions), 3) and quaternions.shape[1] == 4
    orientations = Orientation.from_euler(euler, symmetry=symmetry, degrees=True)
    # The vector part has the opposite sign in orix.
    ours, theirs = quaternions * [1, -1, -1, -1], orientations.data
    assert np.allclose(np.abs(np.einsum("ij,ij->i", ours, theirs)), 1, atol=1e-12), name
    assert (quaternions[:, 0] >= 0).all()
    for extension in ("vtp", "vtu", "vtk"):
        mesh = pyvista.read(folder / f"{name}.{extension}")
        assert np.array_equal(mesh.field_data["EulerAngles"], euler), extension
        assert np.array_equal(mesh.field_data["Quaternion"], quaternions), extension
        labels, angles = mesh["FaceLabels"], mesh["Disorientation"]
        inside = labels[:, 1] >= 0
        assert np.isnan(angles[~inside]).all() and mesh["DisorientationAxis"].shape == (len(labels), 3)
        pairs, index = np.unique(labels[inside], axis=0, return_inverse=True)
        exact = np.degrees([orientations[a].angle_with(orientations[b])[0] for a, b in pairs])
        assert np.allclose(angles[inside], exact[index.ravel()], atol=1e-6), (name, extension)
    grains = blocks["grains"]
    assert np.array_equal(grains["EulerAngles"], euler[grains["GrainId"]]), name
    assert np.array_equal(grains["Quaternion"], quaternions[grains["GrainId"]]), name
    assert {"Disorientation", "DisorientationAxis"} <= set(blocks["boundaries"].cell_data.keys())
    for axis, direction in (("X", [1, 0, 0]), ("Y", [0, 1, 0]), ("Z", [0, 0, 1])):
        colors = grains[f"IPFColor{axis}"]
        exact = IPFColorKeyTSL(symmetry, direction=Vector3d(direction)).orientation2color(orientations)
        # The azimuth of orix goes through a table; bytes round.
        assert colors.dtype == np.uint8 and np.abs(colors / 255 - exact[grains["GrainId"]]).max() < 0.012, (name, axis)
        of_grain = np.zeros((len(euler), 3), dtype=np.uint8)
        of_grain[grains["GrainId"]] = colors
        assert np.array_equal(voxels[f"IPFColor{axis}"], of_grain[voxels["material"]]), (name, axis)
    rodrigues = np.loadtxt(folder / f"{name}.ori")
    assert np.allclose(rodrigues, quaternions[:, 1:] / quaternions[:, :1], rtol=1e-12), name
    for extension, tolerance in (("ang", 2e-3), ("ctf", 1e-4)):
        scan = orix.io.load(folder / f"{name}.{extension}")
        assert scan.shape == (15, 20) and scan.phases[1].point_group.laue.name == symmetry.name, (name, extension)
        plane = pyvista.read(folder / f"{name}_plane.vti")
        labels = plane["material"].reshape(15, 20)[::-1].ravel()
        angles = plane.field_data["EulerAngles"][labels] + [0, 0, 30 if (extension, name) == ("ctf", "hexagonal") else 0]
        given = Orientation.from_euler(angles, symmetry=symmetry, degrees=True)
        read = Orientation(scan.rotations.data, symmetry=symmetry)
        assert np.degrees(given.angle_with(read)).max() < tolerance, (name, extension)

# Names as VirMat has them, and grains in files of their own.
virmat = pyvista.read(folder / "virmat.vtm")["grains"]
cubic = pyvista.read(folder / "cubic.vtm")["grains"]
for theirs, ours in (("IPF-RD", "IPFColorX"), ("IPF-TD", "IPFColorY"), ("IPF-ND", "IPFColorZ")):
    assert np.array_equal(virmat[theirs], cubic[ours]), theirs
for grain in np.unique(cubic["GrainId"]):
    one = pyvista.read(folder / "each" / f"grain_{grain}.vtp")
    for name in ("EulerAngles", "Quaternion", "IPFColorX", "IPFColorY", "IPFColorZ"):
        assert np.array_equal(one[name][0], cubic[name][cubic["GrainId"] == grain][0]), (grain, name)

# Without a texture, one orientation for each grain, and none for two. Scans go down, grids up.
labels = pyvista.read(folder / "plain.vti")["material"]
scan = orix.io.load(folder / "plain.ang")
assert scan.shape == (15, 20), scan.shape
turns = np.unique(scan.rotations.data.round(6), axis=0, return_inverse=True)[1].ravel()
pairs = np.unique(np.stack([labels.reshape(15, 20)[::-1].ravel(), turns]), axis=1)
assert pairs.shape[1] == len(np.unique(labels)) == turns.max() + 1, pairs
