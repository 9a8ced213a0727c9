"""`Objective`: what a design makes least; all objectives in one table."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

MotionObjective = Literal["peak_acceleration", "rms_acceleration", "peak_jerk", "rms_jerk"]
"""Names of the objectives of the motion alone."""

MotorObjective = Literal["rms_torque", "peak_torque", "energy"]
"""Names of the objectives of the motor, which need to know what it moves."""

CommandObjective = Literal[MotionObjective, MotorObjective]
"""Names of the objectives of the command, whatever the servo makes of it."""

ObjectiveName = Literal[CommandObjective, "sync_error"]
"""Names of all objectives."""


@dataclass(frozen=True)
class Objective:
    """Something that a design makes least.

    Parameters
    ----------
    name
        What job files, answers and tables call it.
    order
        Order of the derivative over time that it measures; 0 where it is none. A value over the master times the line speed to
        this power is the value over time.
    form
        Greatest magnitude (``"peak"``), root mean square (``"rms"``), or what is drawn over a cycle (``"drawn"``).
    of
        Whose it is: of the motion of the slave, of the motor, or of the axis, which follows the command as its servo lets it.
    own_unit
        Its SI unit; nothing where that is the slave's unit over seconds to the order.

    Examples
    --------
    >>> from camwright import Objective
    >>> Objective("peak_acceleration", 2, "peak", "motion").unit("m")
    'm/s^2'
    """

    name: ObjectiveName
    order: Literal[0, 2, 3]
    form: Literal["peak", "rms", "drawn"]
    of: Literal["motion", "motor", "axis"]
    own_unit: str | None = None

    def unit(self, slave_unit: str) -> str:
        """Give its unit in ASCII, for a slave that is counted in ``slave_unit``.

        Examples
        --------
        >>> OBJECTIVES["peak_jerk"].unit("rad"), OBJECTIVES["energy"].unit("rad")
        ('rad/s^3', 'J')
        """
        return self.own_unit or f"{slave_unit}/s^{self.order}"

    @property
    def words(self) -> str:
        """Its name in words.

        Examples
        --------
        >>> OBJECTIVES["rms_jerk"].words
        'RMS jerk'
        """
        return self.name.replace("_", " ").replace("rms", "RMS")

    def over_time(self, value: float, line_speed: float) -> float:
        """Turn its value over the master into that over time at a line speed (m/s)."""
        return value * line_speed**self.order


OBJECTIVES: dict[ObjectiveName, Objective] = {
    objective.name: objective
    for objective in (
        Objective("peak_acceleration", 2, "peak", "motion"),
        Objective("rms_acceleration", 2, "rms", "motion"),
        Objective("peak_jerk", 3, "peak", "motion"),
        Objective("rms_jerk", 3, "rms", "motion"),
        Objective("rms_torque", 0, "rms", "motor", "N m"),
        Objective("peak_torque", 0, "peak", "motor", "N m"),
        Objective("energy", 0, "drawn", "motor", "J"),
        Objective("sync_error", 0, "peak", "axis", "m"),
    )
}
"""All objectives by name."""

MOTION_OBJECTIVES: tuple[MotionObjective, ...] = get_args(MotionObjective)
"""Names of the objectives of the motion alone."""

COMMAND_OBJECTIVES: tuple[CommandObjective, ...] = get_args(CommandObjective)
"""Names of the objectives that a design can have which knows no servo."""


def of_command(name: ObjectiveName) -> CommandObjective:
    """Objective of the command that stands for another where no servo is known: the peak acceleration for the sync error.

    Examples
    --------
    >>> of_command("sync_error"), of_command("rms_torque")
    ('peak_acceleration', 'rms_torque')
    """
    return "peak_acceleration" if name == "sync_error" else name


def of_motion(name: ObjectiveName) -> MotionObjective:
    """Objective of the motion that stands for another where neither servo nor motor is known.

    That is the RMS acceleration for what the motor feels, the peak acceleration for the sync error.

    Examples
    --------
    >>> of_motion("energy"), of_motion("sync_error"), of_motion("rms_jerk")
    ('rms_acceleration', 'peak_acceleration', 'rms_jerk')
    """
    command = of_command(name)
    if command == "rms_torque" or command == "peak_torque" or command == "energy":
        return "rms_acceleration"
    return command
