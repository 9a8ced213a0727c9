"""The number formats of controllers: what a value becomes in one, and how it is written."""

from __future__ import annotations

from typing import Literal

import numpy as np

from camwright.profiles.polynomial.profile import FloatArray

NumberFormat = Literal["float64", "float32", "int32"]

_VANISHING = 1e-30  # below this a value of a cam is rounding, and its plain decimals would fill lines


def rounded(values: FloatArray, number_format: NumberFormat) -> FloatArray:
    """Round values to a number format; carried on as float64."""
    if number_format == "float32":
        return np.asarray(np.float32(values), dtype=np.float64)
    if number_format == "int32":
        return np.asarray(np.rint(values), dtype=np.float64)
    return np.array(values, dtype=np.float64)


def decimals(value: float, number_format: NumberFormat = "float64") -> str:
    """Write the shortest plain decimals, without an exponent, that are read back as the same number of the format."""
    if number_format == "int32":
        return str(round(value))
    if abs(value) < _VANISHING:
        return "0.0"
    number = np.float32(value) if number_format == "float32" else np.float64(value)
    return np.format_float_positional(number, unique=True, trim="0")


def literal(value: float, number_format: NumberFormat = "float64") -> str:
    """Write a real literal of IEC 61131-3: with a decimal point always, with an exponent if small or large."""
    if abs(value) < _VANISHING:
        return "0.0"
    if 1e-4 <= abs(value) < 1e15:
        return decimals(value, number_format)
    number = np.float32(value) if number_format == "float32" else np.float64(value)
    return np.format_float_scientific(number, unique=True, trim="0", exp_digits=2).replace("e", "E")
