"""Types, stubs, docstrings and the API reference are true."""

from __future__ import annotations

import pathlib
import subprocess
import sys

from conftest import PYTHON, needed


def passes(*words: object) -> None:
    done = subprocess.run([sys.executable, "-m", *map(str, words)], cwd=PYTHON, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_types_of_the_package_and_examples() -> None:
    needed("mypy")
    passes("mypy", "grainsmooth", "benches", *sorted((PYTHON / "examples").glob("*.py")))


def test_stubs_are_those_of_the_module() -> None:
    needed("mypy")
    passes("mypy.stubtest", "grainsmooth._grainsmooth")


def test_the_reference_is_built_without_warnings(tmp_path: pathlib.Path) -> None:
    for module in ("sphinx", "numpydoc"):
        needed(module)
    passes("sphinx", "-q", "-W", "--keep-going", "-d", tmp_path / "doctrees", "docs", tmp_path / "html")
    assert "generate" in (tmp_path / "html" / "index.html").read_text(encoding="utf-8")


def test_examples_in_docstrings_run() -> None:
    passes("pytest", "--doctest-modules", "grainsmooth", "-p", "no:cacheprovider")
