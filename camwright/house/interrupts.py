"""Interrupts that are noted, and raised where that does no harm."""

from __future__ import annotations

import contextlib
import signal
import threading
from collections.abc import Callable, Iterator


@contextlib.contextmanager
def noted_interrupts() -> Iterator[Callable[[], None]]:
    """Note an interrupt (Ctrl-C) meanwhile; gives what raises one that was noted. A second one is raised at once.

    Raised wherever it comes it may be lost, or become another error: what is raised in a callback of the memory's management is printed
    and forgotten, and a lock that is taken back in that moment is then released without being held. One that was not raised before is
    raised at the end. Where interrupts are not those of Python, or this is not the main thread, nothing is changed.
    """
    noted = False

    def note(_signal: int, _frame: object) -> None:
        nonlocal noted
        if noted:
            raise KeyboardInterrupt
        noted = True

    def tell() -> None:
        if noted:
            raise KeyboardInterrupt

    own = signal.getsignal(signal.SIGINT)
    if own is not signal.default_int_handler or threading.current_thread() is not threading.main_thread():
        yield tell
        return
    signal.signal(signal.SIGINT, note)
    try:
        yield tell
    finally:
        signal.signal(signal.SIGINT, own)
    tell()
