"""Tables by powers of the line speed as files: read back, summed, judged, and what cannot have them."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from camwright.cli.main import main
from camwright.drives.running_cam import running_cam
from camwright.drives.speed_tables import SpeedTables, speed_tables
from camwright.jobs.job import BUNDLED_JOB, Job, parse_job
from camwright.profiles.errors import InputError
from camwright.profiles.tables.targets import TARGETS, read_table, target_of
from camwright.profiles.tables.text import decode

TEXT = BUNDLED_JOB.read_text(encoding="utf-8")


def job(*changes: tuple[str, str]) -> Job:
    text = TEXT
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    return parse_job(text, "job")


@pytest.fixture(scope="module")
def made() -> SpeedTables:
    easy = ('length = "600 mm"', 'length = "450 mm"'), ('"30 m/s^2"', '"60 m/s^2"'), ('"3000 m/s^3"', '"9000 m/s^3"')
    return speed_tables(job(*easy), target_of("twincat"))


def test_files_are_the_tables_and_their_sum_passes(made: SpeedTables) -> None:
    assert made.passed
    assert made.error <= 2e-5
    assert made.judged[-1].alone > made.judged[-1].error
    names = [name for name in made.files if name.endswith(".st")]
    assert len(names) == len(made.cam.tables)
    for power, name in enumerate(names):
        table = read_table(target_of("twincat"), decode(made.files[name].encode(), name), name)
        assert f"-v{power}" in made.files[name]
        with pytest.raises(
            InputError, match=f"the table is number {power} of 0 to {len(names) - 1} that the controller adds"
        ):
            running_cam(made.files[name], name, job())
        x = np.array(table.x)
        assert np.array(table.y) * 1e-3 == pytest.approx(made.cam.tables[power](x * 1e-3), abs=1e-12)
    steps = made.files[next(name for name in made.files if name.endswith(".txt"))]
    assert "MC_CamAdd" in steps
    assert "infosys" in steps


def test_what_cannot_have_them_is_refused_with_the_reason() -> None:
    with pytest.raises(InputError, match=r"trio has no documented way .* --to twincat$"):
        speed_tables(job(), target_of("trio"))
    assert [name for name, target in TARGETS.items() if target.adds_scaled] == ["twincat"]
    sealer = Path("examples/cross-sealer.toml").read_text(encoding="utf-8")
    with pytest.raises(InputError, match="changes in its sync zone"):
        speed_tables(parse_job(sealer, "job"), target_of("twincat"))


def test_a_line_speed_that_fails_releases_none(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "job.toml").write_text(TEXT, encoding="utf-8")
    assert main(["design", str(tmp_path / "job.toml"), "--no-figures", "--quiet", "--out", str(tmp_path / "d")]) == 0
    capsys.readouterr()
    call = ["export", str(tmp_path / "d" / "design.json"), "--to", "twincat", "--speed-tables"]
    assert main([*call, "--json", "--out", str(tmp_path / "t")]) == 1
    answer = json.loads(capsys.readouterr().out)["targets"][0]
    assert not answer["passed"]
    assert answer["files"] == []
    assert not (tmp_path / "t").exists()
    failed = [at["line_speed_m_per_min"] for at in answer["line_speeds"] if at["failed"]]
    assert answer["passes_up_to_m_per_min"] < min(failed)
