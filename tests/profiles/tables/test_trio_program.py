"""Programs of Trio controllers that compute their tables: expressions and loops against Python's own, and what is refused."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camwright.profiles.errors import InputError
from camwright.profiles.tables.targets import TARGETS, detect, read_table
from camwright.profiles.tables.trio_program import MOST_STEPS, Numbers, run

SINE = """' a table as the reference of CAMBOX fills it
profile_gen:
  num_p = 30
  scale = 2000
  FOR p = 0 TO num_p
    TABLE(p, ((-SIN(PI * 2 * p / num_p) / (PI * 2)) + p / num_p) * scale)
  NEXT p
RETURN
CAMBOX(0, num_p, 2, scale / 20, 1, 4)
"""


def test_a_table_that_a_loop_fills_is_what_the_loop_computes() -> None:
    assert detect(SINE, "cam.bas") is TARGETS["trio"]
    table = read_table(TARGETS["trio"], SINE, "cam.bas")
    u = np.arange(31) / 30
    assert table.y == pytest.approx(4000.0 * (u - np.sin(2 * np.pi * u) / (2 * np.pi)), abs=1e-9)
    assert table.period == 100.0


def test_addresses_from_variables_and_loops_inside_loops() -> None:
    text = (
        "DEFCONST start 100\nFOR row = 0 TO 2\n base = start + 4 * row\n FOR k = 0 TO 3\n"
        "  TABLE(base + k, 10 * row + k)\n NEXT k\nNEXT row\nTABLE(start + 12, 33, 2^5)\n"
    )
    table = TARGETS["trio"].read(text, "cam.bas")
    assert table.y.tolist() == [10.0 * (i // 4) + i % 4 for i in range(12)] + [33.0, 32.0]
    back = TARGETS["trio"].read("FOR k = 5 TO 0 STEP -1\nTABLE(k, k)\nNEXT\n", "cam.bas")
    assert back.y.tolist() == [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]


NUMBER = st.floats(0.001, 1000.0).map(lambda value: f"{value:.6f}")
EXPRESSION = st.recursive(
    NUMBER | st.sampled_from(["a", "B", "PI"]),
    lambda inner: (
        st.tuples(inner, st.sampled_from("+-*/"), inner).map(" ".join)
        | inner.map("({})".format)
        | inner.map("-{}".format)
        | st.tuples(st.sampled_from(["SIN", "COS", "ABS", "ATAN"]), inner).map(lambda pair: f"{pair[0]}({pair[1]})")
    ),
    max_leaves=8,
)


@given(EXPRESSION)
def test_expressions_come_to_what_python_makes_of_them(text: str) -> None:
    names = {"a": 2.5, "B": -7.5, "PI": math.pi, "SIN": math.sin, "COS": math.cos, "ABS": abs, "ATAN": math.atan}
    numbers = Numbers.of("a = 2.5\nb = a * -3\n", "p")
    try:
        meant = eval(text, {"__builtins__": {}}, names)  # noqa: S307 - made above from numbers and these names
    except ArithmeticError:
        meant = math.inf
    if len(text) <= 200 and abs(meant) <= 1e12:
        assert numbers.value(text, "p", 1) == pytest.approx(meant, rel=1e-12, abs=1e-12)
    else:
        with pytest.raises(InputError):
            numbers.value(text, "p", 1)


@pytest.mark.parametrize(
    ("program", "text", "message"),
    [
        ("x = 1\nx = 2\n", "x", "'x' is not a number: the program does not give x one number"),
        ("x = 1\nIF b THEN x = 2\n", "x", "does not give x one number"),
        ("x = 16\nx.10 = ON\n", "x + 1", "does not give x one number"),
        ("x = y\ny = x\n", "x", "does not give x one number"),
        ("", "VR(3)", "does not give vr one number"),
        ("", "1 +", r"'1 \+' is not a number"),
        ("", "(1", "is not a number"),
        ("", "1 2", "is not a number"),
        ("", "1 / 0", "is not a number"),
        ("", "9 ^ 9 ^ 9", "is beyond 1e"),
        ("", "SQR(-1)", "is not a number"),
        ("", "1" + "+1" * 200, "is not a number"),
        ("", "(" * 199, "is not a number"),
        ("", "__import__('os')", "is not a number"),
    ],
)
def test_what_is_no_number_is_refused_with_its_line(program: str, text: str, message: str) -> None:
    with pytest.raises(InputError, match=f"prog.bas, line 7: .*{message}"):
        Numbers.of(program, "prog.bas").value(text, "prog.bas", 7)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("FOR k = 0 TO n\nTABLE(k, 1)\nNEXT k\n", "line 2: 'k' is not a number: what k runs over is not known"),
        ("FOR k = 0 TO 5 STEP 0\nTABLE(k, 1)\nNEXT k\n", "line 1: .* never ends"),
        ("FOR k = 0 TO 1e9\nx = 1\nNEXT k\n", f"the loops of the program come to more than {MOST_STEPS} statements"),
        ("FOR k = 0 TO 5 STEP 1e-12\nx = 1\nNEXT k\n", f"the loops of the program come to more than {MOST_STEPS} statements"),
        ("FOR k = 0 TO 1\n" * 30, "line 21: more than 20 loops lie inside one another"),
        ("FOR k = 0 TO 5\nTABLE(k / 2, 1)\nNEXT k\n", "line 2: 'k / 2' is not a whole number"),
        ("FOR k = 0 TO 5\nTABLE(0, k)\nNEXT k\n", "line 2: the address 0 is filled twice"),
        ("FOR k = 0 TO 20000\nTABLE(k, k)\nNEXT k\n", "line 2: the table has more than 16000 values"),
        ("TABLE(0, 1, 2)\nIF a THEN TABLE(2, 3)\n", "line 2: .* fills the table on a condition"),
        ("TABLE(0, 1, 2)\n10 TABLE(2, 3, 4)\n", "line 2: .* fills the table on a condition or behind something else"),
        ("TABLE(0, 1, 2)\nCAMBOX(0, 1, 2, 5, 1, 12)\n", "line 2: CAMBOX takes its multipliers from a list"),
        ("TABLE(0, 1, 2)\nCAMBOX(0, 0.5, 2, 5, 1)\n", "line 2: CAMBOX runs from 0 to 0.5, which are no addresses"),
    ],
)  # fmt: skip
def test_programs_that_fill_no_table_are_refused(text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        TARGETS["trio"].read(text, "cam.bas")


def test_a_loop_of_unknown_bounds_is_gone_through_once() -> None:
    passed = [statement for _, statement, _ in run("FOR k = a TO b\nFORWARD\nNEXT k\nSTOP\n", "p", Numbers({}))]
    assert passed == ["FOR k = a TO b", "FORWARD", "STOP"]


def test_a_statement_goes_on_behind_an_underscore() -> None:
    text = "TABLE(0, 0, 1, _ ' first\n  2, 3,_\n4)\nrest_ = 5\nTABLE(5, rest_)\n"
    table = read_table(TARGETS["trio"], text, "cam.bas")
    assert table.y.tolist() == [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]
    for end in ("", "\n"):
        with pytest.raises(InputError, match="line 2"):
            read_table(TARGETS["trio"], "TABLE(0, 1, 2)\nTABLE(2, 3, _" + end, "cam.bas")
