"""The machines: one module each, saying what "in sync" means in the slave's own coordinate, and their inertia."""

from camwright.profiles.machines.crank_slider import CrankSlider
from camwright.profiles.machines.linear_carriage import LinearCarriage
from camwright.profiles.machines.machine import Machine
from camwright.profiles.machines.rotary_knife import RotaryKnife

__all__ = ["CrankSlider", "LinearCarriage", "Machine", "RotaryKnife"]
