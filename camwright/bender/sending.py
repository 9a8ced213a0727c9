"""Sending a program to the machine over a serial line."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Literal

from camwright.profiles.errors import InputError, MissingExtraError

if TYPE_CHECKING:
    import serial

Handshake = Literal["xonxoff", "rtscts"]

_WAIT = 30.0
"""Time that the machine may hold the line up (s)."""


def send(text: str, port: str, handshake: Handshake, baud: int, sent: Callable[[int], None]) -> None:
    """Send a program, line by line, and wait until the last byte has left.

    Parameters
    ----------
    text
        The program; lines go out with carriage return and line feed.
    port
        The serial device.
    handshake
        How the machine holds the line up: ``"xonxoff"`` by characters, ``"rtscts"`` by the CTS wire.
    baud
        Bits per second; 8 data bits, no parity, one stop bit.
    sent
        Told the number of lines sent so far.

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
            port,
            baud,
            xonxoff=handshake == "xonxoff",
            rtscts=handshake == "rtscts",
            write_timeout=_WAIT,
            exclusive=True,
        ) as line:
            for row in text.splitlines():
                line.write(f"{row}\r\n".encode("ascii"))
                count += 1
                sent(count)
            _drain(line)
    except serial.SerialTimeoutException as error:
        raise InputError(
            f"{port}: the machine held the line up for {_WAIT:g} s; {count} lines of the program were handed over; "
            "start the reception there and send again"
        ) from error
    except (serial.SerialException, OSError, ValueError) as error:
        raise InputError(
            f"{port}: the serial line cannot be used: {error}; check --port, --baud and the cable"
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
