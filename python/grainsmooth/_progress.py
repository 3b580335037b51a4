"""How far long work is."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, Union

from ._inputs import require

#: Told the name of a stage, the steps done and their number.
Told = Callable[[str, int, int], object]

#: Whether a bar is shown; or who is told instead.
Progress = Union[bool, Told]


@contextmanager
def told(progress: Progress) -> Iterator[Told | None]:
    """What the library tells: a bar of tqdm, the caller's own function, or nothing."""
    if callable(progress):
        yield progress
        return
    if not progress:
        yield None
        return
    bar: Any = require("tqdm.auto", "progress").tqdm(leave=False)
    stage_shown = None

    def show(stage: str, done: int, count: int) -> None:
        nonlocal stage_shown
        if stage != stage_shown:
            stage_shown = stage
            bar.reset(total=count)
            bar.set_description(stage)
        bar.total = count
        bar.n = done
        bar.refresh()

    try:
        yield show
    finally:
        bar.close()
