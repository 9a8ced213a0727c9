"""Bends an NC program on paper and judges it."""
