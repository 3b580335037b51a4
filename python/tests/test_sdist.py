"""The source distribution is small, and all that the build needs is in it."""

from __future__ import annotations

import pathlib
import subprocess
import sys
import tarfile

import pytest
from conftest import PYTHON, needed


def test_sources_are_whole(tmp_path: pathlib.Path) -> None:
    needed("maturin")
    tomllib = pytest.importorskip("tomllib")
    words = [sys.executable, "-m", "maturin", "sdist", "--manifest-path", PYTHON / "Cargo.toml", "--out", tmp_path]
    subprocess.run(words, check=True, capture_output=True)
    [archive] = tmp_path.glob("*.tar.gz")
    assert archive.stat().st_size < 4e6
    with tarfile.open(archive) as files:
        files.extractall(tmp_path)
    manifests = list(tmp_path.rglob("Cargo.toml"))
    assert len(manifests) > 8
    # Cargo builds nothing where the source of a target is missing that a manifest names.
    for manifest in manifests:
        named = tomllib.loads(manifest.read_text(encoding="utf-8"))
        for kind, folder in (("bench", "benches"), ("example", "examples"), ("test", "tests")):
            for target in named.get(kind, []):
                path = manifest.parent / target.get("path", f"{folder}/{target['name']}.rs")
                assert path.exists(), path
