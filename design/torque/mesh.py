"""Meshes of torque programmes: where a motion changes, the mesh is fine."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from camwright.design.torque.programme import Guess
from camwright.design.torque.task import ROOTS, Aim, Pattern
from camwright.profiles.polynomial.profile import FloatArray

# Shares of a mesh that go by time, by way, by the change of the acceleration and by how it bends. An acceleration that is straight between
# nodes is off by its bend times the square of an interval, so half of a mesh goes by the root of that: on cranks 120 intervals then do what
# took 675 that went by its change. A peak is the same all along, and wants its intervals wherever the acceleration changes.
ROOT_SHARES, SHARES = (0.3, 0.1, 0.1, 0.5), (0.4, 0.2, 0.4, 0.0)
# Shortest interval, as a share of the phase over the number of intervals: a jump of the acceleration takes a few of these.
SHORTEST = 1e-5


def spread(nodes: FloatArray, density: FloatArray, count: int) -> FloatArray:
    """Lengths of intervals that share a density evenly.

    Parameters
    ----------
    nodes, density
        A mesh from 0 to 1 and the density, not negative, on each of its intervals.
    count
        Number of intervals wanted.
    """
    total = np.concatenate([[0.0], np.cumsum(density * np.diff(nodes))])
    lengths = np.diff(np.interp(np.linspace(0.0, 1.0, count + 1), total / total[-1], nodes))
    lengths = np.maximum(lengths, SHORTEST / count)
    return np.asarray(lengths / lengths.sum())


def density(nodes: FloatArray, way: FloatArray, acceleration: FloatArray, aim: Aim) -> FloatArray:
    """Density of a mesh for a motion given at the nodes of another, and what is minimised."""
    step = np.maximum(np.diff(nodes), 1e-300)
    by_time, *others = ROOT_SHARES if aim in ROOTS else SHARES
    found = np.full(len(step), by_time)
    bent = np.abs(np.diff(np.diff(acceleration) / step)) / (step[1:] + step[:-1])
    bends = np.sqrt(np.append(0.0, bent) + np.append(bent, 0.0)) * step
    changes = np.abs(np.diff(way)), np.abs(np.diff(acceleration)), bends
    for change, share in zip(changes, others, strict=True):
        found += share * change / max(float(change.sum()), 1e-300) / step
    padded = np.concatenate([found[:1], found, found[-1:]])
    return np.asarray(0.25 * padded[:-2] + 0.5 * padded[1:-1] + 0.25 * padded[2:])


def remesh(guess: Guess, pattern: Pattern, counts: tuple[int, ...], aim: Aim) -> Guess:
    """Put a motion on a mesh of its own with other numbers of intervals, laid for an aim; between nodes it stays what it is."""
    meshes, parts, node = [], [], 0
    moving = [length for phase, length in zip(pattern, guess.lengths, strict=True) if phase != "rest"]
    for mesh, length, count in zip(guess.mesh, moving, counts, strict=True):
        rows = slice(node, node + len(mesh) + 1)
        a, v, q = guess.acceleration[rows], guess.velocity[rows], guess.position[rows]
        nodes = np.concatenate([[0.0], np.cumsum(mesh)])
        nodes[-1] = 1.0
        wanted = spread(nodes, density(nodes, q, a, aim), count)
        at = np.concatenate([[0.0], np.cumsum(wanted)])
        at[-1] = 1.0
        i = np.clip(np.searchsorted(nodes, at, side="right") - 1, 0, len(mesh) - 1)
        d, jerk = (at - nodes[i]) * length, np.diff(a) / (mesh * length)
        here = (
            a[i] + jerk[i] * d,
            v[i] + d * (a[i] + jerk[i] * d / 2),
            q[i] + d * (v[i] + d * (a[i] / 2 + jerk[i] * d / 6)),
        )
        first = 0 if node == 0 else 1
        meshes.append(wanted)
        parts.append([part[first:] for part in here])
        node += len(mesh)
    a, v, q = (np.concatenate([part[k] for part in parts]) for k in range(3))
    return Guess(tuple(meshes), guess.lengths, a, v, q, guess.ends)


def divide(guess: Guess, pattern: Pattern, chosen: NDArray[np.bool_]) -> Guess:
    """Divide some intervals of a motion, which stays what it is, in three; ``chosen`` is true for those, phases one after the other."""
    meshes, first = [], 0
    for mesh in guess.mesh:
        split = chosen[first : first + len(mesh)]
        meshes.append(np.repeat(np.where(split, mesh / 3, mesh), np.where(split, 3, 1)))
        first += len(mesh)
    at = np.nonzero(chosen)[0]
    inner = states_within(guess, pattern, np.array([1.0, 2.0]) / 3)
    a, v, q = (
        np.insert(part, np.repeat(at + 1, 2), new[at].ravel())
        for part, new in zip((guess.acceleration, guess.velocity, guess.position), inner, strict=True)
    )
    return Guess(tuple(meshes), guess.lengths, a, v, q, guess.ends)


def states_within(guess: Guess, pattern: Pattern, shares: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Acceleration, velocity and position at shares of every interval, a row for each interval."""
    a, v, q = (part[:-1, None] for part in (guess.acceleration, guess.velocity, guess.position))
    rise = np.diff(guess.acceleration)[:, None]
    d = widths(guess, pattern)[:, None] * shares
    return (
        a + rise * shares,
        v + d * (a + rise * shares / 2),
        q + d * (v + d * (a / 2 + rise * shares / 6)),
    )


def paces(guess: Guess, pattern: Pattern, times: FloatArray) -> FloatArray:
    """Velocities at times, as shares of the return; straight lines between the nodes."""
    nodes, velocity, at, node = [np.zeros(1)], [guess.velocity[:1]], 0.0, 0
    meshes = iter(guess.mesh)
    for phase, length in zip(pattern, guess.lengths, strict=True):
        mesh = np.ones(1) if phase == "rest" else next(meshes)
        nodes.append(at + length * np.cumsum(mesh))
        velocity.append(np.zeros(1) if phase == "rest" else guess.velocity[node + 1 : node + len(mesh) + 1])
        node += 0 if phase == "rest" else len(mesh)
        at += float(length)
    return np.interp(times, np.concatenate(nodes), np.concatenate(velocity))


def widths(guess: Guess, pattern: Pattern) -> FloatArray:
    """Lengths of all intervals as shares of the return; phases without motion have none."""
    moving = [length for phase, length in zip(pattern, guess.lengths, strict=True) if phase != "rest"]
    return np.concatenate([mesh * length for mesh, length in zip(guess.mesh, moving, strict=True)])
