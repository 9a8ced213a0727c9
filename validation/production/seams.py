"""What happens where one cam ends and another begins: the steps of position, velocity and acceleration at the seam."""

from __future__ import annotations

from dataclasses import dataclass

from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.task import Task


@dataclass(frozen=True)
class SeamJump:
    """Steps at a seam, of the tool along the material, magnitudes.

    Parameters
    ----------
    position
        Step of the position (m).
    velocity
        Step of the velocity (m/s).
    acceleration
        Step of the acceleration (m/s²).
    """

    position: float
    velocity: float
    acceleration: float

    def worst(self, other: SeamJump) -> SeamJump:
        """Greatest of two, each by itself."""
        return SeamJump(
            max(self.position, other.position),
            max(self.velocity, other.velocity),
            max(self.acceleration, other.acceleration),
        )


NO_JUMP = SeamJump(0.0, 0.0, 0.0)
"""A seam that cannot be felt."""


def seam_jump(
    before: CamProfile, zero_before: float, after: CamProfile, zero_after: float, task: Task, line_speed: float
) -> SeamJump:
    """Run one cycle of a cam into the start of another.

    The slave is put where the material is: where the position steps, the drive that takes the second table by its absolute positions makes
    that step.

    Parameters
    ----------
    before, after
        Cams, as designed or as a drive rebuilds them from its tables (slave unit over m).
    zero_before, zero_after
        Slave coordinate of the machine at their slave zeros (slave unit).
    task
        The machine, for its pitch and its tool, and the cut.
    line_speed
        Line speed at the seam (m/s).

    Examples
    --------
    >>> from camwright import baseline, load_job
    >>> task = load_job().task
    >>> cams = [baseline("poly_3_4_5", task.with_length(length)) for length in (0.5, 0.9)]
    >>> jump = seam_jump(cams[0], 0.0, cams[1], 0.0, task, 80 / 60)
    >>> jump.position < 1e-15, jump.velocity < 1e-15, jump.acceleration < 1e-12
    (True, True, True)
    """
    machine = task.machine
    end = zero_before + float(before(before.end)) - machine.pitch
    start = zero_after + float(after(after.start))
    lever = abs(float(machine.tool_ratio(start)))
    ratio = float(after(after.start, 1)) - float(before(before.end, 1))
    slope = float(after(after.start, 2)) - float(before(before.end, 2))
    return SeamJump(
        abs(float(machine.tool(start)) - float(machine.tool(end))),
        abs(ratio) * lever * line_speed,
        abs(slope) * lever * line_speed**2,
    )
