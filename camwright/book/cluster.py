"""Making a book on an existing cluster: Dask distributed, the same work as on this machine."""

from __future__ import annotations

import contextlib
import logging
from collections.abc import Iterator
from concurrent.futures import Executor

from camwright.book.making import make_chunk
from camwright.book.workers import Crew
from camwright.profiles.errors import InputError, MissingExtraError

_CHUNK = 8
_PATIENCE = 15.0
"""How long a scheduler, and a first worker, is waited for (s)."""


@contextlib.contextmanager
def cluster_crew(address: str) -> Iterator[Crew]:
    """Connect to a cluster.

    Its scheduler sends what a dead worker held to others. A chunk that several workers died of comes back as lost.

    Parameters
    ----------
    address
        Address of the scheduler, ``tcp://host:8786``.

    Raises
    ------
    MissingExtraError
        Dask distributed is not installed.
    InputError
        There is no scheduler at the address, or no worker.
    """
    try:
        from distributed import Client, KilledWorker
    except ImportError as error:
        raise MissingExtraError("distributed", "cluster") from error
    # what happens to the cluster is told in one message of our own
    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    try:
        client = Client(address, timeout=_PATIENCE, set_as_default=False, name="camwright")
    except (OSError, ValueError) as error:
        raise InputError(
            f"--cluster {address}: no scheduler answers there: {error}; start one by dask scheduler, or leave out --cluster"
        ) from error
    with client:
        try:
            client.wait_for_workers(1, timeout=_PATIENCE)
        except TimeoutError as error:
            raise InputError(
                f"--cluster {address}: the scheduler has no workers; start some by dask worker {address}"
            ) from error

        @contextlib.contextmanager
        def start() -> Iterator[Executor]:
            executor = client.get_executor(pure=False)
            try:
                yield executor
            finally:
                executor.shutdown(wait=False)

        def size() -> int:
            return len(client.scheduler_info(n_workers=-1)["workers"])

        yield Crew(start, size, _CHUNK, make_chunk, (KilledWorker,))
