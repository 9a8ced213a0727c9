"""Programs over a serial line: what goes over it, and a machine at its other end that behaves as the manual says."""

import os
import sys
import termios
import threading
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from camwright.bender.job import BUNDLED_BENDER
from camwright.bender.sending import ENDS, SerialLine, send, transfer
from camwright.cli.main import main
from camwright.profiles.errors import InputError

Make = Callable[..., Path]
FAGOR = "%PART\nN001 G71\nN010 M30\n"
ISO = "%\n(PART)\nN001 G21\nN010 M30\n%\n"


class Machine:
    """The far end of a pseudo-terminal: it receives until its end of file, as quickly as it is told to."""

    def __init__(self, end: bytes, pause: float = 0.0, leave_after: int | None = None) -> None:
        self.here, self.there = os.openpty()
        self.port = os.ttyname(self.there)
        self.received = bytearray()
        self.flags: list[object] = []
        self._end, self._pause, self._leave = end, pause, leave_after
        self._thread = threading.Thread(target=self._listen, daemon=True)
        self._thread.start()

    def _listen(self) -> None:
        while not self.received.endswith(self._end):
            self.received.extend(os.read(self.here, 16))
            if not self.flags:
                self.flags = termios.tcgetattr(self.there)
            time.sleep(self._pause)
            if self._leave is not None and len(self.received) > self._leave:
                os.close(self.there)
                os.close(self.here)
                return

    def done(self) -> bytes:
        """Give what was received."""
        self._thread.join(20)
        for side in (self.here, self.there):
            os.close(side)
        return bytes(self.received)


def line(port: str, **more: object) -> SerialLine:
    return SerialLine(
        port, **({"baud": 9600, "handshake": "xonxoff", "data_bits": 8, "parity": "none", "stop_bits": 1} | more)
    )  # type: ignore[arg-type]


def test_header_and_end_by_flavour_and_option():
    assert b"".join(transfer(FAGOR, "fagor", None, None)) == b"%PART,MX,\r\nN001 G71\r\nN010 M30\r\n\x1b"
    assert b"".join(transfer(FAGOR, "fagor", "", "none")) == b"%PART,,\r\nN001 G71\r\nN010 M30\r\n"
    assert b"".join(transfer(ISO, "iso", None, None)).decode().replace("\r\n", "\n") == ISO
    for end, character in ENDS.items():
        assert b"".join(transfer(ISO, "iso", None, end)).endswith(b"%\r\n" + character)
    assert [ENDS[end] for end in ("esc", "eot", "sub", "etx")] == [bytes([27]), bytes([4]), bytes([26]), bytes([3])]


def test_attributes_that_are_none():
    with pytest.raises(InputError, match="--attributes 'M,X': not attributes"):
        transfer(FAGOR, "fagor", "M,X", None)
    with pytest.raises(InputError, match="programs of flavour iso have no header for them"):
        transfer(ISO, "iso", "MX", None)


def test_characters_are_made_as_the_machine_wants_them():
    pytest.importorskip("serial")
    machine = Machine(ENDS["eot"])
    send(
        transfer(FAGOR, "fagor", "M", "eot"),
        line(machine.port, data_bits=7, parity="even", stop_bits=2, baud=4800),
        lambda _: None,
    )
    assert machine.done() == b"%PART,M,\r\nN001 G71\r\nN010 M30\r\n\x04"
    _, _, control, _, speed, *_ = machine.flags
    # a pseudo-terminal has no wire, and its kernel keeps eight bits without parity: what it can keep is kept
    assert control & termios.CSTOPB
    assert speed == termios.B4800


def test_a_slow_reader_gets_everything():
    pytest.importorskip("serial")
    machine = Machine(ENDS["sub"], pause=0.002)
    rows = transfer("%PART\n" + "N010 G01 G91 X22.000\n" * 500 + "N020 M30\n", "fagor", None, "sub")
    counts: list[int] = []
    send(rows, line(machine.port), counts.append)
    assert machine.done() == b"".join(rows)
    assert counts == list(range(1, 504))


def test_a_line_that_is_dropped_is_told():
    pytest.importorskip("serial")
    machine = Machine(b"never", leave_after=200)
    rows = transfer("%PART\n" + "N010 G01 G91 X22.000\n" * 5000, "fagor", None, None)
    with pytest.raises(
        InputError, match=r"the serial line cannot be used: .*; \d+ lines of the program were handed over"
    ):
        send(rows, line(machine.port), lambda _: None)


def several(m, _):
    m.add_lwpolyline([(0, 0), (22, 0), (22, 22)])
    m.add_line((0, 50), (40, 50))


def test_one_program_at_a_time_with_a_wait(drawing: Make, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    waited: list[float] = []
    monkeypatch.setattr("camwright.cli.bend.time.sleep", lambda s: waited.append(s) if s == 7.0 else None)
    sent: list[bytes] = []
    monkeypatch.setattr("camwright.cli.bend.send", lambda rows, *_: sent.append(b"".join(rows)))
    arguments = ["bend", str(drawing(several)), "--out", str(tmp_path / "out"), "--no-figures", "--port", "none"]
    assert main([*arguments, "--wait", "7", "--quiet"]) == 0
    assert waited == [7.0]
    assert [text.split(b"\r\n")[0] for text in sent] == [b"%DRAWING-1,MX,", b"%DRAWING-2,MX,"]


def test_one_program_at_a_time_with_a_question(
    drawing: Make, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    asked: list[str] = []
    monkeypatch.setattr("camwright.cli.bend.send", lambda *_: None)
    monkeypatch.setattr("camwright.cli.bend.typer.prompt", lambda text, *_, **__: asked.append(text))
    arguments = ["bend", str(drawing(several)), "--out", str(tmp_path / "out"), "--no-figures", "--port", "none"]
    assert main(arguments) == 2  # nobody to ask
    assert "2 programs are to be sent, and the machine takes one at a time" in capsys.readouterr().err
    monkeypatch.setattr(sys.stdin, "isatty", lambda: True, raising=False)
    assert main(arguments) == 0
    assert asked == ["start the reception of DRAWING-2 on the machine, then press Enter"]


def test_a_fault_of_the_options_is_told_before_anything_is_sent(
    drawing: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    job = tmp_path / "iso.toml"
    job.write_text(BUNDLED_BENDER.read_text(encoding="utf-8").replace('flavour = "fagor"', 'flavour = "iso"'))
    path = drawing(lambda m, _: m.add_line((0, 0), (40, 0)))
    arguments = ["bend", str(path), "--job", str(job), "--out", str(tmp_path / "out"), "--no-figures", "--port", "none"]
    assert main([*arguments, "--attributes", "MX"]) == 2
    assert "programs of flavour iso have no header" in capsys.readouterr().err
