"""Servo-aware design: the axis, not the command, keeps to the material.

The command is a spline, linear in its unknowns; the servo's periodic response to it is linear too. Peaks are then linear programmes, root
mean squares quadratic ones, and both hold at every sampling phase and for every servo that may occur.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from camwright.design.returns.measures import objective_value
from camwright.design.servo_aware.axis_problem import AxisProblem
from camwright.design.servo_aware.axis_response import PHASES
from camwright.design.servo_aware.gathered_rows import LEAST_ERROR
from camwright.design.servo_aware.programme import AxisProgramme
from camwright.profiles.errors import SolverError
from camwright.profiles.objective import OBJECTIVES, CommandObjective, ObjectiveName
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.returns import assemble

# By this factor the sync error of a servo between the corners may be above that at the corners.
BETWEEN = 1.1
# By this share a sync error may be above the least, and by this share a peak, for the sake of what comes after them.
KEPT_ERROR = 1e-3
KEPT_PEAK = 1e-5
# Share of its limit of which it is not worth while to look for a lower peak.
WORTH = 0.98
# Most rounds that a command of the least peak is smoothed in, and most times that this is begun; it will do as it is.
SMOOTHING, AGAIN = 8, 4


@dataclass(frozen=True, eq=False)
class AxisMotion:
    """A command whose axis keeps to the material.

    Parameters
    ----------
    profile
        One cycle of the command over ``[0, x_c]`` from the start of the return. Its slave zero is the machine at the end of its sync zone,
        where a shaped command itself need not be.
    errors
        Largest sync error of the tool in the shear zone (m) over all phases and line speeds, by servo, the nominal one first.
    by_speed
        That of the nominal servo by line speed, as a share of the cut's, from the full one down.
    value
        What was made least: the sync error (m), or the peak or root mean square over the master.
    programmes
        Programmes solved.
    axis_limits
        Whether the nominal axis, too, keeps the limits of speed, acceleration and reversal.
    shares
        Line speeds that carry the design, as shares of the cut's, from the full one down.
    phases
        Sampling phases for which the errors hold.
    """

    profile: CamProfile
    errors: tuple[float, ...]
    by_speed: dict[float, float]
    value: float
    programmes: int
    axis_limits: bool
    shares: tuple[float, ...] = (1.0,)
    phases: int = PHASES

    @property
    def error(self) -> float:
        """Largest sync error over all servos and line speeds (m)."""
        return max(self.errors)


def design_axis(problem: AxisProblem, objective: ObjectiveName) -> AxisMotion | None:
    """Design a command whose axis keeps to the material in the shear zone.

    With ``"sync_error"`` the largest sync error is made least, down to 0.5 % of the tolerance, then, within a thousandth of it, the peak
    acceleration, where that can be below 98 % of its limit; with an objective of the motion the sync tolerance is a limit. Of all commands
    with the least peak that of least RMS jerk is taken. The limits are kept by the command, and by the axis as `AxisProblem.axis_limits`
    says.

    Returns
    -------
    AxisMotion or None
        ``None`` if no command brings the axis into the tolerance, where that is asked for.

    Raises
    ------
    InputError
        The servo is unstable or forgets too slowly.
    SolverError
        A solver ended without an answer.
    """
    programme = AxisProgramme(replace(problem, wider=BETWEEN if objective == "sync_error" else 1.0))
    if objective != "sync_error":
        kept = servo_blind_optimum(programme, objective)
        if kept is not None:
            return kept
        found = programme.solve(objective, 1.0)
        if found is None:
            return None
        of = OBJECTIVES[objective]
        if of.form == "peak" and of.of == "motion":
            found = _smoothest(programme, found, 1.0, objective)
        return _motion(programme, found[0], found[1])
    band = LEAST_ERROR
    softer = _softest(programme, band) if not problem.several else None  # no command suits several servos so well
    if softer is not None:
        return _motion(programme, _smoothest(programme, softer, band, "peak_acceleration")[0])
    found = programme.solve("sync_error", None)
    if found is None:
        return None
    band = found[1] * (1.0 + KEPT_ERROR) / (1.0 - programme.margin)
    # where the prices tell that a softer command is hardly softer the limit itself will do
    hard = programme.least_share_of_limit(2, KEPT_ERROR) > WORTH
    softer = (found[0], problem.limits[2][1]) if hard else _softest(programme, band)
    if softer is not None:
        found = _smoothest(programme, softer, band, "peak_acceleration")
    return _motion(programme, found[0])


def servo_blind_optimum(programme: AxisProgramme, objective: CommandObjective) -> AxisMotion | None:
    """Take the servo-blind optimum, which the problem's structure is, where its axis keeps to everything: then nothing is better."""
    problem = programme.problem
    if problem.structure is None:
        return None
    profile = assemble(problem.structure, problem.task.from_return())
    if not programme.holds(profile):
        return None
    if objective == "rms_torque" or objective == "peak_torque" or objective == "energy":
        value = programme.problem.torque.value_of(problem.structure, objective)
    else:
        value = objective_value(problem.structure, objective)
    return motion_of(programme, profile, value, axis_limits=problem.axis_limits)


def _softest(programme: AxisProgramme, band: float) -> tuple[FloatArray, float] | None:
    """Command of the least peak acceleration within a band; ``None`` if there is none, or none to double precision."""
    try:
        return programme.solve("peak_acceleration", band)
    except SolverError:
        return None


def _smoothest(
    programme: AxisProgramme, found: tuple[FloatArray, float], band: float, objective: ObjectiveName
) -> tuple[FloatArray, float]:
    """Of all commands with the least peak the one of least RMS jerk, and that peak; the given one if there is none, or not soon.

    Rows that come while a command is smoothed may leave none with the peak that was least without them: then that is looked for again.
    """
    order = OBJECTIVES[objective].order
    for _ in range(AGAIN):
        try:
            smooth = programme.solve("rms_jerk", band, {order: found[1] * (1.0 + KEPT_PEAK)}, SMOOTHING)
            if smooth is not None:
                return smooth[0], found[1]
            again = programme.solve(objective, band)
        except SolverError:
            return found
        if again is None:
            return found
        found = again
    return found


def motion_of(
    programme: AxisProgramme, profile: CamProfile, value: float | None = None, *, axis_limits: bool
) -> AxisMotion:
    """Judge a command; its ``value`` is its largest sync error if not given."""
    errors = programme.rows.errors(profile)
    worst = tuple(max(each.values()) for each in errors)
    least = max(worst) if value is None else value
    return AxisMotion(profile, worst, errors[0], least, programme.solved, axis_limits, programme.rows.shares)


def _motion(programme: AxisProgramme, unknowns: FloatArray, value: float | None = None) -> AxisMotion:
    profile = programme.profile(unknowns)
    kept = programme.problem.axis_limits and programme.keeps_axis_limits(profile)
    return motion_of(programme, profile, value, axis_limits=kept)
