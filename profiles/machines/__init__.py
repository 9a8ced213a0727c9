"""The machines: one module each, saying what "in sync" means in the slave's own coordinate, and all else that is special about it."""

from camwright.profiles.machines.crank_slider import CrankSlider
from camwright.profiles.machines.linear_carriage import LinearCarriage
from camwright.profiles.machines.machine import Machine
from camwright.profiles.machines.rotary_knife import RotaryKnife

MACHINES: dict[str, type[Machine]] = {machine.kind: machine for machine in (RotaryKnife, LinearCarriage, CrankSlider)}
"""The machines by kind: what job files, schemas, recipes and figures know. A new machine is one more in this row."""

__all__ = ["MACHINES", "CrankSlider", "LinearCarriage", "Machine", "RotaryKnife"]
