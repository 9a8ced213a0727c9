"""The scaled return as a nonlinear programme: pieces of polynomials by their Bernstein coefficients.

On every piece the acceleration ``q''`` is a polynomial of degree ``p`` with Bernstein coefficients ``a_0 … a_p``. Integration and
differentiation are exact and as simple as sums::

    q'_{k+1}  = q'_k + h a_k / (p + 1)          (coefficients of the ratio)
    q_{k+1}   = q_k  + h q'_k / (p + 2)         (coefficients of the position)
    j_k       = p (a_{k+1} - a_k) / h           (coefficients of the jerk)

A polynomial stays within the hull of its Bernstein coefficients, so a limit put on the coefficients holds on the whole piece; with
``p = 1`` it is exact for acceleration and jerk. Pieces join with continuous acceleration because they share coefficients.

The lengths ``h`` of the pieces are parameters (the problem is then convex: a linear or quadratic programme) or unknowns.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import casadi as ca
import numpy as np

from camwright.design.returns.bernstein import ScaledMotion, gram, inner
from camwright.design.returns.scaling import ScaledProblem
from camwright.profiles.objective import OBJECTIVES, MotionObjective
from camwright.profiles.polynomial.profile import FloatArray

Arc = Literal["free", "ramp", "hold", "fall", "cruise"]
"""What a piece is known to be: nothing, linear in the acceleration, of constant acceleration, without acceleration at its end, of constant
speed."""

# The solver answers to about 1e-10; limits drawn in by this much are kept to better than 1e-9 by whatever it returns.
LIMIT_MARGIN = 2e-10
# The least ratio is small beside the greatest, to which the solver's answers are as good as that.
REVERSAL_MARGIN = 5e-9
# Parts into which a piece of unknown length and higher degree is cut for its limits.
SPLIT = 16


@dataclass(frozen=True)
class Shape:
    """What decides the form of the programme.

    Parameters
    ----------
    arcs
        What each piece is known to be.
    degree
        Degree ``p`` of the acceleration on a piece.
    free_lengths
        Whether the lengths of the pieces are unknowns.
    objective
        What is minimised.
    confined
        Whether the position has limits.
    at_nodes
        Whether only the values at the nodes are limited, not those between: for a first try with few rows, to be checked afterwards.
    """

    arcs: tuple[Arc, ...]
    degree: int
    free_lengths: bool
    objective: MotionObjective
    confined: bool = False
    at_nodes: bool = False

    @property
    def pieces(self) -> int:
        """Number of pieces ``M``."""
        return len(self.arcs)

    @property
    def overdetermined(self) -> bool:
        """Whether arcs of the least RMS jerk leave less to choose than its ends need: no such motion, whatever the numbers."""
        p = self.degree
        known = {"free": 0, "ramp": p - 1, "hold": p, "fall": 1, "cruise": p + 1}
        return self.free_lengths and p > 1 and p * (self.pieces - 1) < sum(known[arc] for arc in self.arcs)


def _sizes(shape: Shape) -> dict[str, int]:
    """Count the unknowns of each kind."""
    m, p = shape.pieces, shape.degree
    return {
        "a": m * p + 1,
        "v": m + 1,
        "q": m + 1,
        "j": m * p if shape.objective == "rms_jerk" else 0,
        "h": m if shape.free_lengths else 0,
        "t": 1 if OBJECTIVES[shape.objective].form == "peak" else 0,
    }


def _slope_rows(shape: Shape, unknown: dict[str, Any], lengths: Any, jerk_limit: Any) -> tuple[list[Any], list[Any]]:
    """Give what must be zero of lengths and jerks, and what must not be negative of jerks and of the least peak."""
    m, p = shape.pieces, shape.degree
    equal: list[Any] = [ca.sum1(lengths) - 1] if shape.free_lengths else []
    equal += _known_arcs(shape, unknown["a"])
    if shape.free_lengths and shape.objective == "rms_jerk":
        # The least mean square has no jumps of the jerk. Where arcs meet, moving the node changes it in third order only, so without
        # these equations nodes would be all but undetermined.
        equal += [unknown["j"][i * p - 1] - unknown["j"][i * p] for i in range(1, m)]
    steps, widths = p * (unknown["a"][1:] - unknown["a"][:-1]), _in_turn([lengths] * p)
    if shape.objective == "rms_jerk":
        return [*equal, widths * unknown["j"] - steps], []
    if shape.objective == "peak_jerk":
        bound = unknown["t"] * widths
    else:  # divided by the limit: a row of size one, however high the limit
        bound, steps = widths, steps / jerk_limit
    positive = [_in_turn([bound - steps, bound + steps])]
    if shape.objective == "peak_acceleration":
        positive += [unknown["t"] - unknown["a"], unknown["t"] + unknown["a"]]
    return equal, positive


class Programme:
    """The nonlinear programme of one `Shape`, built once and solved for any numbers.

    The unknowns are, in this order: acceleration coefficients, node ratios, node positions; then, where the shape has them, jerk
    coefficients, piece lengths, and the bound that a peak objective minimises. Only this class knows that order.
    """

    def __init__(self, shape: Shape, options: dict[str, Any]) -> None:
        self.shape = shape
        m, p = shape.pieces, shape.degree
        split = SPLIT if shape.free_lengths and p > 1 and not shape.at_nodes else 1
        self._hull = split == 1 and not shape.at_nodes  # the coefficients themselves are limited
        self._sizes = _sizes(shape)
        unknown = {name: ca.SX.sym(name, size) for name, size in self._sizes.items()}
        jerk_limit, drift = (ca.SX.sym(name) for name in "Jd")
        lengths = unknown["h"] if shape.free_lengths else ca.SX.sym("h", m)
        equations, between = dynamics(unknown, lengths, p)
        equal, positive = _slope_rows(shape, unknown, lengths, jerk_limit)
        equal = [equations, *equal]
        # On a long piece the hull of a polynomial of higher degree is far too wide; halved often enough, it fits.
        bent: list[Any] = []
        paces: list[Any] = []
        if shape.at_nodes:
            between = ca.SX(0, 1)
        elif split > 1:
            bent, pieces = _finer(shape, unknown, lengths, split)
            between = ca.vertcat(*pieces)
            if shape.objective == "rms_jerk":
                paces = _finer_jerk(shape, unknown["j"], jerk_limit, split)
        places = _places(unknown, lengths, p, drift, SPLIT if shape.free_lengths else 1) if shape.confined else []
        rows = [ca.vertcat(*part) for part in (equal, positive, [between], bent, paces, places)]
        self._counts = tuple(part.numel() for part in rows)
        parameters = ca.vertcat(jerk_limit, drift)
        if not shape.free_lengths:
            parameters = ca.vertcat(parameters, lengths)
        programme = {
            "x": ca.vertcat(*(unknown[name] for name in self._sizes)),
            "p": parameters,
            "f": _cost(shape, unknown, lengths),
            "g": ca.vertcat(*rows),
        }
        self._solver = ca.nlpsol("camwright", "ipopt", programme, options)

    def solve(
        self, problem: ScaledProblem, start: ScaledMotion, relax: float = 0.0
    ) -> tuple[ScaledMotion, dict[str, Any]]:
        """Solve for the numbers of a problem from a starting motion.

        Parameters
        ----------
        problem
            Boundary values and limits.
        start
            First guess; with fixed lengths, its lengths are those of the programme.
        relax
            Share by which the limits are widened, for a first look on a coarse grid.

        Returns
        -------
        (motion, statistics)
            The solver's last point, whatever its status; its statistics (``success``, ``return_status``, ``iter_count``).
        """
        m, p = self.shape.pieces, self.shape.degree
        q, v = start.nodes()
        factor = (1.0 - LIMIT_MARGIN) * (1.0 + relax)
        slope, jerk = problem.greatest_slope * factor, problem.greatest_jerk * factor
        low, high = problem.least_ratio * factor * (1.0 - REVERSAL_MARGIN), problem.greatest_ratio * factor
        steps = p * np.diff(start.accelerations) / np.repeat(np.maximum(start.lengths, 1e-12), p)
        guess = {"a": start.accelerations, "v": v, "q": q, "j": steps, "h": start.lengths, "t": [start.objective]}
        hull = np.full(m * p + 1, slope if self._hull else np.inf)
        hull[::p] = slope  # at the nodes the coefficients are values
        lower: dict[str, Any] = {"a": -hull, "v": np.full(m + 1, low), "q": [-np.inf] * (m + 1)}
        pace = np.full(m * p, jerk if self._hull else np.inf)
        pace[::p] = pace[p - 1 :: p] = jerk
        lower |= {"j": -pace, "h": [0.0] * m, "t": [0.0]}
        upper: dict[str, Any] = {"a": hull.copy(), "v": np.full(m + 1, high), "q": [np.inf] * (m + 1)}
        upper |= {
            "j": pace.copy(),
            "h": [1.0] * m,
            "t": [jerk if self.shape.objective == "peak_jerk" else slope],
        }
        ends = {
            "a": (problem.start_slope, problem.end_slope),
            "v": (0.0, problem.end_ratio),
            "q": (0.0, problem.height),
        }
        for name, (first, last) in ends.items():
            lower[name][0] = upper[name][0] = first
            lower[name][-1] = upper[name][-1] = last
        if self.shape.at_nodes:
            self._hold_limits(lower, upper, guess)
        equal, positive, between, bent, paces, places = self._counts
        answer = self._solver(
            x0=self._pack(guess),
            p=[
                jerk,
                problem.drift,
                *([] if self.shape.free_lengths else start.lengths),
            ],
            lbx=self._pack(lower),
            ubx=self._pack(upper),
            lbg=[0.0] * (equal + positive)
            + [low] * between
            + [-slope] * bent
            + [-1.0] * paces
            + [problem.least_position] * places,
            ubg=[0.0] * equal
            + [np.inf] * positive
            + [high] * between
            + [slope] * bent
            + [1.0] * paces
            + [problem.greatest_position] * places,
        )
        found = self._unpack(np.asarray(answer["x"], dtype=np.float64).ravel())
        lengths = np.maximum(found["h"], 0.0) if self.shape.free_lengths else start.lengths
        return ScaledMotion(lengths, found["a"], float(answer["f"])), dict(self._solver.stats())

    def _hold_limits(self, lower: dict[str, Any], upper: dict[str, Any], guess: dict[str, Any]) -> None:
        """Put holds, cruises, ramps and the ends of falls on the limits that they keep to, those nearest to the guess.

        The rest of such an arc follows.
        """
        p = self.shape.degree
        for i, arc in enumerate(self.shape.arcs):
            if arc == "free":
                continue
            name, first, rest = {
                "hold": ("a", i * p, slice((i + 1) * p, (i + 1) * p + 1)),
                "fall": ("v", i + 1, slice(0)),
                "cruise": ("v", i, slice(i + 1, i + 2)),
                "ramp": ("j", i * p, slice(i * p + 1, (i + 1) * p)),
            }[arc]
            low, high = lower[name], upper[name]
            value = high[first] if guess[name][first] >= (low[first] + high[first]) / 2 else low[first]
            low[rest], high[rest] = -np.inf, np.inf
            low[first] = high[first] = value

    def _pack(self, parts: dict[str, Any]) -> FloatArray:
        return np.concatenate([np.asarray(parts[name], dtype=np.float64)[:size] for name, size in self._sizes.items()])

    def _unpack(self, flat: FloatArray) -> dict[str, FloatArray]:
        ends = np.cumsum(list(self._sizes.values()))
        return dict(zip(self._sizes, np.split(flat, ends[:-1]), strict=True))


def _in_turn(columns: list[Any]) -> Any:
    """Take the first of all columns, then the second of all, and so on."""
    return ca.vec(ca.horzcat(*columns).T)


def _by_piece(accelerations: Any, count: int, p: int) -> list[Any]:
    """Bernstein coefficients of ``q''``, each of all pieces: `p + 1` columns of shape ``(M, 1)``."""
    return [accelerations[k : k + (count - 1) * p + 1 : p] for k in range(p + 1)]


def dynamics(unknown: dict[str, Any], lengths: Any, p: int) -> tuple[Any, Any]:
    """Exact integration over the pieces: the equations at the nodes, and the ratio's coefficients inside the pieces."""
    ratio = [unknown["v"][:-1]]
    for bend in _by_piece(unknown["a"], unknown["v"].numel() - 1, p):
        ratio.append(ratio[-1] + lengths * bend / (p + 1))
    position = unknown["q"][:-1]
    for coefficient in ratio:
        position = position + lengths * coefficient / (p + 2)
    return _in_turn([ratio[-1] - unknown["v"][1:], position - unknown["q"][1:]]), _in_turn(ratio[1:-1])


def _places(unknown: dict[str, Any], lengths: Any, p: int, drift: Any, split: int) -> list[Any]:
    """Bernstein coefficients of the slave's position on each piece cut into equal parts: those of ``q`` and of the line."""
    count = unknown["v"].numel() - 1
    starts = [ca.SX(0)]
    for i in range(count - 1):
        starts.append(starts[-1] + lengths[i])
    start, bends = ca.vertcat(*starts), _by_piece(unknown["a"], count, p)
    ratio, position, rows = unknown["v"][:-1], unknown["q"][:-1], []
    for k in range(p + 3):
        rows.append(position + drift * (start + lengths * k / (p + 2)))
        position = position + lengths * ratio / (p + 2)
        if k <= p:
            ratio = ratio + lengths * bends[k] / (p + 1)
    return [ca.vec(ca.DM(inner(p + 2, split)[1:]) @ ca.horzcat(*rows).T)]


def _finer(shape: Shape, unknown: dict[str, Any], lengths: Any, split: int) -> tuple[list[Any], list[Any]]:
    """Bernstein coefficients of acceleration and ratio on each piece cut into equal parts, but for those that nodes bound.

    Holds and cruises have no others, ramps none of the acceleration.
    """
    p, bent, between = shape.degree, [], []
    for i, arc in enumerate(shape.arcs):
        if arc in ("hold", "cruise"):
            continue
        row = unknown["a"][i * p : (i + 1) * p + 1]
        ratio = [unknown["v"][i]]
        for k in range(p + 1):
            ratio.append(ratio[-1] + lengths[i] * row[k] / (p + 1))
        between += ca.vertsplit(ca.DM(inner(p + 1, split)[1:-1]) @ ca.vertcat(*ratio))
        if arc != "ramp":
            bent += ca.vertsplit(ca.DM(inner(p, split)[1:-1]) @ row)
    return bent, between


def _finer_jerk(shape: Shape, jerk: Any, limit: Any, split: int) -> list[Any]:
    """Bernstein coefficients of the jerk on each piece cut into equal parts, as shares of the limit; one where it is constant."""
    p, paces = shape.degree, []
    for i, arc in enumerate(shape.arcs):
        row = jerk[i * p : (i + 1) * p] / limit
        if arc == "ramp":
            paces.append(row[0])
        elif arc not in ("hold", "cruise"):
            paces += ca.vertsplit(ca.DM(inner(p - 1, split)) @ row)
    return paces


def _known_arcs(shape: Shape, a: Any) -> list[Any]:
    """Equations that make ramps linear, holds constant, and falls end and cruises run without acceleration."""
    p, equations = shape.degree, []
    for i, arc in enumerate(shape.arcs):
        row = [a[i * p + k] for k in range(p + 1)]
        if arc == "ramp":
            equations += [row[k] - 2 * row[k + 1] + row[k + 2] for k in range(p - 1)]
        elif arc == "hold":
            equations += [row[k + 1] - row[k] for k in range(p)]
        elif arc == "fall":
            equations.append(row[p])
        elif arc == "cruise":
            after_cruise = i > 0 and shape.arcs[i - 1] == "cruise"
            equations += row[1:] if after_cruise else row
    return equations


def _cost(shape: Shape, unknown: dict[str, Any], lengths: Any) -> Any:
    """Objective: the bound of a peak, or the mean square by the Gram matrix of the Bernstein polynomials."""
    if OBJECTIVES[shape.objective].form == "peak":
        return unknown["t"]
    p, cost = shape.degree, ca.SX(0)
    kind, degree = ("a", p) if shape.objective == "rms_acceleration" else ("j", p - 1)
    for i in range(shape.pieces):
        part = unknown[kind][i * p : i * p + degree + 1]
        cost += lengths[i] * ca.bilin(ca.DM(gram(degree)), part, part)
    return cost
