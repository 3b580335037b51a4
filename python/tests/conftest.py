"""What tests share."""

from __future__ import annotations

import os
import pathlib
from typing import Any

import pytest

import grainsmooth

PYTHON = pathlib.Path(__file__).parent.parent


@pytest.fixture(scope="session")
def grains() -> grainsmooth.Polycrystal:
    """Thirty grains, which nobody changes."""
    return grainsmooth.Polycrystal.generate(seeds=30, levels=1, relax=0.1, texture="random")


def needed(module: str) -> Any:
    """A package that a test hands things to; without it the test is skipped, but fails where all are to be there."""
    if os.environ.get("CI") == "true":
        return __import__(module)
    return pytest.importorskip(module)
