"""`MarkRange`: how early and how late a print mark may come for a cut to follow it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class MarkRange:
    """Corrections that a cut bears (m): the mark comes so much earlier (negative) or later than expected.

    Parameters
    ----------
    earliest
        The earliest, not above zero; ``None`` where nothing ends the range.
    latest
        The latest, not below zero; ``None`` where nothing ends the range.
    """

    earliest: float | None
    latest: float | None

    def within(self, other: MarkRange) -> MarkRange:
        """Return what lies within both ranges."""
        early = [each for each in (self.earliest, other.earliest) if each is not None]
        late = [each for each in (self.latest, other.latest) if each is not None]
        return MarkRange(max(early, default=None), min(late, default=None))
