"""The machines: one module each, saying what "in sync" means in the slave's own coordinate."""

from profiles.machines.rotary_knife import RotaryKnife

__all__ = ["RotaryKnife"]
