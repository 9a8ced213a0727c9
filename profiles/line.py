"""`Line`: how hard the line ramps its speed, up, down, and to a stop."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Line:
    """What the line does to its own speed; the cam must bear it at every phase. Nothing of it: the line runs steadily.

    Parameters
    ----------
    acceleration
        Greatest acceleration with which the line speeds up and slows down (m/s²); nothing where it never does.
    stop
        Deceleration of the emergency stop (m/s²), a magnitude; nothing where it is that of any other ramp.
    jerk
        Greatest jerk with which these accelerations come and go (m/s³); nothing where what the corners of a ramp do is not looked at.

    Examples
    --------
    >>> from camwright.profiles.line import Line
    >>> line = Line(acceleration=1.0, stop=5.0)
    >>> line.ramps, line.hardest, line.stop_length(80 / 60)
    (True, 5.0, 0.17777777777777776)
    """

    acceleration: float | None = None
    stop: float | None = None
    jerk: float | None = None

    @property
    def ramps(self) -> bool:
        """Whether the line changes its speed at all."""
        return self.hardest > 0.0

    @property
    def speeding(self) -> float:
        """Greatest acceleration along the line (m/s²), 0 where it is not known to speed up."""
        return self.acceleration or 0.0

    @property
    def braking(self) -> float:
        """Greatest deceleration (m/s²), a magnitude: the harder of ramp and emergency stop."""
        return max(self.speeding, self.stop or 0.0)

    @property
    def hardest(self) -> float:
        """Greatest magnitude of the line's acceleration (m/s²)."""
        return max(self.speeding, self.braking)

    @property
    def known_jerk(self) -> float:
        """Greatest magnitude of the line's jerk (m/s³), 0 where it is not known."""
        return self.jerk or 0.0

    def stop_length(self, line_speed: float) -> float | None:
        """Material that passes while the line stops from a speed (m/s), ``v² / 2a`` (m), its jerk not counted; nothing without a ramp.

        The deceleration is that of the emergency stop, of the ramp where none is given.
        """
        deceleration = self.stop or self.speeding
        return None if deceleration == 0.0 else line_speed**2 / (2.0 * deceleration)


STEADY = Line()
"""A line that keeps its speed."""
