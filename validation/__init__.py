"""Validation: judges any profile against limits, discrete servo and minimum cut lengths."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from validation.checks import Check
    from validation.minimum_length import (
        MinimumCutLength,
        cut_length_eq9,
        cut_length_eq10,
        linear_return_to_tolerance,
        optimised_to_tolerance,
        physical,
        required_sync_zone,
    )
    from validation.motion import Motion, measure_motion, measure_tool
    from validation.motor import MotorMeasures, measure_motor, motor_torque
    from validation.report import ValidationReport, validate
    from validation.response import ServoResponse, measure_response, servo_response
    from validation.simulation import ServoRun, simulate, steady_following_error
    from validation.sweep import Sweep, SweepCase, servo_sweep

__all__ = [
    "Check",
    "MinimumCutLength",
    "Motion",
    "MotorMeasures",
    "ServoResponse",
    "ServoRun",
    "Sweep",
    "SweepCase",
    "ValidationReport",
    "cut_length_eq9",
    "cut_length_eq10",
    "linear_return_to_tolerance",
    "measure_motion",
    "measure_motor",
    "measure_response",
    "measure_tool",
    "motor_torque",
    "optimised_to_tolerance",
    "physical",
    "required_sync_zone",
    "servo_response",
    "servo_sweep",
    "simulate",
    "steady_following_error",
    "validate",
]

_HOMES = {
    "Check": "checks",
    "MinimumCutLength": "minimum_length",
    "cut_length_eq9": "minimum_length",
    "cut_length_eq10": "minimum_length",
    "linear_return_to_tolerance": "minimum_length",
    "optimised_to_tolerance": "minimum_length",
    "physical": "minimum_length",
    "required_sync_zone": "minimum_length",
    "Motion": "motion",
    "measure_motion": "motion",
    "measure_tool": "motion",
    "MotorMeasures": "motor",
    "measure_motor": "motor",
    "motor_torque": "motor",
    "ValidationReport": "report",
    "validate": "report",
    "ServoResponse": "response",
    "measure_response": "response",
    "servo_response": "response",
    "ServoRun": "simulation",
    "simulate": "simulation",
    "steady_following_error": "simulation",
    "Sweep": "sweep",
    "SweepCase": "sweep",
    "servo_sweep": "sweep",
}


def __getattr__(name: str) -> Any:
    """Import what is asked for when it is asked for: what judges one thing must not wait for all the others."""
    from importlib import import_module

    if name not in _HOMES:
        raise AttributeError(f"module 'validation' has no attribute {name!r}")
    return getattr(import_module(f"validation.{_HOMES[name]}"), name)
