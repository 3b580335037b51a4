"""Says where a .vti and the material.yaml beside it disagree for DAMASK: `python3 materials.py FOLDER`."""
import pathlib
import sys

import damask
import numpy as np
import pyvista

folder = pathlib.Path(sys.argv[1])
materials = damask.ConfigMaterial.load(folder / "material.yaml")
grid = damask.GeomGrid.load(folder / "grains.vti")
voxels = pyvista.read(folder / "grains.vti")
assert materials.is_valid
assert sorted(materials["phase"]) == ["first", "second"], materials["phase"]
assert np.array_equal(np.unique(grid.material), np.arange(len(materials["material"])))
constituents = [material["constituents"][0] for material in materials["material"]]
numbers = np.array([["first", "second"].index(constituent["phase"]) + 1 for constituent in constituents])
assert np.array_equal(numbers[voxels["material"]], voxels["Phase"])
assert np.allclose([constituent["O"] for constituent in constituents], voxels.field_data["Quaternion"], atol=1e-15)
