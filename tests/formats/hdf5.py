"""Writes maps in HDF5 as other programs lay them out: of the labels in a file of NumPy, and of a small map of orientations with the same points in .ang and .ctf."""

import os
import sys

import h5py
import numpy as np

labels = np.load(sys.argv[1])  # labels[x, y, z]
shape = np.array(labels.shape, dtype=np.int64)
zyx = np.ascontiguousarray(labels.transpose(2, 1, 0)).astype(np.int32)[..., np.newaxis]
spacing = np.array([0.5, 0.5, 0.8], dtype=np.float32)
origin = np.array([1, 2, -3], dtype=np.float32)

# DREAM.3D 6: an old layout, nothing compressed.
with h5py.File("labels_6.dream3d", "w", libver="earliest") as file:
    file.attrs["FileVersion"] = "7.0"
    container = file.create_group("DataContainers/SyntheticVolumeDataContainer")
    geometry = container.create_group("_SIMPL_GEOMETRY")
    geometry.attrs["GeometryTypeName"] = "ImageGeometry"
    geometry["DIMENSIONS"], geometry["SPACING"], geometry["ORIGIN"] = shape, spacing, origin
    container["CellData/FeatureIds"] = zyx
    container["CellData/EulerAngles"] = np.zeros(zyx.shape[:3] + (3,), dtype=np.float32)
    container["CellData/Phases"] = np.ones_like(zyx)

# DREAM3D-NX: in chunks and compressed, the grid in attributes.
with h5py.File("labels_nx.dream3d", "w", libver="latest") as file:
    file.attrs["FileVersion"] = "8.0"
    geometry = file.create_group("DataStructure/Nested/Image Geometry")
    geometry.attrs["ObjectType"] = "ImageGeom"
    geometry.attrs["_DIMENSIONS"] = shape.astype(np.uint64)
    geometry.attrs["_SPACING"], geometry.attrs["_ORIGIN"] = spacing, origin
    data = geometry.create_group("Cell Data")
    data.create_dataset("FeatureIds", data=zyx, chunks=(5, 7, 9, 1), compression="gzip", shuffle=True)

# Surface meshes as Quick Surface Mesh leaves them: three cubes in a row, grains 1 and 2 and one of no feature; outside -1, normals toward the first label.
points = np.array([[x, y, z] for x in range(4) for y in range(2) for z in range(2)], dtype=np.float32)
corner = lambda x, y, z: 4 * x + 2 * y + z
quads, sides = [], []
for x, (before, after) in enumerate([(-1, 1), (1, 2), (2, 0), (0, -1)]):  # normals along x
    quads.append([corner(x, 0, 0), corner(x, 1, 0), corner(x, 1, 1), corner(x, 0, 1)])
    sides.append([after, before])
for x, own in enumerate([1, 2, 0]):
    for end in range(2):  # normals outward
        y = [corner(x, end, 0), corner(x + 1, end, 0), corner(x + 1, end, 1), corner(x, end, 1)]
        z = [corner(x, 0, end), corner(x, 1, end), corner(x + 1, 1, end), corner(x + 1, 0, end)]
        quads += [y if end == 0 else y[::-1], z if end == 0 else z[::-1]]
        sides += [[-1, own]] * 2
triangles = np.array([[q[0], q[i], q[i + 1]] for q in quads for i in (1, 2)])
face_labels = np.repeat(np.array(sides, dtype=np.int32), 2, axis=0)
node_types = np.where(points[:, 0] == 1, 13, 12).astype(np.int8)

with h5py.File("triangles_6.dream3d", "w", libver="earliest") as file:
    container = file.create_group("DataContainers/TriangleDataContainer")
    container["_SIMPL_GEOMETRY/SharedVertexList"] = points
    container["_SIMPL_GEOMETRY/SharedTriList"] = triangles.astype(np.int64)
    container["FaceData/FaceLabels"], container["VertexData/Node Type"] = face_labels, node_types[:, np.newaxis]

with h5py.File("triangles_nx.dream3d", "w", libver="latest") as file:
    geometry = file.create_group("DataStructure/TriangleDataContainer")
    geometry["SharedVertexList"] = points
    geometry.create_dataset("Shared Faces List", data=triangles.astype(np.uint64), chunks=(7, 3), compression="gzip")
    geometry["Face Data/FaceLabels"] = face_labels

# LabDCT of GrainMapper3D.
with h5py.File("labels_dct.h5", "w") as file:
    file["LabDCT/Data/GrainId"] = zyx[..., 0]
    file["LabDCT/Data/Completeness"] = np.ones(zyx.shape[:3], dtype=np.float32)
    extent = spacing * shape
    file["LabDCT/Spacing"], file["LabDCT/Extent"], file["LabDCT/Center"] = spacing, extent, origin + extent / 2

# Three grains of magnesium and one of nickel in 12 x 10 points; a row of them has no solution, and some are uncertain.
columns, rows, step = 12, 10, 0.25
column, row = (a.ravel() for a in np.meshgrid(np.arange(columns), np.arange(rows)))
x, y = column * step, row * step
grain = np.where(column < 5, 0, np.where(row < 4, 1, np.where(column < 8, 2, 3)))
angles = np.array([[10.0, 20, 30], [50, 60, 7], [100, 40, 12], [200, 80, 44]])[grain]  # with x along a
angles += 0.3 * np.sin(np.arange(grain.size)[:, np.newaxis] * [1, 2, 3])
phase = np.where(grain == 3, 2, 1)
is_solved = ~((row == 7) & (column > 8))
confidence = np.where(is_solved, 0.6, -1)
quality = np.where((column == 2) & (row < 3), 40.0, 150.0)
radians = np.where(is_solved[:, np.newaxis], np.radians(angles), 4 * np.pi)
along_a2 = angles + np.where(phase == 1, 30, 0)[:, np.newaxis] * [0, 0, 1]  # Oxford's x is along the normal of (10-10)

with open("points.ang", "w") as file:
    file.write("# Phase 1\n# MaterialName Magnesium\n# Symmetry 62\n# Phase 2\n# MaterialName Nickel\n# Symmetry 43\n")
    for at in range(grain.size):
        number = " ".join(f"{angle:.9f}" for angle in radians[at])
        file.write(f"{number} {x[at]} {y[at]} {quality[at]} {confidence[at]} {phase[at]} 0 1\n")

# HKL's pair: what DefDAP reads; the phase is no field of the head.
with open("points.cpr", "w") as file:
    file.write(f"[General]\nVersion=5.0\n[Job]\nMagnification=500\nxCells={columns}\nyCells={rows}\nGridDistX={step}\nGridDistY={step}\n")
    file.write("[Acquisition Surface]\nEuler1=0\nEuler2=0\nEuler3=0\n[EDX Windows]\nCount=0\n[Phases]\nCount=2\n")
    for number, (name, group) in enumerate([("Magnesium", 9), ("Nickel", 11)], 1):
        file.write(f"[Phase{number}]\nStructureName={name}\nLaueGroup={group}\nSpaceGroup=0\n")
        file.write("a=3.2\nb=3.2\nc=5.2\nalpha=90\nbeta=90\ngamma=120\n")
    file.write("[Fields]\nCount=6\nField1=3\nField2=4\nField3=5\nField4=6\nField5=7\nField6=8\n")
record = [("phase", "u1"), ("phi1", "<f4"), ("phi", "<f4"), ("phi2", "<f4"), ("mad", "<f4"), ("bc", "u1"), ("bs", "u1")]
records = np.zeros(grain.size, dtype=record)
records["phase"], records["bc"] = np.where(is_solved, phase, 0), quality
records["phi1"], records["phi"], records["phi2"] = np.radians(along_a2).T
records.tofile("points.crc")

with h5py.File("points.h5oina", "w") as file:
    data, header = file.create_group("1/EBSD/Data"), file.create_group("1/EBSD/Header")
    data["Phase"] = np.where(is_solved, phase, 0).astype(np.uint8)
    data["Euler"] = np.radians(along_a2).astype(np.float32)
    data["X"], data["Y"] = x.astype(np.float32), y.astype(np.float32)
    data["Band Contrast"] = quality.astype(np.uint8)
    header["X Cells"], header["Y Cells"] = [columns], [rows]
    header["X Step"], header["Y Step"] = [step], [step]
    for number, name, group in [("1", "Magnesium", 9), ("2", "Nickel", 11)]:
        header[f"Phases/{number}/Phase Name"] = name
        header[f"Phases/{number}/Laue Group"] = np.array([group], dtype=np.int32)

with h5py.File("points_edax.h5", "w") as file:
    data, header = file.create_group("Scan 1/EBSD/Data"), file.create_group("Scan 1/EBSD/Header")
    for name, values in zip(["Phi1", "Phi", "Phi2"], radians.T):
        data.create_dataset(name, data=values.astype(np.float32), chunks=(50,), compression="gzip")
    data["X Position"], data["Y Position"] = x.astype(np.float32), y.astype(np.float32)
    data["CI"], data["IQ"] = confidence.astype(np.float32), quality.astype(np.float32)
    data["Phase"] = phase.astype(np.uint8)
    # What heads say of steps is often wrong.
    header["nColumns"], header["nRows"], header["Step X"], header["Step Y"] = [columns], [rows], [0.5], [0.5]
    for number, name, symmetry in [("1", b"Magnesium", 62), ("2", b"Nickel", 43)]:
        header[f"Phase/{number}/MaterialName"] = np.array([name])
        header[f"Phase/{number}/Symmetry"] = np.array([symmetry], dtype=np.int32)

with h5py.File("points_bruker.h5", "w") as file:
    data, header = file.create_group("Scan/EBSD/Data"), file.create_group("Scan/EBSD/Header")
    for name, values in zip(["phi1", "PHI", "phi2"], angles.T):
        data[name] = values.astype(np.float32)
    data["X BEAM"], data["Y BEAM"] = column.astype(np.int32), row.astype(np.int32)
    data["Phase"], data["RadonQuality"] = np.where(is_solved, phase, 0).astype(np.int32), quality
    header["NCOLS"], header["NROWS"], header["XSTEP"], header["YSTEP"] = columns, rows, step, step
    for number, name, space_group in [("1", "Magnesium", 194), ("2", "Nickel", 225)]:
        header[f"Phases/{number}/Name"], header[f"Phases/{number}/IT"] = name, space_group

with h5py.File("points.dream3d", "w", libver="earliest") as file:
    container = file.create_group("DataContainers/ImageDataContainer")
    geometry = container.create_group("_SIMPL_GEOMETRY")
    geometry["DIMENSIONS"] = np.array([columns, rows, 1], dtype=np.int64)
    geometry["SPACING"], geometry["ORIGIN"] = np.array([step, step, 1], np.float32), np.zeros(3, np.float32)
    data = container.create_group("EBSD Scan Data")
    grid = (1, rows, columns)
    data["EulerAngles"] = radians.reshape(*grid, 3).astype(np.float32)
    data["Phases"] = phase.reshape(*grid, 1).astype(np.int32)
    data["Confidence Index"] = confidence.reshape(*grid, 1).astype(np.float32)
    data["Image Quality"] = quality.reshape(*grid, 1).astype(np.float32)
    ensemble = container.create_group("EBSD Phase Data")
    ensemble["CrystalStructures"] = np.array([[999], [0], [1]], dtype=np.uint32)
    ensemble["MaterialName"] = np.array([b"Invalid", b"Magnesium", b"Nickel"])

# Four sections of the same columns of grains, each scanned from another corner: as text, and as DREAM.3D imports text of EDAX and of Oxford.
corners = [(2, 2), (3, 2), (5, 1), (4, 0)]
columns, rows, step, thickness = 14, 12, 0.25, 0.4
column, row = (a.ravel() for a in np.meshgrid(np.arange(columns), np.arange(rows)))
os.mkdir("sections")
edax, oxford = h5py.File("sections.h5ebsd", "w"), h5py.File("sections_hkl.h5ebsd", "w")
for file, maker in [(edax, "TSL"), (oxford, "HKL")]:
    file.attrs["FileVersion"] = np.int32(5)
    file["Manufacturer"], file["Stacking Order"] = maker, np.uint32(0)
    file["X Resolution"], file["Y Resolution"], file["Z Resolution"] = np.float32([step, step, thickness])
for number, (left, above) in enumerate(corners):
    across, down = column + left, row + above
    grain = 3 * (across * 2 > down + 12) + np.where(down * 3 > across + 18, 2, down > 4)
    angles = np.array([[10.0 + 25 * grain for grain in range(6)], [20.0, 50, 70, 35, 60, 15], [30.0] * 6]).T[grain]
    x, y = column * step, row * step
    with open(f"sections/s_{number + 9}.ang", "w") as file:
        file.write("# Phase 1\n# MaterialName Nickel\n# Symmetry 43\n")
        for at in range(grain.size):
            numbers = " ".join(f"{angle:.9f}" for angle in np.radians(angles[at]))
            file.write(f"{numbers} {x[at]} {y[at]} 100 0.9 1 0 1\n")
    data, header = edax.create_group(f"{number + 9}/Data"), edax.create_group(f"{number + 9}/Header")
    for name, values in zip(["Phi1", "Phi", "Phi2"], np.radians(angles).T):
        data[name] = values.astype(np.float32)
    data["X Position"], data["Y Position"] = x.astype(np.float32), y.astype(np.float32)
    data["Confidence Index"], data["Image Quality"] = np.full((2, grain.size), [[0.9], [100]], dtype=np.float32)
    data["PhaseData"] = np.ones(grain.size, dtype=np.int32)
    header["NCOLS_ODD"], header["NROWS"], header["XSTEP"] = np.int32([columns]), np.int32([rows]), np.float32([step])
    header["Phases/1/MaterialName"], header["Phases/1/Symmetry"] = "Nickel", np.int32([43])
    data, header = oxford.create_group(f"{number + 9}/Data"), oxford.create_group(f"{number + 9}/Header")
    for name, values in zip(["Euler1", "Euler2", "Euler3"], angles.T):
        data[name] = values.astype(np.float32)
    data["X"], data["Y"] = x.astype(np.float32), y.astype(np.float32)
    data["BC"], data["Phase"] = np.full((2, grain.size), [[100], [1]], dtype=np.int32)
    header["XCells"], header["YCells"], header["XStep"] = np.int32([columns]), np.int32([rows]), np.float32([step])
    header["Phases/1/PhaseName"], header["Phases/1/LaueGroup"] = "Nickel", np.int32([11])
edax.close()
oxford.close()
