"""Ranges in which the servo's parameters are known to lie."""

from __future__ import annotations

from dataclasses import asdict, dataclass, fields, replace
from itertools import product

import numpy as np

from camwright.profiles.servo import Servo

_STEPS, _GRIDDED = 5, 3
"""Steps of a range, corners included, and most ranges that are stepped through; see `ServoTolerance.between`."""

Range = tuple[float, float]
"""Least and greatest value of a parameter, equal where it is known."""


@dataclass(frozen=True)
class ServoTolerance:
    """Ranges of the parameters of a servo, by their names in `camwright.profiles.servo.Servo`, in SI units.

    Parameters
    ----------
    bandwidth, damping, position_gain, sample_time, dead_time
        Least and greatest value, the servo's own between them.

    Examples
    --------
    >>> servo = Servo(120.0, 0.7, 35.0, 0.004, 1.0)
    >>> ranges = ServoTolerance((108.0, 132.0), (0.7, 0.7), (35.0, 35.0), (0.004, 0.004), (0.0, 0.002))
    >>> ranges.varying
    ('bandwidth', 'dead_time')
    >>> [(corner.bandwidth, corner.dead_time) for corner in ranges.vertices(servo)]
    [(108.0, 0.0), (108.0, 0.002), (132.0, 0.0), (132.0, 0.002)]
    """

    bandwidth: Range
    damping: Range
    position_gain: Range
    sample_time: Range
    dead_time: Range

    @property
    def ranges(self) -> dict[str, Range]:
        """The ranges by name, in the order of the fields."""
        return {entry.name: getattr(self, entry.name) for entry in fields(self)}

    @property
    def varying(self) -> tuple[str, ...]:
        """Names of the parameters that have a range of some width."""
        return tuple(name for name, (low, high) in self.ranges.items() if low < high)

    def vertices(self, servo: Servo) -> tuple[Servo, ...]:
        """Servos at all corners of the ranges; the servo itself where no parameter varies.

        The last of the varying parameters changes fastest, from its least to its greatest value.

        Parameters
        ----------
        servo
            Gives what has no range here: velocity feed-forward and lead.
        """
        corners = product(*((low, high) if low < high else (low,) for low, high in self.ranges.values()))
        return tuple(replace(servo, **dict(zip(self.ranges, corner, strict=True))) for corner in corners)

    def between(self, servo: Servo) -> tuple[Servo, ...]:
        """Servos between the corners: five steps of each range where at most three vary, else draws of the same number.

        Parameters
        ----------
        servo
            Gives what has no range here: velocity feed-forward and lead.
        """
        varying = len(self.varying)
        if varying > _GRIDDED:
            return self.draw(servo, _STEPS**_GRIDDED, 0)
        levels = (np.linspace(low, high, _STEPS if low < high else 1).tolist() for low, high in self.ranges.values())
        corners = set(self.vertices(servo))
        every = (replace(servo, **dict(zip(self.ranges, point, strict=True))) for point in product(*levels))
        return tuple(each for each in every if each not in corners)

    def draw(self, servo: Servo, count: int, seed: int) -> tuple[Servo, ...]:
        """Draw servos uniformly from the ranges, each parameter by itself.

        Parameters
        ----------
        servo
            Gives what has no range here: velocity feed-forward and lead.
        count
            Number of servos.
        seed
            Seed of the random numbers; the same seed draws the same servos.
        """
        low, high = np.array(list(self.ranges.values())).T
        points = low + (high - low) * np.random.default_rng(seed).random((count, len(low)))
        known, names = asdict(servo), tuple(self.ranges)
        return tuple(
            Servo(**(known | dict(zip(names, point, strict=True)))) for point in np.minimum(points, high).tolist()
        )
