"""Validation: judges any profile against limits, discrete servo and minimum cut lengths."""

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
