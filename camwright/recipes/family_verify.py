"""Verifying the folder of a family: nothing changed, and its sheet says what its cams do when they are run again."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from camwright.answers.measures import band_answer, objective_unit
from camwright.house.json_text import to_json
from camwright.house.owned import LIST
from camwright.house.provenance import camwright_version, provenance
from camwright.jobs.job import parse_job
from camwright.jobs.numbers import job_numbers
from camwright.jobs.servos import servos_of
from camwright.production.family_cams import PHASES, SPEEDS
from camwright.production.switching import change_speeds
from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import CamProfile
from camwright.recipes.family_record import parse_family
from camwright.recipes.family_sheet import FAMILY_FILE, PAGE, PRINT, family_sheets
from camwright.recipes.folder import contents, sum_faults
from camwright.recipes.recipe_file import RECIPE_FILE
from camwright.recipes.sheet_faults import differs
from camwright.recipes.table_faults import Fault
from camwright.stored.design_file import StoredDesign, parse_design
from camwright.studies.covering import FOUND_TO
from camwright.studies.speed_band import job_band
from camwright.validation.production.cam_change import CamChange, change_checks
from camwright.validation.production.motion_table import ShiftCam
from camwright.validation.production.transition import judge_transition
from camwright.validation.report import judge
from camwright.validation.servo.line_speeds import line_speed_errors


def is_family(directory: Path) -> bool:
    """Whether a directory looks like the folder of a family."""
    return (directory / FAMILY_FILE).is_file() and not (directory / RECIPE_FILE).exists()


def family_faults(directory: Path) -> tuple[list[Fault], list[Fault], list[str]]:
    """Check the folder of a family.

    Checksums of all files, none missing and none added. Where they agree every cam is judged anew and run over its band, every change
    is run anew, and the sheet is set anew of family.json.

    Returns
    -------
    (faults, notes, proved)
        What is wrong; what is no fault and yet to be known; what was proved, where nothing is wrong.

    Raises
    ------
    InputError
        The directory cannot be read.
    """
    data, notes = contents(directory)
    data = {path: content for path, content in data.items() if Path(path).name != LIST}
    faults = list(sum_faults(data))
    content = data.get(FAMILY_FILE)
    if faults or content is None:
        return faults, notes, []
    try:
        record = _record(content)
    except InputError as error:
        return [Fault(FAMILY_FILE, what.removeprefix(f"{FAMILY_FILE}: ")) for what in error.faults], notes, []
    if record["provenance"]["camwright"] != camwright_version():
        what = f"made by camwright {record['provenance']['camwright']}: this version does not compute it anew"
        return [], [*notes, Fault(FAMILY_FILE, what)], [_sums_proved(len(data))]
    missing = [name for cam in record["cams"] if (name := f"cam-{cam['cam']}.design.json") not in data]
    if missing:
        return [Fault(name, "missing: family.json has the cam") for name in missing], notes, []
    designs = [
        parse_design((data[f"cam-{cam['cam']}.design.json"] or b"").decode(), f"cam-{cam['cam']}.design.json")
        for cam in record["cams"]
    ]
    faults = [
        Fault(FAMILY_FILE, what)
        for what in _said_twice(record, designs, {Path(path).parts[0] for path in data if len(Path(path).parts) > 1})
    ]
    if faults:
        return faults, notes, []
    faults = [Fault(FAMILY_FILE, what) for what in (*_cam_faults(record, designs), *_change_faults(record, designs))]
    remade = family_sheets(record)
    if data.get(PAGE) != remade[PAGE]:
        faults.append(Fault(PAGE, f"is not what this camwright makes of {FAMILY_FILE}"))
    if data.get(PRINT) != remade[PRINT]:
        notes.append(
            Fault(PRINT, f"is not what this camwright makes of {FAMILY_FILE}, or of other typesetting libraries")
        )
    proved = [
        _sums_proved(len(data)),
        f"{len(designs)} cams, judged and run over their bands anew, have the recorded sync errors",
        f"{2 * len(record['switching'])} changes, run anew, have the recorded checks",
        f"{PAGE} says what {FAMILY_FILE} says",
        "not proved: that the tables are these motions (audit tells), nor who wrote them",
    ]
    return faults, notes, [] if faults else proved


def _sums_proved(files: int) -> str:
    return f"{files} files have the checksums of the manifest, none is missing or added"


def _record(content: bytes) -> dict[str, Any]:
    """Read a family.json whose checksum is that of the manifest."""
    record = parse_family(content)
    if to_json(record).encode() != content:
        raise InputError(f"{FAMILY_FILE}: its bytes are not those that were written")
    return record


def _said_twice(record: dict[str, Any], designs: list[StoredDesign], folders: set[str]) -> Iterator[str]:
    """Compare what follows from the job's text, from the designs, or from other values of the file."""
    job = parse_job(record["toml"], f"{FAMILY_FILE}, toml")
    origin = record["provenance"]
    libraries, version = origin["libraries"], origin["schema_version"]
    stated = {
        "job": job.name,
        "si": json.loads(to_json(job_numbers(job))),
        "line_speeds_m_per_s": list(job.line_speeds),
        "bands_found_to": FOUND_TO,
        "provenance": {**provenance(job.sha256), "libraries": libraries, "schema_version": version},
        "passed": all(each["passed"] for each in (*record["cams"], *record["switching"], *record["seams"].values())),
    }
    for key, value in stated.items():
        if record[key] != value:
            yield f"{key} is {record[key]!r}, by the job's text and the rest of the file it is {value!r}"
    if [cam["cam"] for cam in record["cams"]] != list(range(1, len(designs) + 1)) or not designs:
        yield "cams are not numbered from 1 on"
    if not folders <= set(record["seams"]):
        yield f"seams are of {sorted(record['seams'])}, tables are for {sorted(folders)}"
    motions = {design.job.name: json.loads(to_json(design.profile.to_dict())) for design in designs}
    if record["profiles"]["cams"] != motions:
        yield "profiles.cams are not those of the designs"
    pairs = [(each["slower"], each["faster"]) for each in record["switching"]]
    if pairs != [(number, number + 1) for number in range(1, len(designs))]:
        yield f"switching is between {pairs}, not from each cam to the next"
    if len(record["cams"]) < record["at_least"] or record["fewest"] is not (len(record["cams"]) == record["at_least"]):
        yield "cams, fewest and at_least do not agree"


def _cam_faults(record: dict[str, Any], designs: list[StoredDesign]) -> Iterator[str]:
    """Run every cam over its band again."""
    for cam, design in zip(record["cams"], designs, strict=True):
        job, name = design.job, f"cams.{cam['cam']}"
        if list(job.line_speeds) != cam["band_m_per_s"]:
            yield f"{name}.band_m_per_s: {list(job.line_speeds)}, recorded {cam['band_m_per_s']}"
        speeds = np.linspace(cam["band_m_per_s"][0], cam["band_m_per_s"][1], SPEEDS)
        errors = line_speed_errors(design.profile, job.task, servos_of(job), speeds, PHASES).max(axis=1)
        tolerance = job.cut.sync_tolerance
        yield from differs(f"{name}.worst_sync_error_m", float(errors[0]), cam["worst_sync_error_m"], tolerance)
        yield from differs(
            f"{name}.worst_of_all_servos_m", float(errors.max()), cam["worst_of_all_servos_m"], tolerance
        )
        report = judge(design.profile, job.task, job.servo, servo_aware=True, slowest=job.slowest)
        failed = [check.name for check in report.checks if not check.passed]
        band = band_answer(job_band(design.profile, job, report))
        found = {
            "failed_checks": failed,
            "sync_tolerance_m": tolerance,
            "name": job.name,
            "speed_band_binds": band["speed_band_binds"],
        }
        recorded, again = (np.array(each["speed_band"]) for each in (cam, band))
        if recorded.shape != again.shape or not np.allclose(recorded, again, rtol=1e-6):
            yield f"{name}.speed_band: {band['speed_band']}, recorded {cam['speed_band']}"
        for key, value in found.items():
            if cam[key] != value:
                yield f"{name}.{key}: {value}, recorded {cam[key]}"
        if (cam["objective"]["name"], cam["objective"]["unit"]) != (job.objective, objective_unit(job)):
            yield f"{name}.objective: {job.objective} in {objective_unit(job)}, recorded {cam['objective']}"
        if cam["passed"] and failed:
            yield f"{name}.passed: False, recorded True"


def _change_faults(record: dict[str, Any], designs: list[StoredDesign]) -> Iterator[str]:
    """Run every change again."""
    between = {(each["from"], each["to"]): each["profile"] for each in record["profiles"]["transitions"]}
    for each in record["switching"]:
        for way, pair in (("up", (each["slower"], each["faster"])), ("down", (each["faster"], each["slower"]))):
            change = each["transition"][way]
            if change["how"] == "stop":
                continue
            before, after = (designs[number - 1] for number in pair)
            zeros = [design.job.task.slave_zero(design.profile) for design in (before, after)]
            profile = between.get(pair)
            middle = None if profile is None else ShiftCam(CamProfile.from_dict(profile), zeros[1])
            run = CamChange(
                ShiftCam(before.profile, zeros[0]),
                ShiftCam(after.profile, zeros[1]),
                (before.job.task, after.job.task.at_speed(each["both_hold_m_per_s"][1])),
                middle,
            )
            checks = change_checks(run, servos_of(after.job), change_speeds(*each["both_hold_m_per_s"]))
            if middle is not None:
                checks = [*judge_transition(middle.profile, zeros[1], run.tasks[1]), *checks]
            place, recorded = f"switching.{pair[0]}-{pair[1]}", change["checks"]
            if [check.name for check in checks] != [check["name"] for check in recorded]:
                yield f"{place}: checks {', '.join(check['name'] for check in recorded)} recorded, which are not those run"
                continue
            for check, other in zip(checks, recorded, strict=True):
                yield from differs(f"{place}.{check.name}", check.value, other["value"], abs(check.limit or 1.0))
                if check.passed is not other["passed"]:
                    yield f"{place}.{check.name}.passed: {check.passed}, recorded {other['passed']}"
