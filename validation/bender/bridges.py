"""Bridges judged on the program that was written: they are where they belong, and far enough from every bend."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camwright.profiles.bender.bridges import Bridge, BridgeRule, bridge_places
from camwright.profiles.bender.program import NcProgram


@dataclass(frozen=True)
class BridgeProof:
    """What a program makes of the bridges.

    Parameters
    ----------
    gap
        Least distance of an edge from a bend, an end of the rule or another bridge (m).
    shift
        Greatest distance of a cut's middle from where its bridge belongs (m).
    """

    gap: float
    shift: float


def prove_bridges(program: NcProgram, bridges: tuple[Bridge, ...], rule: BridgeRule) -> BridgeProof | None:
    """Measure the bridges of a program as read back; ``None`` if there are none.

    The machine's cuts count where the program makes them; bridges that are cut by hand where they are measured from the
    bends of the program.

    Raises
    ------
    ValueError
        The program has another number of cuts than bridges.
    """
    if not bridges:
        return None
    by_machine = rule.command is not None
    if by_machine and len(program.cuts) != len(bridges):
        raise ValueError(f"{program.name}: {len(program.cuts)} cuts for {len(bridges)} bridges")
    middles = 1e-6 * (program.cuts if by_machine else bridge_places(program, bridges))
    middles = middles + (rule.tool_distance if by_machine else 0.0)
    begins = np.concatenate([[0.0], 1e-6 * np.cumsum(program.feeds)])
    half = 0.5 * rule.width
    gaps = [np.abs(middles[:, None] - begins[None, k : k + 2000]).min() for k in range(0, len(begins), 2000)]
    gap = float(min(gaps)) - half
    if len(middles) > 1:
        gap = min(gap, float(np.diff(middles).min()) - rule.width)
    wanted = np.array([begins[bridge.side] + bridge.from_bend for bridge in bridges])
    return BridgeProof(gap, float(np.abs(middles - wanted).max()))
