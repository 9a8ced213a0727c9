"""What the cases of the golden run read: jobs of every kind, traces, cams and drawings."""

from __future__ import annotations

import json
import math
import re

MOTIONS = ("peak_acceleration", "rms_acceleration", "peak_jerk", "rms_jerk")
OBJECTIVES = (*MOTIONS, "rms_torque", "peak_torque", "energy")
COMMANDS = ("in_sync", "shaped")


def replaced(text: str, *changes: tuple[str, str]) -> str:
    """Replace pieces of a text, each of which must be there."""
    for old, new in changes:
        if old not in text:
            raise SystemExit(f"golden: {old!r} is not in the example any more; mend golden.py")
        text = text.replace(old, new)
    return text


def with_objective(text: str, **values: str | bool) -> str:
    """Give a job another table ``[objective]``."""
    lines = [
        f"{key} = {str(value).lower() if isinstance(value, bool) else json.dumps(value)}"
        for key, value in values.items()
    ]
    table = "\n".join(["[objective]", *lines, "", ""])
    changed, count = re.subn(r"^\[objective\]\n.*?(?=^\[)", lambda _: table, text, flags=re.MULTILINE | re.DOTALL)
    if count != 1:
        raise SystemExit("golden: an example has no [objective] before another table; mend golden.py")
    return changed


def sweep(time: float, size: float, last: float) -> float:
    """Command of a trace: a sine from half a hertz to a last frequency in 2 s, at rest before."""
    return size * math.sin(2 * math.pi * (0.5 + (last - 0.5) * time / 4.0) * time) if time > 0 else 0.0


def run_and_cam() -> tuple[str, str]:
    """Record 12 cuts of the bundled job with the quintic return, the axis late by 0.2 ms and losing 4 µm a cut; and that cam as a table."""

    def cam(master: float) -> float:
        cycle, place = divmod(master, 0.6)
        part = min(place / 0.4, 1.0)
        return 0.4 * cycle + place - 0.2 * part**3 * (10 - 15 * part + 6 * part**2)

    rows = ["time [ms],master [mm],command [mm],actual [mm]"]
    for row in range(2700):
        time = 2e-3 * row
        master, late = (0.1 + 80 / 60 * (time - lag) for lag in (0.0, 2e-4))
        actual = cam(late) - 4e-6 * ((master + 0.1) // 0.6)
        rows.append(f"{time * 1e3:.1f},{master * 1e3:.5f},{cam(master) * 1e3:.5f},{actual * 1e3:.5f}")
    points = [f"{600 * k / 1200:.4f},{cam(0.6 * k / 1200 if k < 1200 else 0.6 - 1e-15) * 1e3:.8f}" for k in range(1201)]
    return "\n".join(rows) + "\n", "\n".join(["x [mm],y [mm]", *points]) + "\n"


def trace(feedforward: float, last: float, unit: str = "mm", scale: float = 1e3) -> str:
    """Record a servo of 120 rad/s, damping 0.7, gain 35 1/s and 4 ms at 1 kHz over 2 s, with 2 ms of dead time and some noise.

    Parameters
    ----------
    feedforward
        Share of the velocity that is fed forward.
    last
        Highest frequency of the command (Hz).
    unit, scale
        Unit of the columns, and how many of it there are in the servo's own.

    Returns
    -------
    str
        The trace as CSV.
    """
    bandwidth, damping, gain, sample, dead, size = 120.0, 0.7, 35.0, 0.004, 0.002, 0.02
    rows, parts = 2000, 4
    step = 1e-3 / parts

    def slope(state: tuple[float, float, float], held: float) -> tuple[float, float, float]:
        jerk = bandwidth**2 * (held - state[1]) - 2 * damping * bandwidth * state[0]
        return jerk, state[0], state[1]

    def moved(
        state: tuple[float, float, float], by: tuple[float, float, float], h: float
    ) -> tuple[float, float, float]:
        return state[0] + h * by[0], state[1] + h * by[1], state[2] + h * by[2]

    state, before, held = (0.0, 0.0, 0.0), 0.0, 0.0
    lines = [f"time [ms],command [{unit}],actual [{unit}]"]
    for row in range(rows):
        if row % 4 == 0:
            now = sweep(row * 1e-3 - dead, size, last)
            held = gain * (now - state[2]) + feedforward * (now - before) / sample
            before = now
        noise = 1e-5 * math.sin(12.9898 * row * row)
        lines.append(f"{row:d},{sweep(row * 1e-3, size, last) * scale:.9f},{(state[2] + noise) * scale:.9f}")
        for _ in range(parts):  # Runge and Kutta
            a = slope(state, held)
            b = slope(moved(state, a, step / 2), held)
            c = slope(moved(state, b, step / 2), held)
            d = slope(moved(state, c, step), held)
            mean = tuple((p + 2 * q + 2 * r + s) / 6 for p, q, r, s in zip(a, b, c, d, strict=True))
            state = moved(state, (mean[0], mean[1], mean[2]), step)
    return "\n".join(lines) + "\n"


def dxf(*lines: tuple[float, float, float, float], units: int = 4) -> str:
    """Draw straight lines as a DXF file."""
    parts = f"0 SECTION 2 HEADER 9 $ACADVER 1 AC1009 9 $INSUNITS 70 {units} 0 ENDSEC 0 SECTION 2 ENTITIES".split()
    for x, y, u, v in lines:
        parts += f"0 LINE 8 CUT 10 {x} 20 {y} 11 {u} 21 {v}".split()
    return "\n".join([*parts, "0", "ENDSEC", "0", "EOF", ""])


def plain_cam() -> str:
    """Make someone's cam of the paper's cut: a table of positions, a straight line and a sine."""
    rows = [f"{600 * i / 240!r},{400 * i / 240 - 20 * math.sin(2 * math.pi * i / 240)!r}" for i in range(241)]
    return "\n".join(["x [mm],y [mm]", *rows]) + "\n"


def aware_jobs(examples: dict[str, str]) -> dict[str, str]:
    """Make servo-aware jobs: all objectives and both commands for the short cut, some for the others."""
    jobs = {}
    chosen = {
        "short-cut": (*OBJECTIVES, "sync_error"),
        "chasing-shear": ("rms_torque", "sync_error"),
        "flying-saw": ("energy", "peak_acceleration"),
        "paper-600": (*MOTIONS, "sync_error"),
        "thick-product": ("rms_torque", "peak_jerk"),
    }
    for example, objectives in chosen.items():
        if example in examples:
            for command in COMMANDS:
                for name in objectives:
                    text = with_objective(examples[example], servo_aware=True, command=command, minimise=name)
                    jobs[f"{example}--{command}-{name}"] = text
    return jobs


def other_jobs(examples: dict[str, str]) -> dict[str, str]:
    """Make jobs with keys that no example has."""
    paper, saw = examples["paper-600"], examples["flying-saw"]
    shear, thick, short = examples["chasing-shear"], examples["thick-product"], examples["short-cut"]
    curve = 'motor = [["0 rpm", "60 N m"], ["3000 rpm", "60 N m"], ["4000 rpm", "40 N m"]]\n\n[servo]'
    return {
        "paper--zero-at-cut": replaced(paper, ('origin = "return"', 'origin = "cut"')),
        "paper--reversal": replaced(paper, ("reversal = false", "reversal = true"), ('"600 mm"', '"900 mm"')),
        "paper--dead-time": replaced(
            paper, ("velocity_feedforward = 1.0", 'velocity_feedforward = 0.8\ndead_time = "3 ms"\nlead_time = "1 ms"')
        ),
        "paper--inches": replaced(paper, ('"600 mm"', '"24 in"'), ('"400 mm"', '"16 in"'), ('"80 m/min"', '"250 ft/min"')),
        "paper--sync-ratio": replaced(paper, ("sync_tolerance =", "sync_ratio = 1.05\nsync_tolerance =")),
        "paper--slower": replaced(paper, ('"80 m/min"', '"70 m/min"')),
        "paper--unstable": replaced(paper, ('"35 1/s"', '"400 1/s"')),
        "saw--motor": replaced(saw, ("[servo]", curve)),
        "saw--home": replaced(saw, ('"0 mm"', '"100 mm"')),
        "saw--light": replaced(saw, ('"180 kg"', '"0 kg"'), ('"rms_torque"', '"rms_acceleration"')),
        "shear--motor": replaced(shear, ("[servo]", curve.replace("60 N m", "3 N m").replace("40 N m", "2 N m"))),
        "shear--placed": replaced(shear, ("gear_ratio = 10 ", 'sync_at = "80 deg"\ngear_ratio = 10 ')),
        "shear--offset": replaced(shear, ('offset = "0 mm"', 'offset = "30 mm"')),
        "thick--tangential": replaced(thick, ('"horizontal"', '"tangential"')),
        "thick--torque": with_objective(replaced(thick, ('"40 deg"', '"120 mm"')), minimise="rms_torque"),
        "short--wide": replaced(short, ('bandwidth = "10 %"', 'bandwidth = ["110 rad/s", "125 rad/s"]\ndead_time = ["0 ms", "1 ms"]')),
        "short--blind": with_objective(short, minimise="rms_jerk"),
    }  # fmt: skip


def infeasible_jobs(examples: dict[str, str]) -> dict[str, str]:
    """Make jobs that no motion can do, or none that passes."""
    paper, shear, thick = examples["paper-600"], examples["chasing-shear"], examples["thick-product"]
    return {
        "paper--short": replaced(paper, ('"600 mm"', '"300 mm"')),
        "paper--fast": replaced(paper, ('"80 m/min"', '"190 m/min"')),
        "saw--weak": replaced(examples["flying-saw"], ('"6 m/s^2"', '"0.5 m/s^2"')),
        "saw--stroke": replaced(examples["flying-saw"], ('"1200 mm"', '"750 mm"')),
        "shear--weak": replaced(shear, ('"400 rad/s^2"', '"4 rad/s^2"')),
        "shear--short": replaced(shear, ('"900 mm"', '"200 mm"')),
        "thick--weak": replaced(thick, ('"60 m/s^2"', '"0.2 m/s^2"')),
        "short--exact": replaced(examples["short-cut"], ('"0.25 mm"', '"0.001 mm"')),
        "short--in-sync": replaced(examples["short-cut"], ('"shaped"', '"in_sync"')),
    }


def faulty_jobs(examples: dict[str, str]) -> dict[str, str | bytes]:
    """Make job files with faults of every kind."""
    paper, saw, shear = examples["paper-600"], examples["flying-saw"], examples["chasing-shear"]
    short = examples["short-cut"]
    return {
        "not-toml": replaced(paper, ("[cut]", "[cut")),
        "half": paper[: paper.index("[limits]")],
        "empty": "\n",
        "latin-1": paper.replace("The rotary", "Die Säge").encode("latin-1"),
        "binary": bytes(range(256)),
        "name": replaced(paper, ('"paper-600"', '"a/b"')),
        "kind": replaced(paper, ('"rotary_knife"', '"saw"')),
        "typo": replaced(paper, ("circumference", "circumfrence"), ("jerk =", "jrek =")),
        "bare-numbers": replaced(paper, ('"600 mm"', "600"), ('"4 ms"', "4")),
        "units": replaced(paper, ('"600 mm"', '"600 mn"'), ('"80 m/min"', '"80 mm"'), ('"120 rad/s"', '"120 1/s"')),
        "ranges": replaced(paper, ('"600 mm"', '"-600 mm"'), ("damping = 0.7", "damping = 0"), ("points = 361", "points = 1")),
        "many": replaced(
            paper, ("reversal = false", "reversal = 1"), ('"return"', '"middle"'), ("0.7", "nan"), ('"35 1/s"', '"1e99 1/s"')
        ),
        "zones": replaced(paper, ('sync_zone = "200 mm"', 'sync_zone = "650 mm"')),
        "shear-zone": replaced(paper, ('shear_zone = "40 mm"', 'shear_zone = "240 mm"')),
        "no-inertia": with_objective(paper, minimise="rms_torque"),
        "objective": with_objective(paper, minimise="jerk"),
        "sync-error": with_objective(paper, minimise="sync_error"),
        "command": with_objective(paper, minimise="peak_jerk", command="shaped"),
        "no-shear-zone": with_objective(replaced(paper, ('"40 mm"', '"0 mm"')), servo_aware=True, minimise="sync_error"),
        "few-points": replaced(paper, ("points = 361", "points = 3")),
        "speed": replaced(paper, ('"200 m/min"', '"20 m/min"')),
        "saw-units": replaced(saw, ('"6 m/s^2"', '"6 rad/s^2"')),
        "shear-rod": replaced(shear, ('"600 mm"', '"100 mm"')),
        "shear-units": replaced(shear, ('"300 rpm"', '"3 m/s"')),
        "tolerance": replaced(short, ('damping = "10 %"', 'damping = "120 %"'), ('"5 %"', '["40 1/s", "30 1/s"]')),
        "motor": replaced(paper, ("[servo]", 'motor = [["0 rpm", "12 N m"]]\n\n[servo]')),
        "motor-falls": replaced(saw, ("[servo]", 'motor = [["10 rpm", "12 N m"], ["5 rpm", "3 N m"]]\n\n[servo]')),
    }  # fmt: skip


def inputs(examples: dict[str, str]) -> dict[str, str | bytes]:
    """Make the files that the cases read, by path in the scratch directory; the examples are copied."""
    files: dict[str, str | bytes] = {}
    for example, text in examples.items():
        for name in OBJECTIVES:
            files[f"jobs/objective/{example}--{name}.toml"] = with_objective(text, minimise=name)
    for group, make in (("aware", aware_jobs), ("other", other_jobs), ("infeasible", infeasible_jobs)):
        files |= {f"jobs/{group}/{name}.toml": text for name, text in make(examples).items()}
    files |= {f"jobs/faulty/{name}.toml": content for name, content in faulty_jobs(examples).items()}
    good, (run, quintic) = trace(1.0, 15.0), run_and_cam()
    lines = good.splitlines(keepends=True)
    files |= {
        "lists/order.csv": "length [mm],quantity,kind\n1400,2,cut\n900,1,skip\n900,1,crop\n1400,1,cut\n",
        "lists/faulty.csv": "length,quantity\n600 mm,3\n300,3\n",
        "lists/line.csv": "time [s],speed [m/min]\n0,0\n20,10\n60,10\n",
        "traces/assumed.csv": good,
        "traces/run.csv": run,
        "traces/run-without-master.csv": "\n".join(
            ",".join(line.split(",")[:1] + line.split(",")[2:]) for line in run.splitlines()
        ),
        "traces/quintic.csv": quintic,
        "traces/fitted.csv": trace(0.9, 30.0),
        "traces/turning.csv": trace(0.0, 20.0, "deg", 180 / math.pi),
        "traces/gap.csv": "".join(lines[:900] + lines[950:]),
        "traces/short.csv": "".join(lines[:100]),
        "traces/no-unit.csv": good.replace(" [mm]", ""),
        "traces/no-number.csv": good.replace(lines[500], lines[500].split(",")[0] + ",nan,1\n"),
        "traces/stands.csv": lines[0] + "".join(f"{i},1.0,1.0\n" for i in range(1000)),
        "cams/plain.csv": plain_cam(),
        "cams/no-y.csv": "x [mm],z [mm]\n0,0\n1,1\n2,2\n3,3\n",
        "cams/other-length.csv": plain_cam().replace("\n600.0,", "\n601.0,"),
        "cams/columns.txt": plain_cam().split("\n", 1)[1].replace(",", ";"),
        "cams/nonsense.st": "PROGRAM nothing\nEND_PROGRAM\n",
        "drawings/step.dxf": dxf((0, 0, 22, 0), (22, 0, 22, 22), (22, 22, 34.5, 22)),
        "drawings/square.dxf": dxf((0, 0, 60, 0), (60, 0, 60, 60), (60, 60, 0, 60), (0, 60, 0, 0)),
        "drawings/crossing.dxf": dxf((0, 0, 60, 0), (60, 0, 60, 60), (60, 60, 30, 60), (30, 60, 30, -20)),
        "drawings/no-unit.dxf": dxf((0, 0, 60, 0), (60, 0, 60, 60), units=0),
        "drawings/no-length.dxf": dxf((0, 0, 60, 0), (60, 0, 60, 0)),
        "drawings/nothing.dxf": dxf(),
        "drawings/nonsense.dxf": "this is no drawing\n",
        "benders/typo.toml": "name = 3\n[rule]\nthicknes = \"0.71 mm\"\n",
        "benders/bends.csv": "mould_deg,workpiece_deg\n10,9\n5,x\n",
    }  # fmt: skip
    return files
