"""Tables of position, ratio and curvature whose sum with powers of the line speed keeps the axis in sync at every line speed.

Of what a loop makes of a slow command only its transfer function near zero matters: ``axis = D/N command`` with polynomials in ``s``, which
over the master is ``v d/dx``. A command ``N b`` of any smooth curve ``b`` therefore takes the axis along ``D b``; where ``b`` is straight
that is ``b`` but for an offset ``d1 k v``, which is taken off. ``N b`` is ``b + n1 v b' + n2 v² b'' + …``: a table for each power of the
speed.
"""

from __future__ import annotations

import math

import numpy as np

from camwright.profiles.polynomial.profile import CamProfile, FloatArray, join
from camwright.profiles.servo import Servo, closed_loop, sample_plant
from camwright.profiles.speed_cam import SpeedCam
from camwright.profiles.task import Task

# The curve has so many derivatives without a jump more than there are tables beside the position: then the command's jerk is bounded.
SMOOTHER = 2
# Share of the room to the limit of the ratio that a smooth return may take, for the command and the axis go beyond it, and the shortest and
# longest part of the return in which its ratio changes.
_ROOM, _SHORTEST, _LONGEST = 0.85, 0.15, 0.5
# Points on the circle about zero from which a series is taken, its radius as a share of the distance of the nearest pole, and times in a
# sample over which the axis is averaged.
_CIRCLE, _INSIDE, _TIMES = 64, 0.3, 8


def response_series(servo: Servo, order: int) -> FloatArray:
    """Expand the axis over the command, mean over the sampling period, in powers of ``s``: ``axis = sum a[n] d^n command / dt^n``.

    Parameters
    ----------
    servo
        A stable servo, dead time and lead included.
    order
        Highest power.

    Returns
    -------
    ndarray
        Shape ``(order + 1,)``, in s^n; the first is 1.
    """
    transition, inputs = closed_loop(servo)
    step, drive = servo.sample_time, np.array(servo.drive)
    poles = np.linalg.eigvals(transition)
    radius = _INSIDE * float(np.abs(np.log(poles[np.abs(poles) > 1e-9])).min()) / step
    nodes, weights = np.polynomial.legendre.leggauss(_TIMES)
    plants = [sample_plant(servo, float(time)) for time in (nodes + 1.0) / 2 * step]
    values = []
    for s in radius * np.exp(2j * math.pi * np.arange(_CIRCLE) / _CIRCLE):
        z = np.exp(s * step)
        command = z ** -np.arange(len(drive), dtype=np.float64)
        state = np.linalg.solve(z * np.eye(3) - transition, inputs @ command)
        held = drive @ command - servo.position_gain * state[2]
        later = [
            np.exp(-s * (node + 1.0) / 2 * step) * (plant.transition[2] @ state + plant.input[2] * held)
            for node, plant in zip(nodes, plants, strict=True)
        ]
        values.append(np.exp(-s * servo.delay) * (weights / 2 @ np.array(later)))
    powers = radius ** np.arange(order + 1, dtype=np.float64)
    found: FloatArray = (np.fft.fft(np.array(values))[: order + 1].real / _CIRCLE) / powers
    return found


def rational(series: FloatArray, order: int) -> tuple[FloatArray, FloatArray]:
    """Give ``D`` and ``N`` of one order, first coefficients 1, whose quotient has a series up to twice that order (Padé).

    Parameters
    ----------
    series
        Shape ``(2 order + 1,)`` at least.
    order
        Of both polynomials.
    """
    wanted = range(order + 1, 2 * order + 1)
    unit = max(float(np.abs(series[n])) ** (1.0 / n) for n in range(1, 2 * order + 1)) or 1.0
    scaled = series[: 2 * order + 1] / unit ** np.arange(2 * order + 1)
    matrix = np.array([[scaled[i - j] for j in range(1, order + 1)] for i in wanted])
    tail = np.linalg.lstsq(matrix, -scaled[list(wanted)], rcond=None)[0]
    top = np.concatenate([[1.0], tail])
    bottom = np.array([top[: i + 1] @ scaled[i::-1] for i in range(order + 1)])
    powers = unit ** np.arange(order + 1)
    return bottom * powers, top * powers


def smooth_cycle(task: Task, smooth: int) -> CamProfile:
    """Give a cycle with so many derivatives that have no jump where the straight sync zone ends and begins, from the start of the return.

    The ratio goes smoothly to another one, holds it, and comes back; the changes are as long as the limits of the ratio allow.
    """
    width, ratio = task.cut.return_zone, float(task.sync(0.0, 1))
    beyond = task.height / width - ratio  # what the mean ratio lacks
    room = task.greatest_ratio - ratio if beyond > 0.0 else ratio - task.least_ratio
    part = min(max(1.0 - abs(beyond) / (_ROOM * room), _SHORTEST), _LONGEST) if room > 0.0 else _SHORTEST
    change, level = part * width, beyond / (1.0 - part)
    count = smooth - 1
    rise = np.zeros(2 * count + 2)  # the polynomial from 0 to 1 that is flat at both ends
    for k in range(count + 1):
        rise[count + 1 + k] = (-1) ** k * math.comb(count + k, k) * math.comb(2 * count + 1, count - k)
    rise = level * rise / change ** np.arange(len(rise), dtype=np.float64)
    up, hold, down = rise.copy(), np.zeros_like(rise), -rise
    up[0], hold[0], down[0] = ratio, ratio + level, ratio + level
    breaks, pieces = [0.0, change, width - change, width], [up, hold, down]
    if width - 2 * change <= 1e-9 * width:
        breaks, pieces = [0.0, change, width], [up, down]
    sync = CamProfile.from_arrays([width, task.cut.length], [[task.height, ratio]])
    return join(CamProfile.from_arrays(breaks, pieces).integral(), sync).over(0.0, task.cut.length)


def speed_cam(task: Task, servo: Servo, order: int) -> SpeedCam:
    """Make the tables of a machine whose sync zone is straight.

    Parameters
    ----------
    task
        The machine, the cut, its limits, which are not looked at here.
    servo
        A stable servo, as it is.
    order
        Tables beside the position: highest power of the line speed.

    Returns
    -------
    SpeedCam
        Tables over ``[0, x_c]``, counted like the cycle of the job.
    """
    bottom, top = rational(response_series(servo, 2 * order), order)
    curve = smooth_cycle(task, order + SMOOTHER)
    tables = [curve, *(curve.derivative(n).scale(slave=float(top[n])) for n in range(1, order + 1))]
    tables[1] = tables[1].shift(slave=-float(bottom[1]) * float(task.sync(0.0, 1)))
    if task.cut.origin == "cut":
        tables = [_from_mid_sync(table, task, advances=not n) for n, table in enumerate(tables)]
    return SpeedCam(tuple(tables))


def _from_mid_sync(table: CamProfile, task: Task, *, advances: bool) -> CamProfile:
    """Count the master from mid sync zone, and the position from where the machine is in sync there."""
    at = task.cut.length - 0.5 * task.cut.sync_zone
    rolled = table.roll(at)
    return rolled if advances else rolled.shift(slave=float(table(at)))
