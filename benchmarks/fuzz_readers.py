"""Fuzzes the readers of all targets for a time: files damaged at random must be read or refused, nothing else.

``python benchmarks/fuzz_readers.py [SECONDS]``; 300 seconds if not given. Ends with exit code 1 at the first file that
raises anything but a refusal, takes too long or too much memory, and prints how to make it again.
"""

from __future__ import annotations

import collections
import random
import resource
import sys
import time
import traceback

from camwright import load_job
from camwright.drives.export import export_possible
from camwright.jobs.table_cycle import whole_cycle
from camwright.profiles.errors import InputError
from camwright.profiles.returns import baseline
from camwright.profiles.tables.count_grid import without_rounding
from camwright.profiles.tables.targets import LAYOUTS, TARGETS, detect, read_table
from camwright.profiles.tables.text import decode
from camwright.profiles.tables.trace_csv import read_trace_csv
from camwright.validation.identify.preparation import unwrapped

LONGEST = 1.0
"""Processor time that one file may take (s)."""

GROWTH = 200_000
"""What the process may grow beyond its size after the first thousand files (kB)."""

_LINE = (
    "( ) [ ] := ; , .. : . # // (* *) { } ' \" = < > <Tag </Tag> <![CDATA[ ]]> <!DOCTYPE &amp; &x; dX dY a[1].MasterPos "
    "0 -1 2.5 1e3 1e999 -0 NaN inf 16#FFFF 2#2 LREAL# ARRAY OF [0..1] [1..99999] SMC_CAMXYVA MC_MotionFunctionPoint "
    "99999(0.0) 3(1) Append( Poly5( Bound( TABLE( Begintable EndTable CamPoints SPLINE CYCLIC;YES; Lines=7 Tabletype=3 "
    "points: period: camwright Length nElements PointIndex Status 2147483648 99999999999999999999 1,5 1;5 ٣ é \ufeff \x00 \u2028"
)
WORDS = _LINE.split(" ")


def damaged(text: str, dice: random.Random) -> bytes:
    """Damage a text in one to six places, or make one of words only."""
    if dice.random() < 0.05:
        return " ".join(dice.choices(WORDS, k=dice.randrange(200))).encode("utf-8", "surrogatepass")
    for _ in range(dice.randrange(1, 7)):
        at = dice.randrange(len(text) + 1)
        end = min(len(text), at + dice.choice((0, 0, 1, 2, 8, 60, 900)))
        kind = dice.randrange(6)
        if kind == 0:
            new = "".join(dice.choices(WORDS, k=dice.randrange(1, 5)))
        elif kind == 1:
            new = text[end : end + dice.randrange(300)] + text[at:end]
        elif kind == 2:
            new = text[at:end] * dice.choice((2, 3, 200))
        elif kind == 3:
            new = "".join(chr(dice.choice((9, 10, 13, 32, 48, 57, 44, 46, 59, 0x663, 0xE9, 0x2028))) for _ in range(3))
        elif kind == 4:
            new = dice.choice(("(", "[", "9", "\n", "1;", "0.0 ", "<a>")) * dice.choice((10, 3000, 60_000))
        else:
            new = ""
        text = text[:at] + new + text[end:]
        if not text:
            break
    data = text.encode("utf-8", "surrogatepass")
    if dice.random() < 0.1 and data:
        data = data[: dice.randrange(len(data))]
    if dice.random() < 0.1 and data:
        at = dice.randrange(len(data))
        data = data[:at] + dice.randbytes(dice.randrange(1, 9)) + data[at:]
    return data if dice.random() < 0.95 else text.encode("utf-16", "surrogatepass")


def sources() -> dict[str, str]:
    """Write a sound file for every target."""
    job = load_job()
    results, refused = export_possible(baseline("double_s", job.task), job, list(TARGETS))
    if refused:
        raise InputError(*(f"{name}: {fault}" for name, faults in refused.items() for fault in faults))
    return {result.target.name: next(iter(result.files.values())) for result in results}


def foreign() -> dict[str, str]:
    """Write tables and recordings as spreadsheets, scopes and engineering tools have them; a recording's name begins with trace."""
    profile = baseline("double_s", load_job().task)
    x = [profile.length * k / 120 for k in range(121)]
    y = [float(profile(at)) for at in x]
    pairs = [(f"{a * 1e3:.4f}", f"{b * 1e3:.4f}") for a, b in zip(x, y, strict=True)]
    comma = [(a.replace(".", ","), b.replace(".", ",")) for a, b in pairs]
    values = ", ".join(str(round(b * 1e6)) for b in y)
    points = "".join(
        f"p[{k + 1}].PointIndex := {k + 1};\np[{k + 1}].FunctionType := 15;\np[{k + 1}].MasterPos := {a};\n"
        f"p[{k + 1}].SlavePos := {b};\n"
        for k, (a, b) in enumerate(pairs[:6])
    )
    times = [(f"{k},{a};{b}\n") for k, (a, b) in enumerate(comma)]
    scope = "Name\tScope\nFile\tx\n\nName\tAxis.SetPos\tName\tAxis.ActPos\nUnit\t(none)\tUnit\t(none)\n\n"
    keys = "".join(
        f"{key}\t{value}\t{value}\t{key}\t{value}\n" for key, value in (("SampleTime[ms]", "1"), ("Unit", "mm"))
    )
    rates = f"Name\tScope\nFile\tx\n\nName\tAxis.SetPos\tAxis.ActPos\tName\tTorque\n{keys}\n"
    return {
        "galil": "' knife\nEP 100,0\n" + "".join(f"ET[{k}]={round(b * 1e6)}\n" for k, b in enumerate(y)) + "EN\n",
        "arrays": "".join(
            f"{name}Pos : ARRAY[1..{len(x)}] OF LREAL := [{', '.join(cells)}];\n"
            for name, cells in (("Master", [a for a, _ in pairs]), ("Slave", [b for _, b in pairs]))
        ),
        "trace rates": rates + "".join(f"{k}\t{a}\t{b}\t{k // 4 * 4}\t1\n" for k, (a, b) in enumerate(comma)) + "EOF\n",
        "semicolons": "Leit [mm];Folge [mm]\n" + "".join(f"{a};{b}\n" for a, b in comma),
        "quoted": 'sep=;\n"No";"Theta (deg)";"S (Pos)";\n'
        + "".join(f'"{k}";"{a}";"{b}";\n' for k, (a, b) in enumerate(comma)),
        "units": "Knife 3\nMaster\tSlave\n[mm]\t[mm]\n" + "".join(f"{a}\t{b}\n" for a, b in pairs),
        "program": f"' knife\nBASE(1)\nTABLE(10, {values})\nCAMBOX(10, 130, 1, 600, 0, 4)\n",
        "computed": "n = 30\n"
        "FOR p = 0 TO n\nTABLE(p, ((-SIN(PI * 2 * p / n) / (PI * 2)) + p / n) * 400)\nNEXT p\nCAMBOX(0, n, 1, 600, 0)\n",
        "moves": "up = 100\nMOVELINK(50, up, up, 0, 1, 16)\nMOVELINK(200, 200, 0, 0, 1)\nFLEXLINK(300, -150, 300, 0, 0, 50, 50, 1, 3072)\n",
        "tcpou": '<?xml version="1.0"?>\n<TcPlcObject><POU><Declaration><![CDATA[PROGRAM A\nVAR p : ARRAY[1..6] OF '
        f"MC_MotionFunctionPoint; END_VAR]]></Declaration><ST><![CDATA[{points}]]></ST></POU></TcPlcObject>",
        "trace commas": "Zeit [ms];Soll [mm];Ist [mm]\n" + "".join(row.replace(",", ";", 1) for row in times),
        "trace scope": scope + "".join(f"{k}\t{a}\t{k}\t{b}\n" for k, (a, b) in enumerate(comma)) + "EOF\n",
    }


def main() -> int:
    """Fuzz, and print the counts."""
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 300.0
    texts = {**sources(), **foreign()}
    counts: collections.Counter[str] = collections.Counter()
    job = load_job()
    end, number, slowest, size = time.monotonic() + seconds, 0, 0.0, 0
    while time.monotonic() < end:
        number += 1
        dice = random.Random(number)  # noqa: S311 - the number makes the same file again
        name = dice.choice(list(texts))
        data = damaged(texts[name], dice)
        begin = time.process_time()
        try:
            text = decode(data, "cam")
            if name.startswith("trace"):
                unwrapped(read_trace_csv(text, "trace"), "trace")
                counts["recordings"] += 1
                continue
            target = LAYOUTS[name] if name in LAYOUTS and dice.random() < 0.7 else detect(text, "cam")
            table = read_table(target, text, "cam")
            counts["read"] += 1
            counted = without_rounding(whole_cycle(table, job, "cam").table)
            target.rebuild(table if counted is None else counted.table)
            counts["rebuilt"] += 1
        except InputError as error:
            counts["refused"] += 1
            if not str(error) or len(str(error)) > 1000:
                print(f"file {number} ({name}): a refusal without reason or end: {str(error)[:200]!r}")
                return 1
        except Exception:  # noqa: BLE001 - whatever else it is, it is what is looked for
            traceback.print_exc()
            print(f"file {number} ({name}) raised: {data[:200]!r}")
            return 1
        took = time.process_time() - begin
        slowest = max(slowest, took)
        now = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        size = now if number == 1000 else size
        if took > LONGEST or (size and now - size > GROWTH):
            print(f"file {number} ({name}) took {took:.2f} s, the process {now} kB")
            return 1
    print(f"{number} files in {seconds:g} s: {dict(counts)}; the slowest took {slowest:.3f} s")
    return 0


if __name__ == "__main__":
    sys.exit(main())
