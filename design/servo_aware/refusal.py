"""The refusal of a servo-aware job whose tolerance no command keeps: by how much it is missed, and the single changes that work."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

from camwright.design.feasible.refusal import require_feasible
from camwright.design.line.refusal import ramp_infeasible
from camwright.design.servo_aware.axis_motion import motion_of
from camwright.design.servo_aware.axis_problem import AxisProblem, thinned
from camwright.design.servo_aware.programme import AxisProgramme
from camwright.design.servo_aware.rows import RATIO
from camwright.profiles.cut import Cut
from camwright.profiles.errors import Covered, InfeasibleError, InputError, SolverError, Suggestion
from camwright.profiles.message import Message, Value, part_of
from camwright.profiles.returns import assemble

# Suggested values are searched to this share, and stand aside by it from the edge; and to that one where there are many line speeds, of
# which each so many-th is looked at for a way out.
ASIDE, ASIDE_EACH, LOOKED = 2e-3, 4e-2, 6
# What works by a programme alone is designed; where that fails it is taken further by these factors.
FURTHER = (1.0, 1.02, 1.1)
# Shares of the least tolerance that a programme keeps, tried in turn.
WIDER = (1.0 + ASIDE, 1.01, 1.1, 1.5)
# What binds where the error alone can be held to the tolerance, and the ratio of the axis cannot be held to what goes with it.
AXIS_RATIO = "axis_ratio"
# So much faster grows what is looked at.
GROWN = 4.0
# Of more servos than that, three are looked at first, at the full line speed.
FEW_SERVOS = 3
# Cuts up to so many times the asked length, and line speeds down to such a share, are looked at for a way out.
LONGEST, SLOWEST = 8.0, 0.02


Ways = tuple[Callable[[Cut], bool], Callable[[tuple[float, ...]], bool]]
"""What tells whether another cut can be designed, and whether the cut can for fewer line speeds."""


def axis_infeasible(problem: AxisProblem, settles: Ways | None) -> InfeasibleError:
    """Say by how much the tolerance is missed, and, of a way to tell whether a cut can be designed, what would keep it."""
    cut = problem.task.cut
    tolerance = cut.sync_tolerance
    needed = max(1.0, _least_share(problem, suggest=settles is not None)) * tolerance
    kept, suggestions = None, tuple[Suggestion, ...]()
    if settles is not None:  # what is offered keeps the limits of the axis too
        strict = replace(problem, axis_limits=True)
        kept, suggestions = _kept_part(strict, settles[1]), tuple(_suggestions(strict, needed, settles[0]))
    if kept is not None:
        suggestions = (*suggestions[:1], Suggestion("line_speeds", kept * 60, "m/min"), *suggestions[1:])
    ways = "; ".join(
        f"{each.change} {{{each.change}}}".replace("line_speeds ", "line_speeds from ") for each in suggestions
    )
    alone = AxisProgramme(problem).solve("sync_error", None)
    by_ratio = alone is not None and alone[1] <= 1.0
    excess = (needed - tolerance) * 1e3
    text = (
        f"{{@sync_tolerance}} = {{tolerance}}: no {problem.command} command within the limits holds the axis to it in the shear zone and "
        f"the ratio of the axis to {_percent(cut, tolerance)} (twice the tolerance over the shear zone); the least found to be held is "
        f"{{needed}} and {_percent(cut, needed)}, {{excess}} too much, whatever the axis does elsewhere"
        + ("; the error alone is held to {alone}: the ratio binds" if by_ratio else "")
        + ("" if kept is None or kept == cut.line_speed else "; one is held to it from {line_speeds} up")
        + (f"; what works, the axis within its limits: {ways}" if ways else "")
    )
    values = (
        ("tolerance", Value(tolerance, "m", 6)),
        ("needed", Value(needed, "m", 6)),
        ("excess", Value(needed - tolerance, "m", 4)),
        *((("alone", Value(alone[1] * tolerance, "m", 3)),) if alone is not None and by_ratio else ()),
    )
    return InfeasibleError(
        Message(text, (*values, *((each.change, _offered(each, cut)) for each in suggestions))),
        AXIS_RATIO if by_ratio else "sync_tolerance",
        excess,
        "mm",
        suggestions,
        Covered(None if kept is None else (kept, cut.line_speed)),
    )


def _least_share(problem: AxisProblem, *, suggest: bool) -> float:
    """Give the least share of the tolerance that a command within the limits is found to hold, or the only such command.

    Raises
    ------
    InfeasibleError
        There is none.
    """
    share = AxisProgramme(problem).least_share()
    if share is not None:
        return share
    if problem.structure is None:
        require_feasible(problem.task, suggest=suggest)
        if problem.task.line.ramps:
            raise ramp_infeasible(problem.task, suggest=suggest)
        raise SolverError(
            "a servo-aware design found no command that keeps the limits although the job allows one; report this job"
        )
    only = assemble(problem.structure, problem.task.from_return())
    return motion_of(AxisProgramme(problem), only, axis_limits=False).error / problem.task.cut.sync_tolerance


def _offered(suggestion: Suggestion, cut: Cut) -> Value:
    """Give the value of a suggestion for a `Message`: as it was designed in its unit, in another one beyond it."""
    chosen = f"{suggestion.value:.6g} {suggestion.unit}"
    if suggestion.change in ("line_speed", "line_speeds"):
        return Value(
            suggestion.value / 60.0, "m/s", 6, "below" if suggestion.change == "line_speed" else "above", chosen
        )
    up = suggestion.change == "sync_tolerance" or suggestion.value > cut.length * 1e3
    return Value(suggestion.value / 1e3, "m", 6, "above" if up else "below", chosen)


def _suggestions(problem: AxisProblem, needed: float, settles: Callable[[Cut], bool]) -> Iterator[Suggestion]:
    """Search a tolerance, a line speed and a cut length that work, each alone and each designed once; ``needed`` (m) is too small."""
    cut = problem.task.cut
    share = AxisProgramme(problem).least_share()
    needed = needed if share is None else max(needed, share * cut.sync_tolerance)
    for factor in WIDER:
        if settles(replace(cut, sync_tolerance=factor * needed)):
            yield Suggestion("sync_tolerance", factor * needed * 1e3, "mm")
            break
    changes: tuple[tuple[str, str, float, float, Callable[[float], Cut]], ...] = (
        ("line_speed", "m/min", 60.0, 1 / SLOWEST, lambda share: cut.designed_at(cut.line_speed / share)),
        ("length", "mm", 1e3, LONGEST, lambda share: replace(cut, length=share * cut.length)),
    )
    for name, unit, per, most, changed in changes:

        def works(share: float, changed: Callable[[float], Cut] = changed) -> bool:
            return _works(replace(problem, task=problem.task.with_cut(changed(share)), structure=None))

        found = _nearest(works, most, ASIDE if len(problem.shares) == 1 else ASIDE_EACH)
        if found is None:
            continue
        for factor in FURTHER:
            other = changed(found * factor)
            if settles(other):
                yield Suggestion(name, getattr(other, name) * per, unit)
                break


def _kept_part(problem: AxisProblem, settles: Callable[[tuple[float, ...]], bool]) -> float | None:
    """Search the least line speed (m/s) from which up to the full one a command keeps the tolerance; designed once."""
    shares = problem.shares
    low, high = 0, len(shares)  # so many work, or are not known to; so many do not
    while high - low > 1:
        middle = (low + high) // 2
        if _works(replace(problem, shares=shares[:middle])):
            low = middle
        else:
            high = middle
    if not low or len(shares) == 1 or not settles(shares[:low]):
        return None
    return shares[low - 1] * problem.task.cut.line_speed


def _percent(cut: Cut, tolerance: float) -> str:
    """Error of the ratio that goes with a tolerance."""
    return part_of(RATIO * tolerance / cut.shear_zone).removesuffix(" of") if cut.shear_zone else "any"


def _works(problem: AxisProblem) -> bool:
    """Whether a command brings the axis into the tolerance at some of the line speeds; what is offered is designed for all of them."""
    some = replace(problem, between=(), shares=thinned(problem.shares, LOOKED))
    try:
        # who cannot serve a few servos does not serve all, which takes several times as long to see
        if len(some.servos) > FEW_SERVOS:
            few = replace(some, servos=(some.servos[0], some.servos[1], some.servos[-1]), shares=some.shares[:1])
            if not AxisProgramme(few).reaches():
                return False
        return bool(AxisProgramme(some).reaches())
    except (InputError, SolverError):
        return False


def _nearest(works: Callable[[float], bool], most: float, aside: float) -> float | None:
    """Least share above 1 found to work, to a share of itself: grown until it does, then bisected; ``None`` if none does up to ``most``."""
    low, high = 1.0, 1.0 + aside
    while not works(high):
        low, high = high, 1.0 + GROWN * (high - 1.0)
        if high > most:
            return None
    while high - low > aside * high:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if works(middle) else (middle, high)
    return high
