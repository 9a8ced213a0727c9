"""`MotorCurve`: the torque that a motor and its drive give, over the motor's speed."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import FloatArray


@dataclass(frozen=True)
class MotorCurve:
    """Torque over speed as points, straight lines between them; beyond the last speed the motor gives nothing.

    Parameters
    ----------
    points
        Pairs of motor speed (rad/s) and torque (N·m), the speeds increasing from zero, the torques positive and never increasing.
    """

    points: tuple[tuple[float, float], ...]

    def __post_init__(self) -> None:
        faults = []
        if len(self.points) < 2:
            faults.append("a torque-speed curve needs two points at least")
        elif self.points[0][0] != 0.0:
            faults.append(
                f"a torque-speed curve begins at standstill; its first speed is {self.points[0][0]:.6g} rad/s"
            )
        for number, ((slow, strong), (fast, weak)) in enumerate(pairwise(self.points), start=2):
            if not fast > slow:
                faults.append(
                    f"point {number}: speed {fast:.6g} rad/s is not above {slow:.6g} rad/s; give the points by increasing speed"
                )
            if weak > strong:
                faults.append(
                    f"point {number}: torque {weak:.6g} N·m is above {strong:.6g} N·m at a lower speed; a motor's torque does not grow "
                    f"with its speed, give at most {strong:.6g} N·m"
                )
        faults += [
            f"point {n}: torque {torque:.6g} N·m is not positive"
            for n, (_, torque) in enumerate(self.points, 1)
            if not torque > 0
        ]
        if faults:
            raise InputError(*faults)

    @property
    def top_speed(self) -> float:
        """Greatest motor speed (rad/s)."""
        return self.points[-1][0]

    def torque(self, speed: FloatArray | float) -> FloatArray:
        """Torque available at a motor speed (N·m), whatever its sign; zero beyond the top speed."""
        speeds, torques = np.array(self.points).T
        return np.asarray(np.interp(np.abs(speed), speeds, torques, right=0.0))

    def rectangles(self, parts: int = 4) -> list[tuple[float, float]]:
        """Pairs of speed and torque such that every lower speed allows that torque: the curve's points and some between them."""
        pairs: list[tuple[float, float]] = []
        for (slow, strong), (fast, weak) in pairwise(self.points):
            for k in range(1, parts + 1):
                share = k / parts
                pair = (slow + share * (fast - slow), strong + share * (weak - strong))
                if pairs and pairs[-1][1] == pair[1]:
                    pairs.pop()  # as strong at a higher speed
                pairs.append(pair)
        return pairs
