"""Linear algebra in one thread."""

from __future__ import annotations

import os

import numpy as np
import pytest

from camwright.house import threads


def test_the_number_of_threads_is_put_back() -> None:
    """Within, every OpenBLAS of the wheels has one thread; behind, and behind an error, as many as before."""
    switches = threads._switches()
    given = [get() for get, _ in switches]
    for _, put in switches:
        put(2)
    before = [get() for get, _ in switches]
    with threads.one_thread():
        assert [get() for get, _ in switches] == [1] * len(switches)
        assert np.linalg.inv(np.eye(300) * 2.0)[7, 7] == 0.5
    with pytest.raises(ZeroDivisionError), threads.one_thread():
        raise ZeroDivisionError
    assert [get() for get, _ in switches] == before
    for (_, put), count in zip(switches, given, strict=True):
        put(count)


def test_the_environment_is_asked_unless_it_says_a_number(monkeypatch: pytest.MonkeyPatch) -> None:
    """A number that the user has set stays."""
    for name in threads.VARIABLES:
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("OMP_NUM_THREADS", "3")
    threads.ask_for_one_thread()
    assert [os.environ[name] for name in threads.VARIABLES] == ["1", "3", "1"]
