"""How far a print mark may move a cut of a cam that stays as it is: by a phase of its master, or by an offset of its slave.

Both run over the return with the quintic that controllers use, ``q(u) = 10 u³ - 15 u⁴ + 6 u⁵``.

Master phase (a mark that is late by ``d``): the return lasts ``T = (L + d) / v``, the cam sees the master ``x + p(t)``, ``p = -d q(t/T)``::

    velocity s' w,  acceleration s'' w² + s' p'',  jerk s''' w³ + 3 s'' w p'' + s' p''',  w = v + p'

Slave offset: the timing of the return stays, ``T = L / v``, and the slave is ``o(t) = -d k q(t/T)`` off, with its ratio ``k`` in sync. The
shear zone then lies ``d`` later in the sync zone.

Both run over the master. Where the line ramps with ``a`` and jerk ``j`` each motion must also keep ``|acceleration| + |velocity| a/v``
and ``|jerk| + 3 |acceleration| a/v + |velocity| j/v`` within the limits.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from camwright.profiles.halving import halved
from camwright.profiles.mark_range import MarkRange
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.task import Task

ALLOWED = 1e-9
"""Share by which a limit may be exceeded: rounding, as the contract has it."""

FARTHEST = 64.0
"""Corrections up to this multiple of the cut length are looked at."""

NOTHING = 1e-6
"""Corrections below this are none (m): what the allowance for rounding leaves of a limit that is used up."""

_PLACES = 4_001
_FIRST = 1e-3
_HALVINGS = 60
_BESIDE = 1e-9
"""Beside each end of a piece both of its sides are looked at, so far from it (share of the return)."""


@dataclass(frozen=True)
class Held:
    """Limits that a shifted motion is held to.

    Parameters
    ----------
    least, greatest
        Limits of the velocity; infinite where it is not looked at.
    acceleration, jerk
        Limits of the magnitudes; infinite alike.
    ramp, ramp_jerk
        Acceleration and jerk of the line over its speed (1/s, 1/s²): by what share of velocity and acceleration a ramp adds to the others.
    """

    least: float
    greatest: float
    acceleration: float
    jerk: float
    ramp: float = 0.0
    ramp_jerk: float = 0.0


def held(task: Task, *, acceleration_alone: bool = False) -> Held:
    """Give the limits of a task, or its limit of the acceleration alone, and what its line adds."""
    limits, line, v = task.limits, task.line, task.cut.line_speed
    ramp, ramp_jerk = line.hardest / v, line.known_jerk / v
    if acceleration_alone:
        return Held(-math.inf, math.inf, limits.acceleration, math.inf, ramp, ramp_jerk)
    return Held(task.least_velocity, limits.speed, limits.acceleration, limits.jerk, ramp, ramp_jerk)


def phase_range(cam: CamProfile, task: Task, limits: Held) -> MarkRange:
    """Find how far a mark may be off that a phase of the master over the return makes up for.

    Parameters
    ----------
    cam
        One cycle, with the origin that the cut states.
    task
        The machine, the cut and its line speed.
    limits
        What the motion is held to.
    """
    back, v, length = _return(cam, task), task.cut.line_speed, task.cut.return_zone

    def kept(shift: float) -> bool:
        time = (length + shift) / v
        u = _places(back, lambda u: u * (length + shift) - shift * _quintic(u, 0))
        x = np.clip(u * (length + shift) - shift * _quintic(u, 0), back.start, back.end)
        w, bent, jerked = (base - shift * _quintic(u, k) / time**k for base, k in ((v, 1), (0.0, 2), (0.0, 3)))
        s1, s2, s3 = (back(x, k) for k in (1, 2, 3))
        return _kept(s1 * w, s2 * w**2 + s1 * bent, s3 * w**3 + 3 * s2 * w * bent + s1 * jerked, limits)

    return MarkRange(_farthest(kept, -0.999 * length), _farthest(kept, FARTHEST * task.cut.length))


def offset_range(cam: CamProfile, task: Task, limits: Held) -> MarkRange | None:
    """Find how far a mark may be off that an offset of the slave makes up for; None where the ratio changes in sync: it would be off.

    Parameters
    ----------
    cam, task, limits
        As of `phase_range`.
    """
    if not task.straight:
        return None
    back, v = _return(cam, task), task.cut.line_speed
    time, ratio = task.cut.return_zone / v, float(task.sync(0.0, 1))
    u = _places(back, lambda u: u * back.end)
    x = np.clip(u * back.end, back.start, back.end)
    own = [back(x, k) * v**k for k in (1, 2, 3)]

    def kept(shift: float) -> bool:
        moved = [part - shift * ratio * _quintic(u, k) / time**k for k, part in enumerate(own, start=1)]
        return _kept(moved[0], moved[1], moved[2], limits)

    far = FARTHEST * task.cut.length
    return MarkRange(_farthest(kept, -far), _farthest(kept, far))


def arc_range(task: Task, settling: float) -> MarkRange:
    """Find how far the shear zone may move in a sync zone that stays: not before the axis has settled, nor out at its end.

    Parameters
    ----------
    settling
        Distance from the start of the sync zone beyond which the axis is in tolerance (m).
    """
    cut = task.cut
    early = max(cut.shear_zone_at - settling, 0.0)
    late = max(cut.sync_zone - cut.shear_zone - cut.shear_zone_at, 0.0)
    return MarkRange(-early, late)


def _return(cam: CamProfile, task: Task) -> CamProfile:
    """Cut the return out of a cycle, from zero on the master."""
    start = task.cut.return_start
    part = cam.restrict(start, start + task.cut.return_zone) if start > 0 else cam.restrict(0.0, task.cut.return_zone)
    return part.shift(-part.start)


def _quintic(u: FloatArray, order: int) -> FloatArray:
    """Evaluate the quintic from 0 to 1, or a derivative."""
    table = np.polynomial.Polynomial([0.0, 0.0, 0.0, 10.0, -15.0, 6.0])
    return np.asarray((table.deriv(order) if order else table)(u))


def _places(back: CamProfile, master: Callable[[FloatArray], FloatArray]) -> FloatArray:
    """Give shares of the time at which a motion is looked at: evenly, and on both sides of where the master passes the end of a piece."""
    u = np.linspace(0.0, 1.0, _PLACES)
    passed = np.maximum.accumulate(master(u))
    inner = np.interp(back.breaks[1:-1], passed, u)
    return np.unique(np.clip(np.concatenate([u, inner - _BESIDE, inner + _BESIDE]), 0.0, 1.0))


def _kept(velocity: FloatArray, acceleration: FloatArray, jerk: FloatArray, limits: Held) -> bool:
    room = ALLOWED * (limits.greatest if math.isfinite(limits.greatest) else 1.0)
    if velocity.min() < limits.least - room or velocity.max() > limits.greatest + room:
        return False
    pace, push = np.abs(velocity), np.abs(acceleration)
    if (push + limits.ramp * pace).max() > limits.acceleration * (1 + ALLOWED):
        return False
    jerked = np.abs(jerk) + 3.0 * limits.ramp * push + limits.ramp_jerk * pace
    return not jerked.max() > limits.jerk * (1 + ALLOWED)


def _farthest(kept: Callable[[float], bool], end: float) -> float | None:
    """Farthest shift towards an end up to which every one looked at is kept; None where the end itself is.

    It goes outwards in growing steps, so that no gap is jumped over that is wider than half of what lies before it, then halves.
    """
    if not kept(math.copysign(1e-12, end)):
        return 0.0
    good, step = 0.0, math.copysign(min(_FIRST, 0.01 * abs(end)), end)
    bad = step
    while kept(bad):
        if bad == end:
            return None if end > 0 else end
        good = bad
        bad = min(1.5 * bad, end) if end > 0 else max(1.5 * bad, end)
    good, _ = halved(kept, good, bad, most=_HALVINGS)
    return good if abs(good) > NOTHING else 0.0
