"""Every target: what is written is read back, rebuilt as the drive does, and compared with the profile."""

from __future__ import annotations

import re

import numpy as np
import pytest
from knives import HEADER, KNIVES, UNITS, chosen, knife, main_text, written

from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.tables.cam_table import (
    CamTable,
    TableUnits,
    Unit,
    make_table,
)
from camwright.profiles.tables.deviation import deviation
from camwright.profiles.tables.knots import Accuracy, choose, table_units
from camwright.profiles.tables.target import Header, advance_in, units_in
from camwright.profiles.tables.targets import TARGETS, detect
from camwright.profiles.tables.text import LARGEST_FILE, decode

EXACT = ("codesys", "codesys-cambuilder", "twincat", "s7-1500t", "pacdrive", "csv")
SPLINES = ("twincat-table", "s7-1500t-points", "kollmorgen-kas", "sew", "schneider-asc")
LINES = ("twincat-cnc", "lenze", "technosoft", "trio")


def rebuilt(target: str, name: str) -> CamProfile:
    file, text = main_text(target, name)
    table = TARGETS[target].read(decode(text.encode(), file), file)
    units = table.units or chosen(target, name).table.units
    assert units is not None
    return units.to_si(TARGETS[target].rebuild(table))


def dense_errors(profile: CamProfile, found: CamProfile) -> list[float]:
    x = np.linspace(max(profile.start, found.start), min(profile.end, found.end), 100_001)
    return [float(np.abs(found(x, order) - profile(x, order)).max()) for order in range(3)]


@pytest.mark.parametrize("name", KNIVES)
@pytest.mark.parametrize("target", TARGETS)
def test_the_file_says_what_the_choice_promised(target: str, name: str) -> None:
    promised = chosen(target, name).deviation
    found = deviation(knife(name), rebuilt(target, name))
    assert found.position == pytest.approx(promised.position, rel=0.02, abs=1e-15)
    assert found.ratio == pytest.approx(promised.ratio, rel=0.02, abs=1e-12)
    assert (found.acceleration is None) == (promised.acceleration is None) == (target in LINES)


@pytest.mark.parametrize("name", ["quintic", "short, origin at the cut"])
@pytest.mark.parametrize("target", TARGETS)
def test_the_stated_error_is_the_true_one_within_a_tenth(target: str, name: str) -> None:
    profile, found = knife(name), rebuilt(target, name)
    stated, true = deviation(profile, found), dense_errors(profile, found)
    peak = float(np.abs(profile(np.linspace(0, profile.end, 1001), 2)).max())
    assert stated.position == pytest.approx(true[0], rel=0.1, abs=1e-14)
    assert stated.ratio == pytest.approx(true[1], rel=0.1, abs=1e-12)
    if stated.acceleration is not None:
        assert stated.acceleration * peak == pytest.approx(true[2], rel=0.1, abs=1e-9 * peak)


@pytest.mark.parametrize("name", ["quintic", "jerk-limited", "short, origin at the cut"])
@pytest.mark.parametrize("target", EXACT)
def test_quintics_carry_our_pieces_without_error(target: str, name: str) -> None:
    profile, found = knife(name), rebuilt(target, name)
    errors = dense_errors(profile, found)
    assert chosen(target, name).table.points <= 24
    assert errors[0] <= 1e-9 * 0.4
    assert errors[1] <= 1e-12
    assert errors[2] <= 1e-9


@pytest.mark.parametrize("target", SPLINES)
def test_splines_carry_cubic_pieces_with_a_knot_at_each_break(target: str) -> None:
    choice = chosen(target, "short, origin at the cut")
    assert choice.deviation.position <= 1e-14
    if target != "schneider-asc":  # its points are evenly spaced
        assert choice.table.points == knife("short, origin at the cut").pieces + 1


@pytest.mark.parametrize("name", KNIVES)
@pytest.mark.parametrize("target", TARGETS)
def test_the_motion_keeps_the_stated_accuracy(target: str, name: str) -> None:
    choice = chosen(target, name)
    if target in ("twincat-cnc", "technosoft", "trio"):  # as near as their points and whole numbers let them
        assert choice.deviation.position <= 3e-6
    else:
        assert Accuracy().kept_by(choice.deviation)
    ends = (0.0, knife(name).end)
    units = choice.table.units
    assert units is not None
    assert (choice.table.x[[0, -1]] * units.master.size) == pytest.approx(ends, rel=1e-7, abs=1e-12)


@pytest.mark.parametrize("target", [*EXACT, *SPLINES, "logix", "br"])
def test_the_cycle_closes_in_ratio_over_the_seam(target: str) -> None:
    found = rebuilt(target, "short, origin at the cut")
    assert abs(found.jumps(1)[-1]) <= 1e-12
    assert float(found.repeat(3).advance) == pytest.approx(3 * 0.4, rel=1e-7)


@pytest.mark.parametrize("target", TARGETS)
def test_points_stand_at_the_ends_of_the_sync_zone(target: str) -> None:
    units = chosen(target, "jerk-limited").table.units
    assert units is not None
    x = chosen(target, "jerk-limited").table.x * units.master.size
    assert np.abs(x - 0.4).min() <= 1e-7 * 0.6


@pytest.mark.parametrize("target", TARGETS)
def test_the_layout_is_recognised_and_the_units_come_back(target: str) -> None:
    file, text = main_text(target, "quintic")
    if target in ("kollmorgen-kas", "sew", "schneider-asc", "trio", "technosoft"):  # their layouts allow no comment
        assert units_in(text) is None
        assert any(
            units_in(beside) == chosen(target, "quintic").table.units for beside in written(target, "quintic").values()
        )
    elif target != "csv":
        assert units_in(text) == chosen(target, "quintic").table.units
        assert advance_in(text) == pytest.approx(chosen(target, "quintic").table.advance)
    assert detect(text, file) is TARGETS[target]


def test_the_acceleration_of_logix_keeps_one_percent_and_more_points_make_it_worse() -> None:
    best = chosen("logix", "quintic")
    many = chosen("logix", "quintic", 1001)
    assert best.deviation.acceleration is not None
    assert many.deviation.acceleration is not None
    assert many.table.points > 900
    assert best.deviation.acceleration <= 0.01
    assert many.deviation.acceleration > 4 * best.deviation.acceleration


def test_float32_is_the_reason() -> None:
    table = chosen("logix", "quintic", 1001).table
    exact = TARGETS["twincat-table"].rebuild(table)  # the same points in float64
    assert deviation(knife("quintic"), UNITS.to_si(exact)).acceleration < 0.002  # type: ignore[operator]


def test_a_limit_of_points_is_kept_and_refused_beyond() -> None:
    long = knife("jerk-limited").repeat(8)  # 64 pieces and more
    with pytest.raises(InputError, match=r"s7-1500t takes at most 3 points, too few for the pieces of this profile"):
        choose(long, TARGETS["s7-1500t"], UNITS, Accuracy(), 3)
    short = choose(long, TARGETS["s7-1500t"], UNITS, Accuracy())
    assert short.table.points <= 51
    with pytest.raises(InputError, match=r"s7-1500t takes 2 to 51 points; 52 are asked for"):
        choose(long, TARGETS["s7-1500t"], UNITS, Accuracy(), 52)


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize(
    "name", ["*) {x} (* /* */ -- --> ]]> \\", "a\nb\r\n// c\u2028d\x00\x1b[31m", "Ünicode 刀 " * 9, "9", ""]
)
def test_a_users_name_never_leaves_its_comment(target: str, name: str) -> None:
    table = chosen(target, "quintic").table
    plain = TARGETS[target].read(next(iter(TARGETS[target].write(table, HEADER).values())), "plain")
    files = TARGETS[target].write(table, Header(name, "0.1.0", "", (), ("the jerk exceeds its limit",)))
    for file, text in files.items():
        assert re.fullmatch(r"[A-Za-z0-9_]+\.[A-Za-z0-9]+", file)
        assert not re.search(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f\u2028]", text)
    again = TARGETS[target].read(decode(next(iter(files.values())).encode(), "named"), "named")
    assert np.array_equal(again.x, plain.x)
    assert np.array_equal(again.y, plain.y)
    assert any("NOT RELEASED: the jerk exceeds its limit" in text for text in files.values())


def test_a_name_cannot_pass_for_the_statement_of_units() -> None:
    fake = "camwright units: master m 1.0, slave m 1.0; advance 7.0"
    table = chosen("codesys", "quintic").table
    text = next(iter(TARGETS["codesys"].write(table, Header(fake, "0.1.0")).values()))
    assert units_in(text) == UNITS


def test_whole_periods() -> None:
    profile = knife("quintic")
    third = profile.scale(master=1 / 1.8)  # 333.333… mm
    with pytest.raises(InputError, match=r"takes whole periods, and 333\.33"):
        table_units(TARGETS["br"], third, UNITS)
    fine = table_units(TARGETS["br"], profile.scale(master=1.0001), TableUnits(Unit("mm", 1e-3), Unit("mm", 1e-3)))
    assert fine.master.symbol == "1e-2mm"
    bad = make_table([0, 1.5], [0, 1], [0, 0], [0, 0])
    with pytest.raises(InputError, match=r"the master period is 1\.5 units; this drive takes a whole number"):
        TARGETS["br"].write(bad, HEADER)


@pytest.mark.parametrize(
    ("target", "table", "message"),
    [
        ("twincat-cnc", make_table([0, 1000], [0, 1], law="line"), "the period must be 3600000 units"),
        ("twincat-cnc", make_table([0, 500, 3_600_000], [0, 1, 2], law="line"), "less than 0.1° of the master apart"),
        ("schneider-asc", make_table([0, 1, 3], [0, 1, 2], [0, 0, 0]), "must be evenly spaced"),
        ("trio", make_table([0, 1, 3], [0, 1, 2]), "must be evenly spaced"),
        ("technosoft", make_table([0, 3, 6], [0, 1, 2]), "evenly spaced by 1, 2, 4"),
        ("technosoft", make_table([0, 1], [0, 1e11]), "exceeds the 32 bits"),
        ("kollmorgen-kas", make_table(range(5), [0, 1, 2, 1, 0]), "end at its greatest value"),
        ("kollmorgen-kas", make_table(range(4), range(4)), "at least 5 points"),
        ("csv", make_table(range(4), range(4)), "say what the units of this table are"),
    ],
)
def test_what_a_layout_cannot_hold_is_refused(target: str, table: CamTable, message: str) -> None:
    with pytest.raises(InputError, match=message):
        TARGETS[target].write(table, HEADER)


def test_the_largest_tables_stay_below_the_largest_file() -> None:
    x = np.linspace(0, 600, 10_000)
    table = make_table(x, np.sin(x) + x, law="spline", units=UNITS)
    for target in ("s7-1500t-points", "twincat-table", "logix"):
        table_here = (
            make_table(x, np.sin(x) + x, np.cos(x) + 1, law="spline", units=UNITS) if target == "logix" else table
        )
        text = next(iter(TARGETS[target].write(table_here, HEADER).values()))
        assert len(text) < LARGEST_FILE
        assert TARGETS[target].read(text, "large").points == 10_000
