"""The least mean square of the acceleration of a slave that keeps to a stroke and touches its ends: a few cubics, by Newton's method.

Where nothing else binds, the optimum's jerk is constant but where the slave touches an end of its stroke, and at the ends of the return,
where the acceleration rises as steeply as the jerk limit lets it. So a slow line, whose carriage has minutes to come home, is answered
exactly, where a grid of any size would have its shortest pieces many times too long.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from camwright.design.returns.bernstein import ScaledMotion
from camwright.design.returns.scaling import ScaledProblem
from camwright.profiles.polynomial.profile import FloatArray

# The first guess of a way to a touch is this share of the longest that does not run beyond it.
SHORTER = 0.9
# And it is this share of the whole return at most.
MOST = 0.3
STEPS = 60
HALVINGS = 30
# Newton's method has arrived where its residuals, beside the accelerations, are this small; rounding is a hundred times smaller.
ARRIVED = 1e-12
# Relative step of its differences.
DIFFERENCE = 1e-7


def touching_motions(problem: ScaledProblem) -> Iterator[ScaledMotion]:
    """Give the motions of least mean square acceleration that touch no end of a stroke, and both.

    Between ends of the same ratio, of a slave that must keep to a stroke about its sync zone; none for other objectives, ends and
    machines. One that keeps all limits is the optimum: the multipliers of its touches have the right sign, and the problem is convex.
    """
    if problem.objective != "rms_acceleration" or not problem.confined or not problem.rest_to_rest or not problem.drift:
        return
    ahead, behind = (problem.greatest_position, problem.least_position)[:: 1 if problem.drift > 0.0 else -1]
    for touches in ((), (ahead, behind)):
        known = _newton(problem, touches, _guess(problem, touches))
        motion = None if known is None else _motion(problem, touches, known)
        if motion is not None:
            yield motion


def _guess(problem: ScaledProblem, touches: tuple[float, ...]) -> FloatArray:
    """First guess of the unknowns: acceleration after the first ramp, places of the touches, acceleration before the last ramp."""
    ways = () if not touches else (touches[0], problem.height + problem.drift - touches[1])
    parts = [min(SHORTER * 3.0 * abs(way / problem.drift), MOST) for way in ways]
    times = [parts[0], 1.0 - parts[1]] if touches else []
    starts, ends = _bends(problem, touches, np.array([0.0, *times, 0.0]))
    return np.array([starts[0], *times, ends[-1]])


def _nodes(problem: ScaledProblem, touches: tuple[float, ...], known: FloatArray) -> tuple[FloatArray, ...]:
    """Places, positions and ratios where the pieces between the two ramps meet."""
    first, last, drift = known[0], known[-1], problem.drift
    rise, fall = abs(first) / problem.greatest_jerk, abs(last) / problem.greatest_jerk
    end = problem.height + drift
    at = np.array([rise, *known[1:-1], 1.0 - fall])
    position = np.array([drift * rise + first * rise**2 / 6, *touches, end - drift * fall + last * fall**2 / 6])
    ratio = np.array([drift + first * rise / 2, *(0.0 for _ in touches), drift - last * fall / 2])
    return at, position, ratio


def _bends(problem: ScaledProblem, touches: tuple[float, ...], known: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Acceleration at the start and at the end of each cubic between the nodes."""
    at, position, ratio = _nodes(problem, touches, known)
    h, way = np.diff(at), np.diff(position)
    start = (6.0 * way / h - 4.0 * ratio[:-1] - 2.0 * ratio[1:]) / h
    end = (2.0 * ratio[:-1] + 4.0 * ratio[1:] - 6.0 * way / h) / h
    return start, end


def _jumps(problem: ScaledProblem, touches: tuple[float, ...], known: FloatArray) -> FloatArray:
    """Jumps of the acceleration at the nodes, all of which the optimum's are zero."""
    start, end = _bends(problem, touches, known)
    return np.asarray(np.append(start, known[-1]) - np.concatenate([known[:1], end]))


def _newton(problem: ScaledProblem, touches: tuple[float, ...], known: FloatArray) -> FloatArray | None:
    """Find the unknowns at which the acceleration does not jump, from a guess; None if that fails."""

    def jumps(values: FloatArray) -> FloatArray | None:
        at = _nodes(problem, touches, values)[0]
        return (
            _jumps(problem, touches, values) if (np.diff(at) > 0.0).all() and at[0] >= 0.0 and at[-1] <= 1.0 else None
        )

    now = jumps(known)
    for _ in range(STEPS):
        if now is None:
            return None
        size = float(np.abs(now).max())
        if size <= ARRIVED * float(np.abs(_bends(problem, touches, known)).max()):
            return known
        steps = DIFFERENCE * np.maximum(np.abs(known), DIFFERENCE)
        columns = [
            _jumps(problem, touches, known + step * unit) for step, unit in zip(steps, np.eye(len(known)), strict=True)
        ]
        slopes = (np.array(columns) - now).T / steps
        try:
            way = np.linalg.solve(slopes, now)
        except np.linalg.LinAlgError:
            return None
        for _ in range(HALVINGS):
            found = jumps(known - way)
            if found is not None and float(np.abs(found).max()) < size:
                break
            way = 0.5 * way
        else:
            return None
        known, now = known - way, found
    return None


def _motion(problem: ScaledProblem, touches: tuple[float, ...], known: FloatArray) -> ScaledMotion | None:
    """Put a motion together; None where a touch pulls instead of pushing, so that the motion without it would be better."""
    at = np.array([0.0, *_nodes(problem, touches, known)[0], 1.0])
    start, end = _bends(problem, touches, known)
    jerk = (end - start) / np.diff(at)[1:-1]
    for place, jump in zip(touches, np.diff(jerk).tolist(), strict=True):
        if (jump > 0.0) == (place == problem.greatest_position):
            return None
    lengths = np.diff(at)
    accelerations = np.array([0.0, *start, end[-1], 0.0])
    left, right = accelerations[:-1], accelerations[1:]
    return ScaledMotion(lengths, accelerations, float(lengths @ (left**2 + left * right + right**2)) / 3)
