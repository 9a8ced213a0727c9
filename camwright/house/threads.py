"""Linear algebra in one thread: of matrices as small as a cam's, threads cost more than they bring.

A design multiplies matrices of some hundred rows some ten thousand times. OpenBLAS shares each product out among all processors, which
wait for each other busily: up to five times the processor time, and more where other processes work too. In one thread the rounding of an
answer does not depend on the number of processors either.
"""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import lru_cache
from pathlib import Path

VARIABLES = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")
"""Variables of the environment that the libraries read when they are loaded."""

_FOLDERS = ("numpy.libs", "scipy.libs", "numpy/.dylibs", "scipy/.dylibs")
"""Where the wheels of numpy and scipy keep their OpenBLAS, beside and below the packages."""


def ask_for_one_thread() -> None:
    """Ask for one thread in a process that has not loaded numpy yet, unless its environment says another number."""
    for name in VARIABLES:
        os.environ.setdefault(name, "1")


@contextmanager
def one_thread() -> Iterator[None]:
    """Hold the OpenBLAS of numpy and scipy to one thread, and put back what was; other libraries are left as they are."""
    before = [(put, get()) for get, put in _switches()]
    for put, _ in before:
        put(1)
    try:
        yield
    finally:
        for put, count in before:
            put(count)


@lru_cache(maxsize=1)
def _switches() -> tuple[tuple[Callable[[], int], Callable[[int], object]], ...]:
    """Find what reads and sets the number of threads of each OpenBLAS that the wheels brought along."""
    numpy = sys.modules.get("numpy")
    if numpy is None or numpy.__file__ is None:
        return ()
    packages = Path(numpy.__file__).parents[1]
    found = []
    for path in sorted(path for folder in _FOLDERS for path in packages.glob(f"{folder}/*openblas*")):
        try:
            library = ctypes.CDLL(str(path))
        except OSError:  # built for another system
            continue
        for name in ("scipy_openblas_{}_num_threads64_", "scipy_openblas_{}_num_threads", "openblas_{}_num_threads"):
            get, put = getattr(library, name.format("get"), None), getattr(library, name.format("set"), None)
            if get is not None and put is not None:
                found.append((get, put))
                break
    return tuple(found)
