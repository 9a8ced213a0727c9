"""`Plot`: a figure that shows itself in a notebook."""

from __future__ import annotations

from dataclasses import dataclass

from camwright.house.pictures import Picture
from camwright.house.svg import picture_svg


@dataclass(frozen=True, eq=False)
class Plot:
    """A figure of a result.

    Parameters
    ----------
    picture
        Its frames, with all that is drawn in them.
    """

    picture: Picture

    @property
    def title(self) -> str:
        """What is written above it."""
        return self.picture.title

    @property
    def svg(self) -> str:
        """The figure as SVG."""
        return picture_svg(self.picture)

    def _repr_svg_(self) -> str:
        """Give what a notebook shows."""
        return self.svg
