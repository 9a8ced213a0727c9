"""Programmes made of pieces: their derivatives are those of the whole programme, by CasADi's own road."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from camwright.design.returns.problem import return_problem
from camwright.design.torque.layout import Layout
from camwright.design.torque.numbers import TorqueForm
from camwright.design.torque.parts import lay
from camwright.design.torque.pieces import Laid, ProgrammePiece, programme
from camwright.design.torque.task import Aim, Pattern, TorqueTask
from camwright.profiles.cut import Cut
from camwright.profiles.limits import Limits
from camwright.profiles.line import Line
from camwright.profiles.machines import CrankSlider, RotaryKnife
from camwright.profiles.motor import MotorCurve
from camwright.profiles.task import Task

CURVE = MotorCurve(((0.0, 20.0), (100.0, 20.0), (400.0, 5.0)))
CRANK = CrankSlider(crank=0.15, rod=0.6, crank_inertia=0.6, carriage_mass=60.0, sync_at=1.75)
SHEAR = Task(CRANK, Cut(0.9, 0.5, 0.15, 0.04, 0.08, 2.5e-4), Limits(30.0, 400.0, 20_000.0, reversal=False))
KNIFE = Task(
    RotaryKnife(circumference=0.4, drum_inertia=0.02, drum_friction=1.0),
    Cut(0.6, 1.2, 0.2, 0.04, 0.16, 1e-4),
    Limits(4.0, 60.0, 6000.0),
)


def _same_derivatives(laid: list[Laid], unknowns: int, parameters: int) -> None:
    nlp, derivatives = programme(laid, unknowns, parameters)
    rng = np.random.default_rng(3)
    x, p = rng.uniform(0.5, 1.5, unknowns), rng.uniform(0.5, 1.5, parameters)
    rows = nlp["g"].numel()
    of_cost, of_rows = ca.MX.sym("f"), ca.MX.sym("g", rows)
    multipliers = rng.normal(size=rows)
    curve, slope = ca.hessian(of_cost * nlp["f"] + ca.dot(of_rows, nlp["g"]), nlp["x"])
    own = ca.Function("own", [nlp["x"], nlp["p"], of_cost, of_rows], [nlp["f"], nlp["g"], slope, curve])
    jacobian = ca.Function("bend", [nlp["x"], nlp["p"]], [ca.jacobian(nlp["g"], nlp["x"])])
    f, g, slope, curve = own(x, p, 0.7, multipliers)
    value, gradient = derivatives["grad_f"](x, p)
    values, bend = derivatives["jac_g"](x, p)
    assert float(value) == pytest.approx(float(f), rel=1e-12)
    assert np.allclose(values, g, rtol=1e-12, atol=1e-12)
    assert np.allclose(bend, jacobian(x, p), rtol=1e-9, atol=1e-9)
    assert np.allclose(0.7 * np.array(gradient) + np.array(bend).T @ multipliers[:, None], slope, rtol=1e-9, atol=1e-7)
    scale = np.abs(np.array(curve)).max()
    assert np.allclose(derivatives["hess_lag"](x, p, 0.7, multipliers), np.triu(curve), rtol=1e-9, atol=1e-12 * scale)


def test_a_programme_of_one_piece_at_places_that_share_unknowns() -> None:
    x, y, w = (ca.SX.sym(name) for name in ("x", "y", "w"))
    piece = ProgrammePiece(ca.vertcat(x, y), w, w * (y - x) ** 4, x * y - w, ca.sin(x) + y)
    nodes = np.arange(4)
    _same_derivatives([Laid(piece, np.stack([nodes, nodes + 1]), nodes[None, :])], 5, 4)


@pytest.mark.parametrize("aim", ["rms_torque", "peak_torque", "energy", "load", "peak_jerk"])
@pytest.mark.parametrize(
    ("task", "pattern", "placed"),
    [(SHEAR, ("any",), True), (KNIFE, ("forth", "rest", "forth"), False)],
)
def test_pieces_of_a_torque_have_the_derivatives_of_the_whole(
    task: Task, pattern: Pattern, placed: bool, aim: Aim
) -> None:
    line = task.line if placed else Line(acceleration=0.3, stop=0.5)
    asked = TorqueTask(task.with_line(line), return_problem(task, "peak_acceleration"), aim, CURVE)
    layout = Layout(pattern, (2,) * (1 if placed else 2), 2 if placed else 0, TorqueForm.of(asked))
    _same_derivatives(lay(layout), sum(layout.sizes), layout.given[-1].stop)
