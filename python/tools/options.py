"""Writes ``grainsmooth/_options.py``: the program's options as keywords, from the table that the program itself has.

Run ``python tools/options.py`` after a change of options; a test compares.
"""

from __future__ import annotations

import pathlib
import re
import textwrap
from typing import Any

from grainsmooth import _grainsmooth

FILE = pathlib.Path(__file__).parent.parent / "grainsmooth" / "_options.py"

#: Options of the program that no keyword stands for, and what does instead.
LEFT_OUT = {
    "config": "Polycrystal.from_settings takes the text of such a file",
    "help": "help() shows the docstring",
    "version": "grainsmooth.__version__",
    "output": "Polycrystal.save takes paths",
    "format": "Polycrystal.save takes paths",
    "grains_dir": "to_pyvista().threshold, or the program",
    "grains_format": "as grains_dir",
    "stats": "Polycrystal.grains, .boundaries and the other tables",
    "series": "the program alone writes time series",
    "every": "as series",
    "cells_json": "grainsmooth.tessellate gives the cells",
    "cells_csv": "grainsmooth.tessellate gives the cells",
    "no_mesh": "grainsmooth.tessellate gives the cells",
    "picture": "Polycrystal.picture and .plot",
    "picture_size": "an argument of Polycrystal.picture",
    "color_by": "an argument of Polycrystal.picture",
    "explode": "an argument of Polycrystal.picture",
    "slice": "pyvista's clip, or the program",
    "transparent": "an argument of pyvista's add_mesh, or the program",
    "report": "Polycrystal.report",
    "dry_run": "nothing is written unless it is saved",
    "json_summary": "Polycrystal.summary",
    "threads": "a keyword of its own, which no result depends on",
    "quiet": "nothing is printed unless progress=True",
}

HEAD = '''"""The program's options as keywords. Written by tools/options.py from the program's own table: change options there."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Literal, TypedDict, Union

#: A number, a text or a path, as the command line has it.
Value = Union[int, float, str, "os.PathLike[str]"]

#: The value of an option that can be given several times: one, or a list; parts with names, as of a phase, are a dictionary.
Repeated = Union[Value, Mapping[str, Value], Sequence[Union[Value, Mapping[str, Value]]]]


class Options(TypedDict, total=False):
    """What shapes a polycrystal, and how its files are written.

    Names, defaults, ranges and messages are those of the program ``grainsmooth``: ``--rng-seed 7`` is ``rng_seed=7``. An option that is
    ``None`` is not given.
    """
'''


def annotation(option: dict[str, Any]) -> str:
    """The type of an option's value."""
    if option["kind"] == "flag":
        return "bool"
    if option["kind"] == "repeated":
        return "Repeated"
    if option["values"]:
        values = ", ".join(f'"{value}"' for value in option["values"])
        return f"Literal[{values}]"
    least, most = option["count"]
    if most == 1:
        return "Value"
    return "Union[Value, Sequence[Value]]" if least == 1 else "Sequence[Value]"


def text() -> str:
    """The whole file."""
    parts = [HEAD]
    for option in _grainsmooth.options():
        if option["name"] in LEFT_OUT:
            continue
        help_text = str(option["help"]).replace("\\", "\\\\")
        if option["default"]:
            help_text += f"\n\nDefault: ``{option['default']}``"
        paragraphs = [
            "\n".join(textwrap.wrap(re.sub(r"\s+", " ", paragraph), 120))
            for paragraph in re.split(r"\n\s*\n", help_text.strip())
        ]
        paragraphs = [re.sub(r"^Example: (.*)$", r"Example of the command line: ``\1``", one) for one in paragraphs]
        body = textwrap.indent("\n\n".join(paragraphs), "    ").strip()
        parts.append(f'\n    {option["name"]}: {annotation(option)}\n    """{body}"""\n')
    return "".join(parts)


if __name__ == "__main__":
    FILE.write_text(text(), encoding="utf-8")
