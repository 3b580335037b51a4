"""Examples run, and print what they promise; the code of the pages runs too."""

from __future__ import annotations

import os
import pathlib
import re
import subprocess
import sys

import pytest
from conftest import PYTHON, needed

EXAMPLES = {
    "first_polycrystal": (["pyvista", "pandas"], "200 grains of mean diameter 0.18"),
    "size_histogram": (["matplotlib"], "the distribution functions differ by at most 0.0"),
    "rve_to_damask": (["damask"], "50 grains in [32, 32, 32] cells"),
    "finite_elements": ([], "triangles, whose edges have 0."),
    "ensemble_band": (["pandas", "pyarrow"], "40 grains have "),
    "smooth_labels": ([], "of a sphere's as voxels, 1.0"),
    "ebsd_from_orix": (["orix"], "grains fill 300.0 square micrometres"),
}


def run(script: pathlib.Path, folder: pathlib.Path) -> str:
    environment = {**os.environ, "VTK_DEFAULT_OPENGL_WINDOW": "vtkEGLRenderWindow", "MPLBACKEND": "Agg"}
    done = subprocess.run([sys.executable, script], cwd=folder, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_all_examples_are_known() -> None:
    assert {path.stem for path in (PYTHON / "examples").glob("*.py")} == set(EXAMPLES)


@pytest.mark.parametrize("name", EXAMPLES)
def test_examples_print_what_they_promise(name: str, tmp_path: pathlib.Path) -> None:
    modules, expected = EXAMPLES[name]
    for module in modules:
        needed(module)
    assert expected in run(PYTHON / "examples" / f"{name}.py", tmp_path)


@pytest.mark.parametrize("page", ["README.md", "../docs/python.md"])
def test_code_of_the_pages_runs(page: str, tmp_path: pathlib.Path) -> None:
    for module in ("pyvista", "pandas", "pyarrow"):
        needed(module)
    blocks = re.findall(r"^```python\n(.*?)^```", (PYTHON / page).read_text(encoding="utf-8"), re.M | re.S)
    assert blocks
    code = "\n".join(blocks).replace(".plot()", '.plot(off_screen=True, screenshot="scene.png")')
    script = tmp_path / "page.py"
    # Processes that are spawned read the script again.
    script.write_text("def main():\n" + re.sub(r"^(?=.)", "    ", code, flags=re.M) + "\n\nif __name__ == '__main__':\n    main()\n")
    run(script, tmp_path)
