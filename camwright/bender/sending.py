"""Sending a program to the machine over a serial line."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from camwright.profiles.bender.nc_code import Flavour
from camwright.profiles.errors import InputError, MissingExtraError

if TYPE_CHECKING:
    import serial

Handshake = Literal["xonxoff", "rtscts"]
Parity = Literal["none", "even", "odd"]
End = Literal["esc", "eot", "sub", "etx", "none"]

ENDS: dict[End, bytes] = {"esc": b"\x1b", "eot": b"\x04", "sub": b"\x1a", "etx": b"\x03", "none": b""}
"""Characters by which a control knows the end of a file; Fagor's 8055 takes one of the first four (its EOFCHR)."""

_WAIT = 30.0
"""Time that the machine may hold the line up (s)."""


@dataclass(frozen=True)
class SerialLine:
    """The serial line to a machine, as its parameters say.

    Parameters
    ----------
    port
        The serial device.
    baud
        Bits per second.
    handshake
        How the machine holds the line up: ``"xonxoff"`` by characters, ``"rtscts"`` by the CTS wire.
    data_bits, parity, stop_bits
        What a character is made of.
    """

    port: str
    baud: int
    handshake: Handshake
    data_bits: int
    parity: Parity
    stop_bits: int


def transfer(text: str, flavour: Flavour, attributes: str | None, end: End | None) -> list[bytes]:
    """Give a program as it goes over the line, row by row.

    Parameters
    ----------
    flavour
        Of its control: ``"fagor"`` has a header ``%name,attributes,`` and an end of file, ``"iso"`` neither.
    attributes
        Of the header; ``None`` for ``MX``, which may be changed and run.
    end
        The end of file; ``None`` for ESC with ``"fagor"`` and none with ``"iso"``.

    Raises
    ------
    InputError
        Attributes for a flavour that has none, or that are none.
    """
    rows = text.splitlines()
    if flavour == "fagor":
        rows[0] = f"{rows[0]},{'MX' if attributes is None else attributes},"
    elif attributes is not None:
        raise InputError(f"--attributes {attributes}: programs of flavour {flavour} have no header for them")
    if attributes is not None and not re.fullmatch("[A-Z]{0,8}", attributes):
        raise InputError(f"--attributes {attributes!r}: not attributes; write capital letters, e.g. MX")
    last: End = ("esc" if flavour == "fagor" else "none") if end is None else end
    return [*(f"{row}\r\n".encode("ascii") for row in rows), *filter(None, [ENDS[last]])]


def send(rows: Sequence[bytes], to: SerialLine, sent: Callable[[int], None]) -> None:
    """Send a program, row by row, and wait until the last byte has left.

    Parameters
    ----------
    rows
        The program, as `transfer` gives it.
    sent
        Told the number of rows sent so far.

    Raises
    ------
    InputError
        The port cannot be opened, or the line stays held up.
    MissingExtraError
        The serial library is not installed.
    """
    try:
        import serial
    except ImportError as error:
        raise MissingExtraError("pyserial", "serial") from error
    count = 0
    try:
        with serial.Serial(
            to.port,
            to.baud,
            bytesize=to.data_bits,
            parity={"none": serial.PARITY_NONE, "even": serial.PARITY_EVEN, "odd": serial.PARITY_ODD}[to.parity],
            stopbits=to.stop_bits,
            xonxoff=to.handshake == "xonxoff",
            rtscts=to.handshake == "rtscts",
            write_timeout=_WAIT,
            exclusive=True,
        ) as line:
            for row in rows:
                line.write(row)
                count += 1
                sent(count)
            _drain(line)
    except serial.SerialTimeoutException as error:
        raise InputError(
            f"{to.port}: the machine held the line up for {_WAIT:g} s; {count} lines of the program were handed over; "
            "start the reception there and send again"
        ) from error
    except (serial.SerialException, OSError, ValueError) as error:
        raise InputError(
            f"{to.port}: the serial line cannot be used: {error}; {count} lines of the program were handed over; check --port, "
            "--baud and the cable"
        ) from error


def _drain(line: serial.Serial) -> None:
    """Wait until what the system still holds back has left, as long as something leaves.

    Raises
    ------
    serial.SerialTimeoutException
        The machine holds the line up; what has not left is discarded.
    """
    import serial

    waiting, since = line.out_waiting, time.monotonic()
    while waiting:
        if time.monotonic() - since > _WAIT:
            line.reset_output_buffer()
            raise serial.SerialTimeoutException("held up")
        time.sleep(0.02)
        before, waiting = waiting, line.out_waiting
        if waiting < before:
            since = time.monotonic()
