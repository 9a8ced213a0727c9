"""The edge between what works and what does not: against the edge put in, from either side, to a tolerance and in so many questions."""

import math

from hypothesis import given
from hypothesis import strategies as st

from camwright.profiles.halving import halved, narrowed

SIZES = st.floats(1e-6, 1e6)


@given(SIZES, SIZES, SIZES)
def test_the_ends_are_neighbours_about_the_edge(edge: float, below: float, above: float) -> None:
    low, high = edge - below, edge + above
    good, bad = halved(lambda value: value < edge, low, high)
    assert good < edge <= bad
    assert bad <= math.nextafter(good, math.inf)
    good, bad = halved(lambda value: value >= edge, high, low)
    assert bad < edge <= good
    assert good <= math.nextafter(bad, math.inf)


@given(st.floats(1.0, 2.0, exclude_min=True), st.floats(1e-9, 0.1))
def test_it_stops_at_the_tolerance(edge: float, tolerance: float) -> None:
    asked: list[float] = []

    def works(value: float) -> bool:
        asked.append(value)
        return value < edge

    good, bad = halved(works, 1.0, 2.0, tolerance)
    assert good < edge <= bad
    assert bad - good <= tolerance * bad
    assert len(asked) <= math.ceil(math.log2(1 / tolerance))


def test_it_asks_no_more_than_it_may_and_never_the_ends() -> None:
    asked: list[float] = []

    def works(value: float) -> bool:
        asked.append(value)
        return False

    assert halved(works, 0.0, 1.0, most=3) == (0.0, 0.125)
    assert asked == [0.5, 0.25, 0.125]


@given(st.floats(1.0, 2.0, exclude_min=True), st.floats(0.5, 3.0), st.sampled_from((1e-4, 1e-9, 1e-12)))
def test_by_how_much_is_missed_the_edge_is_found_in_a_few_questions(
    edge: float, bent: float, resolution: float
) -> None:
    asked: list[float] = []

    def missed(value: float) -> float:
        asked.append(value)
        return edge**bent - value**bent

    (at, by) = narrowed(missed, (1.0, edge**bent - 1.0), (2.1, edge**bent - 2.1**bent), resolution)
    assert by <= 0.0
    assert edge <= at <= edge * (1.0 + 1.1 * resolution) or by >= -resolution
    assert len(asked) <= 14


@given(st.floats(1.0, 2.0, exclude_min=True))
def test_where_only_signs_are_known_it_halves(edge: float) -> None:
    at, _ = narrowed(lambda value: math.inf if value < edge else -math.inf, (1.0, math.inf), (2.1, -math.inf), 1e-6)
    assert edge <= at <= edge * (1.0 + 1.1e-6)
