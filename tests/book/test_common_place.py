"""Books of cranks whose sync zone lies at one place for all lengths."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from camwright.cli.main import main

CRANK = (Path(__file__).parents[2] / "examples" / "chasing-shear.toml").read_text(encoding="utf-8")


def book(
    folder: Path, job: str, capsys: pytest.CaptureFixture[str], *options: str
) -> tuple[dict[str, object], set[float]]:
    path = folder / "job.toml"
    path.write_text(job.replace('"rms_torque"', '"peak_acceleration"'))
    out = folder / f"book{len(list(folder.iterdir()))}"
    call = [
        "book",
        str(path),
        "--length",
        "500:900:400",
        "--line-speed",
        "30",
        "--jobs",
        "1",
        "--out",
        str(out),
        "--json",
        *options,
    ]
    assert main(call) == 0
    answer: dict[str, object] = json.loads(capsys.readouterr().out)
    designs = [json.loads(file.read_text()) for file in sorted(out.rglob("design.json"))]
    assert len(designs) == 2
    return answer, {design["job"]["si"]["machine"]["sync_at"] for design in designs}


@pytest.mark.slow
def test_one_place_for_all_designs_and_what_it_costs(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plain, own = book(tmp_path, CRANK, capsys)
    assert len(own) == 2
    assert "common_place" not in plain
    answer, place = book(tmp_path, CRANK, capsys, "--common-place")
    common = answer["common_place"]
    assert isinstance(common, dict)
    assert sorted(place) == pytest.approx([common["place_rad"]])
    assert common["compared"] == 2
    assert -1e-6 <= common["cost_share"] < 0.5


def test_a_knife_has_one_place_anyway(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    job = (Path(__file__).parents[2] / "examples" / "paper-600.toml").read_text(encoding="utf-8")
    path = tmp_path / "job.toml"
    path.write_text(job)
    call = [
        "book",
        str(path),
        "--length",
        "600",
        "--line-speed",
        "80",
        "--jobs",
        "1",
        "--out",
        str(tmp_path / "book"),
        "--json",
    ]
    assert main([*call, "--common-place"]) == 0
    assert json.loads(capsys.readouterr().out)["common_place"] == {
        "place_m": None, "cost_share": 0.0, "cost_at_mm": None, "compared": 0,
    }  # fmt: skip
