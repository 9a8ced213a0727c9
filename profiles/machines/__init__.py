"""The machines: one module each, saying what "in sync" means in the slave's own coordinate, and their inertia."""

from profiles.machines.crank_slider import CrankSlider
from profiles.machines.linear_carriage import LinearCarriage
from profiles.machines.machine import Machine
from profiles.machines.rotary_knife import RotaryKnife

__all__ = ["CrankSlider", "LinearCarriage", "Machine", "RotaryKnife"]
