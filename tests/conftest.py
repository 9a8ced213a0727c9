"""What all tests share: this checkout, no display, and property tests that run the same way every time."""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path

from hypothesis import settings

VARIABLES = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")
ROOT = Path(__file__).resolve().parents[1]

settings.register_profile("camwright", deadline=None, derandomize=True)
settings.load_profile("camwright")

for name in VARIABLES:  # as the command line has it; numpy is not loaded yet
    os.environ.setdefault(name, "1")
os.environ.pop("COLUMNS", None)  # tables are as wide as they are told, not as the terminal of whoever runs the tests

if (
    signal.getsignal(signal.SIGINT) == signal.SIG_IGN
):  # in the background of a script interrupts are tested all the same
    signal.signal(signal.SIGINT, signal.default_int_handler)

if (ROOT / "camwright" / "design").is_dir():
    # Processes that a test starts see this checkout first, as the tests themselves do (pythonpath of pytest), not a copy installed earlier.
    os.environ["PYTHONPATH"] = os.pathsep.join([str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])])
else:
    # A source archive has no links to its floors, so it is no package by itself: what was installed of it is tested.
    sys.path[:] = [place for place in sys.path if Path(place).resolve() != ROOT]
    os.environ["PYTHONSAFEPATH"] = "1"  # nor do processes that a test starts look into the archive
