"""From an answer of a torque programme to a return that meets its ends to rounding."""

from __future__ import annotations

import numpy as np

from camwright.design.returns.structure import without_false_corners
from camwright.design.torque.programme import Guess
from camwright.design.torque.task import Pattern, TorqueTask
from camwright.profiles.polynomial.profile import CamProfile, FloatArray


def finish(guess: Guess, pattern: Pattern, task: TorqueTask) -> CamProfile:
    """Write an answer as a return over ``[0, length]`` from slave zero.

    The solver leaves residuals of about 1e-9. Phase by phase the accelerations between the ends are corrected by the smallest amounts that
    make velocity and travel what the ends say; so a slave at rest is at rest.
    """
    problem, scale = task.problem, task.scale
    length = problem.length
    shares = guess.lengths / guess.lengths.sum()
    breaks, rows = [0.0], []
    velocity, position, node = problem.start_ratio, 0.0, 0
    meshes = iter(guess.mesh)
    for k, (phase, share) in enumerate(zip(pattern, shares, strict=True)):
        last = k == len(pattern) - 1
        if phase == "rest":
            if share > 0.0:
                breaks.append(breaks[-1] + share * length)
                rows.append([position, 0.0, 0.0, 0.0])
            continue
        mesh = next(meshes)
        a = guess.acceleration[node : node + len(mesh) + 1] * scale / length**2
        node += len(mesh)
        if k == 0:
            a = np.append(problem.start_slope, a[1:])
        if last:
            a = np.append(a[:-1], problem.end_slope)
        h, a = without_false_corners(mesh / mesh.sum() * share * length, a)
        target = problem.end_ratio if last else 0.0
        goal = problem.height if last else float(guess.position[node]) * scale
        ends = breaks[-1] + np.cumsum(h)
        if last:
            ends[-1] = length
        # widths as the breaks have them: of a millionth of the return rounding is 1e-10
        rows += _cubics(np.diff(ends, prepend=breaks[-1]), a, (position, velocity), (goal, target))
        breaks += ends.tolist()
        velocity, position = target, goal
    return CamProfile.from_arrays(np.append(breaks[:-1], length), rows)


def with_longer_rest(back: CamProfile, length: float) -> CamProfile | None:
    """Let a return stand so much longer that it has a length (m), its moves the same but for rounding; None if it does not stand."""
    rests = np.where(back.coefficients[:, 1:].any(axis=1), 0.0, np.diff(back.breaks))
    if not rests.any():
        return None
    at = int(rests.argmax())
    breaks = np.append(back.breaks[: at + 1], back.breaks[at + 1 :] + (length - back.length))
    breaks[-1] = length
    rest = float(back.coefficients[at, 0])
    rows = []
    for pieces, goal in ((slice(at), (rest, 0.0)), (slice(at + 1, None), (back.advance, float(back(back.end, 1))))):
        moves, width = back.coefficients[pieces], np.diff(back.breaks)[pieces]
        a = np.append(2 * moves[:, 2], 2 * moves[-1, 2] + 6 * moves[-1, 3] * width[-1])
        rows += _cubics(np.diff(breaks)[pieces], a, (float(moves[0, 0]), float(moves[0, 1])), goal)
        rows += [[rest, 0.0, 0.0, 0.0]] if len(rows) == at else []
    return CamProfile.from_arrays(breaks, rows)


def _cubics(h: FloatArray, a: FloatArray, start: tuple[float, float], end: tuple[float, float]) -> list[list[float]]:
    """Pieces of widths and accelerations at nodes, these corrected, from position and velocity at one end to those at the other."""
    position, velocity = start
    a = _corrected(h, a, velocity, end[1] - velocity, end[0] - position)
    rows = []
    for width, first, second in zip(h, a[:-1], a[1:], strict=True):
        rows.append([position, velocity, first / 2, (second - first) / (6 * width)])
        position += width * (velocity + width * (first / 3 + second / 6))
        velocity += width * (first + second) / 2
    return rows


def _corrected(h: FloatArray, a: FloatArray, velocity: float, gain: float, way: float) -> FloatArray:
    """Accelerations at nodes, those between the ends altered least, that gain a velocity and cover a way."""
    ahead = h.sum() - np.cumsum(h)
    gains, ways = np.zeros(len(a)), np.zeros(len(a))
    gains[:-1] += h / 2
    gains[1:] += h / 2
    ways[:-1] += h * (h / 3 + ahead / 2)
    ways[1:] += h * (h / 6 + ahead / 2)
    response = np.stack([gains, ways / h.sum()])
    missing = np.array([gain, (way - velocity * h.sum()) / h.sum()]) - response @ a
    corrected = a.copy()
    corrected[1:-1] += np.linalg.lstsq(response[:, 1:-1], missing, rcond=None)[0]
    return corrected
