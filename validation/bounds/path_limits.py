"""Lower bound of the squared torque where the time is short and the acceleration limited: a convex programme over the path, by its dual.

With ``w = u²`` the kinetic energy is ``E = I w / 2``, the torque ``E'`` and the acceleration ``w' / 2``, both linear in ``w``. The
integrals ``∫ E'² / √w dq`` of the squared torque and ``∫ dq / √w`` of the time are convex. So for any price ``μ >= 0`` of the time and
any functions ``p`` and ``m`` of the place ::

    [p E + m w] + ∫ [ min over w of (-(p' I/2 + m') w - p² √w / 4 + μ / √w) - 2 A |m| ] dq - μ T

with the greatest acceleration ``A`` is no greater than the integral of any motion that never turns and takes the time ``T`` or less. A cone
programme on a grid tells good ones; ``p`` and ``m`` are broken lines between its cells, the inner minimum is found point by point.
"""

from __future__ import annotations

import numpy as np

from camwright.profiles.polynomial.profile import FloatArray
from camwright.validation.bounds.path_task import PathTask

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(3)

CELLS = 200
HALVINGS = 60
ACCURACY = 1e-6
"""Accuracy of the cone programme: its multipliers bound whatever they are."""


def least_square_limited(task: PathTask) -> float:
    """Lower bound of the integral of the squared torque over time, (N·m)² s; zero where the programme has no answer."""
    if not np.isfinite(task.acceleration):
        return 0.0
    # way and time are one, the inertia is counted in its mean
    unit, mean = task.way / task.time, float(task.inertia.mean())
    scaled = PathTask(
        task.inertia / mean,
        1.0,
        (task.speeds[0] / unit, task.speeds[1] / unit),
        1.0,
        task.greatest / unit,
        task.acceleration * task.way / unit**2,
    )
    found = _multipliers(scaled)
    if found is None:
        return 0.0
    return max(0.0, _dual(scaled, *found)) * mean**2 * unit**4 / task.way**2 * task.time


def _inertia(task: PathTask, x: FloatArray) -> FloatArray:
    return np.interp(x, np.linspace(0.0, 1.0, len(task.inertia)), task.inertia)


def _multipliers(task: PathTask) -> tuple[FloatArray, FloatArray, float] | None:
    """Give ``p`` and ``m`` of the cells, and the price of time; None where the solver finds none."""
    import clarabel
    from scipy.sparse import csc_array, diags_array, hstack, vstack

    n, h = CELLS, 1.0 / CELLS
    one = diags_array(np.ones(n), shape=(n, n + 1))
    rise = diags_array([-np.ones(n), np.ones(n)], offsets=[0, 1], shape=(n, n + 1))
    inertia = _inertia(task, np.linspace(0.0, 1.0, n + 1))
    force = rise @ diags_array(inertia) / (2 * h)
    none, node_none, same = csc_array((n, n)), csc_array((n, n + 1)), diags_array(np.ones(n))
    # unknowns: w at the nodes; √w, squared torque over it and time in the cells
    top = task.greatest**2
    linear = [
        hstack([csc_array(([1.0, 1.0], ([0, 1], [0, n])), shape=(2, n + 1)), csc_array((2, 3 * n))]),
        hstack([csc_array((1, 3 * n + 1)), csc_array(np.full((1, n), h))]),
        hstack([rise, none, none, none]),
        hstack([-rise, none, none, none]),
        hstack([diags_array(np.ones(n + 1)), csc_array((n + 1, 3 * n))]),
    ]
    rows = [task.speeds[0] ** 2, task.speeds[1] ** 2, 1.0]
    right = np.concatenate([rows, np.full(2 * n, 2 * task.acceleration * h), np.full(n + 1, top)])
    mean = 0.5 * (one + diags_array([np.ones(n)], offsets=[1], shape=(n, n + 1)))
    # |(2 x, y - z)| <= y + z is x² <= y z, with (x, y, z) = (√w, w, 1), (torque, its square over √w, √w), (1, time, √w)
    roots = [
        (
            hstack([-mean, none, none, none]),
            1.0,
            hstack([-mean, none, none, none]),
            -1.0,
            hstack([node_none, -2 * same, none, none]),
            0.0,
        ),
        (
            hstack([node_none, -same, -same, none]),
            0.0,
            hstack([node_none, same, -same, none]),
            0.0,
            hstack([-2 * force, none, none, none]),
            0.0,
        ),
        (
            hstack([node_none, -same, none, -same]),
            0.0,
            hstack([node_none, same, none, -same]),
            0.0,
            csc_array((n, 4 * n + 1)),
            2.0,
        ),
    ]
    order = np.arange(3 * n).reshape(3, n).T.ravel()
    cones = [clarabel.ZeroConeT(2), clarabel.NonnegativeConeT(3 * n + 2)]
    blocks, sides = [vstack(linear)], [right]
    for first, of_first, second, of_second, third, of_third in roots:
        blocks.append(csc_array(vstack([first, second, third]))[order])
        sides.append(np.tile([of_first, of_second, of_third], n))
        cones += [clarabel.SecondOrderConeT(3)] * n
    goal = np.concatenate([np.zeros(2 * n + 1), np.full(n, h), np.zeros(n)])
    settings = clarabel.DefaultSettings()
    settings.verbose = settings.presolve_enable = settings.iterative_refinement_enable = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = ACCURACY
    size = 4 * n + 1
    answer = clarabel.DefaultSolver(
        csc_array((size, size)), goal, csc_array(vstack(blocks)), np.concatenate(sides), cones, settings
    ).solve()
    x, z = np.asarray(answer.x), np.asarray(answer.z)
    if not (np.isfinite(x).all() and np.isfinite(z).all()):
        return None
    root = np.maximum(x[n + 1 : 2 * n + 1], 1e-9)
    return 2 * (force @ x[: n + 1]) / root, z[3 : n + 3] - z[n + 3 : 2 * n + 3], max(float(z[2]), 0.0)


def _dual(task: PathTask, p: FloatArray, m: FloatArray, price: float) -> float:
    """Give the dual function for broken lines between the cells."""
    n = len(p)
    x = np.concatenate([[0.0], (np.arange(n) + 0.5) / n, [1.0]])
    p, m = (np.concatenate([[1.5 * f[0] - 0.5 * f[1]], f, [1.5 * f[-1] - 0.5 * f[-2]]]) for f in (p, m))
    width = np.diff(x)
    share = 0.5 + 0.5 * _NODES[:, None]
    inertia = _inertia(task, x[:-1] + share * width)
    here = p[:-1] + share * np.diff(p)
    slope = -(np.diff(p) / width * inertia / 2 + np.diff(m) / width)
    drag = here**2 / 4
    low, high = np.zeros_like(slope), np.full_like(slope, task.greatest)
    for _ in range(HALVINGS):
        u = 0.5 * (low + high)
        rising = 2 * slope * u**3 - drag * u**2 - price > 0
        low, high = np.where(rising, low, u), np.where(rising, u, high)
    least = slope * high**2 - drag * high + price / high
    ends = _inertia(task, np.array([0.0, 1.0])) * np.array(task.speeds) ** 2 / 2
    first, last = (speed**2 for speed in task.speeds)
    meet = p[-1] * ends[1] - p[0] * ends[0] + m[-1] * last - m[0] * first
    whole = float((0.5 * _WEIGHTS @ least) @ width)
    return float(meet + whole - 2 * task.acceleration * np.trapezoid(np.abs(m), x) - price)
