"""What notebooks show."""

from __future__ import annotations

import html


class View:
    """A page that notebooks show below a cell, by itself in a frame.

    Made by :meth:`grainsmooth.Polycrystal.view`.
    """

    def __init__(self, page: str, height: int = 600) -> None:
        #: The page, as HTML.
        self.page = page
        #: Height of its frame in pixels.
        self.height = height

    def _repr_html_(self) -> str:
        return f'<iframe srcdoc="{html.escape(self.page)}" width="100%" height="{self.height}" style="border: 0"></iframe>'

    def __repr__(self) -> str:
        return f"<grainsmooth.View: a page of {len(self.page)} characters>"
