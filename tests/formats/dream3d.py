"""Checks files as DREAM.3D 6 writes them: what each group and array must have, by its own test files, and that what is told twice agrees."""

import sys

import h5py
import numpy as np

NAMES = {np.dtype("int32"): b"DataArray<int32_t>", np.dtype("uint32"): b"DataArray<uint32_t>", np.dtype("float32"): b"DataArray<float>"}

for name in sys.argv[1:]:
    with h5py.File(name) as file:
        assert file.attrs["FileVersion"] == b"7.0" and {"DataContainerBundles", "DataContainers"} <= set(file)
        (container,) = file["DataContainers"].values()
        geometry = container["_SIMPL_GEOMETRY"]
        assert geometry.attrs["GeometryTypeName"] == b"ImageGeometry" and geometry.attrs["GeometryType"] == [0]
        shape = list(geometry["DIMENSIONS"])
        assert geometry["DIMENSIONS"].dtype == np.int64 and geometry["SPACING"].dtype == geometry["ORIGIN"].dtype == np.float32
        for matrix, kind in [("CellData", 3), ("CellFeatureData", 7), ("CellEnsembleData", 11)]:
            group = container[matrix]
            assert group.attrs["AttributeMatrixType"] == [kind] and group.attrs["AttributeMatrixType"].dtype == np.uint32
            rows = list(group.attrs["TupleDimensions"])
            assert kind != 3 or rows == shape
            for array in group.values():
                assert list(array.attrs["TupleDimensions"]) == rows and array.attrs["DataArrayVersion"] == [2]
                assert array.attrs["Tuple Axis Dimensions"].decode() == ",".join(f"{axis}={count}" for axis, count in zip("xyz", rows))
                components = list(array.attrs["ComponentDimensions"])
                if array.name.endswith("MaterialName"):
                    assert array.attrs["ObjectType"] == b"StringDataArray" and list(array.shape) == rows
                else:
                    assert array.attrs["ObjectType"] == NAMES[array.dtype] and list(array.shape) == rows[::-1] + components
        cells, features, phases = (container[name] for name in ["CellData", "CellFeatureData", "CellEnsembleData"])
        ids = cells["FeatureIds"][...][..., 0]
        assert ids.min() == 1 and ids.max() == len(features["Phases"]) - 1
        assert (cells["Phases"][...] == features["Phases"][...][ids]).all()
        assert (cells["EulerAngles"][...] == features["AvgEulerAngles"][...][ids]).all()
        names = [name.decode() for name in phases["MaterialName"]]
        structures = list(phases["CrystalStructures"][:, 0])
        assert structures[0] == 999 and dict(zip(names, structures)).get("Nickel") == 1
        if "Magnesium" in names:
            assert structures[names.index("Magnesium")] == 0
