"""The least RMS torque of a slave that rubs and has time to stand: of a short return in which it stands, which then stands for longer."""

from __future__ import annotations

import math
from dataclasses import replace

from camwright.design.returns.possible import is_possible
from camwright.design.returns.solver import solve_return
from camwright.design.torque.finish import with_longer_rest
from camwright.design.torque.search import TorqueSolution, solve_torque
from camwright.design.torque.task import TorqueTask
from camwright.profiles.errors import SolverError

SHORT = 4.0
"""Time of the short return in those of its moves, as no limit knows them: it stands for most of it, and its meshes still see the moves."""
LONGER = 2.0
"""Multiple by which it is made longer until limits allow it."""


def standing(task: TorqueTask) -> TorqueSolution | None:
    """Find the return of least RMS torque of a slave of constant inertia that stands for most of it.

    At rest friction asks for no torque, so how long it stands changes nothing in how it moves. Without limits it coasts to rest in
    ``I v / f`` and then goes its way ``s`` in ``sqrt(6 I s / f)``, where what friction takes is three quarters of the whole. On a slow line
    that is next to nothing of the return, and no mesh over all of it finds these moves.

    Returns
    -------
    TorqueSolution or None
        None where the return is too short to stand for most of it, or none was found that stands.
    """
    problem, machine, v = task.problem, task.machine, task.cut.line_speed
    mobility = float(machine.inertia(task.start)) / machine.friction
    moves = mobility * v * max(problem.start_ratio, problem.end_ratio) + math.sqrt(6 * mobility * abs(problem.height))
    short = replace(task, problem=replace(problem, length=SHORT * v * moves))
    while short.problem.length < problem.length and not is_possible(short.problem):
        short = replace(task, problem=replace(problem, length=LONGER * short.problem.length))
    if short.problem.length >= problem.length:
        return None
    try:
        start = solve_return(replace(short.problem, objective="rms_acceleration"))[0]
        found = solve_torque(short, starts=[start])
    except SolverError:
        return None
    back = with_longer_rest(found.back, problem.length)
    if back is None:
        return None
    return replace(found, back=back, value=found.value * math.sqrt(short.problem.length / problem.length))
