"""The calls of the workbench: what the command line answers, and nothing for those who should not ask."""

from __future__ import annotations

import base64
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from starlette.testclient import TestClient

from camwright.cli.main import main
from camwright.jobs.job import BUNDLED_JOB, parse_job
from camwright.profiles.errors import InputError
from camwright.stored.design_text import design_text
from camwright.studies.design import optimise
from camwright.workbench.preview import preview
from camwright.workbench.saving import Saved

PAPER = BUNDLED_JOB.read_text(encoding="utf-8")
EXAMPLES = Path(__file__).parents[2] / "examples"
SHORT = PAPER.replace('"600 mm"', '"300 mm"')


def said(capsys: pytest.CaptureFixture[str], *arguments: str) -> Any:
    main(arguments)
    return json.loads(capsys.readouterr().out)


def test_the_page_begins_with_the_job_and_its_keys(bench: TestClient) -> None:
    answer = bench.get("/api/job").json()
    assert (answer["toml"], answer["name"]) == (PAPER, "paper-600")
    assert {"cut.length", "servo.damping"} <= {key["path"] for key in answer["keys"]}
    assert "workbench" in bench.get("/", params={"token": "t0ken"}).text


@pytest.mark.parametrize("call", ["check", "compare", "limits"])
def test_an_answer_is_the_command_lines(
    call: str, bench: TestClient, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("job.toml").write_text(PAPER)
    options = ["--no-figures"] if call == "compare" else []
    answer = bench.post(f"/api/{call}", json={"toml": PAPER})
    assert answer.status_code == 200
    expected = said(capsys, call, "job.toml", "--json", *options)
    assert {key: value for key, value in answer.json().items() if key not in ("exit_code", "contents")} == expected


def test_what_is_exported_is_byte_for_byte_the_command_lines(
    bench: TestClient, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("job.toml").write_text(PAPER)
    assert main(["design", "job.toml", "--no-figures", "--quiet", "--out", "out"]) == 0
    assert main(["export", "out/design.json", "--to", "codesys,logix", "--quiet", "--out", "tables"]) == 0
    answer = bench.post("/api/export", json={"toml": PAPER, "targets": ["codesys", "LOGIX"]}).json()
    expected = {path.as_posix(): path.read_bytes() for place in ("out", "tables") for path in Path(place).iterdir()}
    assert {path: base64.b64decode(data) for path, data in answer["contents"].items()} == expected


def test_a_recording_is_judged_as_by_the_command_line(bench: TestClient) -> None:
    design = optimise(parse_job(PAPER, "job"))
    times = np.arange(0.0, 2.0, 1e-3)
    command = 1e3 * design.profile(times * design.job.cut.line_speed, outside="repeat")
    rows = "".join(f"{1e3 * t:.1f},{y:.5f},{y - 0.03:.5f}\n" for t, y in zip(times, command, strict=True))
    data = base64.b64encode(f"time [ms],command [mm],actual [mm]\n{rows}".encode()).decode()
    body = {"toml": PAPER, "design": design_text(design), "name": "scope.csv", "base64": data}
    answer = bench.post("/api/trace", json=body).json()
    assert answer["exit_code"] in (0, 1)
    assert len(answer["cuts"]) >= 3
    assert bench.post("/api/identify", json={"name": "x.csv", "base64": "eA=="}).json()["exit_code"] == 2


def test_a_drawing_is_bent_as_by_the_command_line(
    bench: TestClient, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawing = EXAMPLES / "bender" / "carton.dxf"
    body = {"name": "C:\\drawings\\carton.dxf", "base64": base64.b64encode(drawing.read_bytes()).decode()}
    answer = bench.post("/api/bend", json=body).json()
    monkeypatch.chdir(tmp_path)
    Path("dropped").mkdir()
    Path("dropped/carton.dxf").write_bytes(drawing.read_bytes())
    assert (
        main(["bend", "dropped/carton.dxf", "--styles", "all", "--out", "bent", "--quiet"]) == 1
    )  # the part meets the mould
    expected = {path.as_posix(): path.read_bytes() for path in Path("bent").iterdir()}
    found = {path: base64.b64decode(text) for path, text in answer["contents"].items()}
    assert found == expected


def test_a_recipe_and_an_audit(bench: TestClient) -> None:
    answer = bench.post("/api/recipe", json={"toml": PAPER, "targets": ["csv"], "language": "zh"}).json()
    assert base64.b64decode(answer["contents"]["recipe/recipe.pdf"]).startswith(b"%PDF")
    table = next(data for path, data in answer["contents"].items() if "/tables/" in path and path.endswith("_cam.csv"))
    judged = bench.post("/api/audit", json={"toml": PAPER, "name": "../../running.csv", "base64": table})
    assert judged.status_code == 200
    assert judged.json()["exit_code"] == 0


@pytest.mark.parametrize("name", sorted(path.stem for path in EXAMPLES.glob("*.toml")))
def test_every_example_has_a_preview(name: str) -> None:
    shown = preview((EXAMPLES / f"{name}.toml").read_text(encoding="utf-8"), ("linear_return", "poly_3_4_5"))
    moved = (
        {"torque"}
        if parse_job((EXAMPLES / f"{name}.toml").read_text(encoding="utf-8"), name).machine.moves_something
        else set()
    )
    assert set(shown["samples"]) == {"x_m", "y", "ratio", "speed", "acceleration", "jerk"} | moved
    assert len({len(values) for values in shown["samples"].values()}) == 1
    for limit, values in (("speed", "speed"), ("acceleration", "acceleration"), ("jerk", "jerk")):
        assert max(map(abs, shown["samples"][values])) <= shown["limits"][limit] * (1 + 1e-6)
    assert shown["laws"].keys() == {"linear_return", "poly_3_4_5"}


def test_torque_stands_beside_what_the_motor_gives() -> None:
    curve = 'motor = [["0 rpm", "2.2 N m"], ["500 rpm", "2 N m"], ["2500 rpm", "0.9 N m"]]\n\n[servo]'
    text = (EXAMPLES / "flying-saw.toml").read_text(encoding="utf-8").replace("[servo]", curve)
    shown = preview(text)["samples"]
    speed = np.abs(shown["speed"]) / 0.04 * 60  # rpm of a screw of 40 mm
    assert shown["available_torque"] == pytest.approx(np.interp(speed, [0, 500, 2500], [2.2, 2.0, 0.9]), abs=2e-6)
    assert "available_torque" not in preview(text.replace(curve, "[servo]"))["samples"]


def test_a_preview_of_a_motion_objective_is_the_design(bench: TestClient) -> None:
    shown = bench.post("/api/preview", json={"toml": PAPER}).json()
    designed = bench.post("/api/design", json={"toml": PAPER}).json()
    assert shown["exact"] is True
    assert shown["objective"]["value"] == pytest.approx(designed["objective"]["value"], rel=1e-9)
    assert shown["binding"] == ["reversal", "jerk"]
    torque = (EXAMPLES / "flying-saw.toml").read_text(encoding="utf-8")
    assert preview(torque)["exact"] is False


def test_an_impossible_job_is_refused_with_its_ways_out(bench: TestClient) -> None:
    for call in ("preview", "design"):
        answer = bench.post(f"/api/{call}", json={"toml": SHORT})
        assert answer.status_code == 200
        assert answer.json()["exit_code"] == 3
        assert answer.json()["binding"] == "jerk"
    assert {"change": "length", "value": 337.0, "unit": "mm"} in bench.post("/api/design", json={"toml": SHORT}).json()[
        "suggestions"
    ]


def test_faults_name_their_fields(bench: TestClient) -> None:
    faulty = PAPER.replace('"600 mm"', "600").replace('"4 ms"', '"4 mm"')
    answer = bench.post("/api/check", json={"toml": faulty})
    assert (answer.status_code, answer.json()["exit_code"]) == (200, 2)
    assert [fault["field"] for fault in answer.json()["faults"]] == ["cut.length", "servo.sample_time"]


@pytest.mark.parametrize(
    ("call", "body", "message"),
    [
        ("check", {}, 'the body has no "toml"'),
        ("check", [1], "the body is no JSON object"),
        ("preview", {"toml": PAPER, "laws": "all"}, '"laws" is a list'),
        ("design", {"toml": PAPER, "figures": "yes"}, "\"figures\" is 'yes'; it is true or false"),
        ("envelope", {"toml": PAPER, "points": 1000}, '"points" is 1000; it is a whole number from 2 to 40'),
        ("export", {"toml": PAPER, "targets": ["../x"]}, "there is no target '../x'"),
        ("export", {"toml": PAPER, "targets": "csv"}, '"targets" is a list of names'),
        ("export", {"toml": PAPER, "units": "--force"}, "\"units\" is '--force'"),
        ("recipe", {"toml": PAPER, "language": "fr"}, "\"language\" is 'fr'"),
        ("audit", {"toml": PAPER, "name": "a.csv"}, 'a file is sent as its "name" and its bytes as "base64"'),
        ("audit", {"toml": PAPER, "name": "a.csv", "base64": "?"}, '"base64" is no base64'),
        ("bend", {"name": "a.dxf"}, 'a file is sent as its "name" and its bytes as "base64"'),
        ("overlay", {"toml": PAPER, "name": 5, "base64": ""}, 'a file is sent as its "name"'),
        ("servo", {"toml": PAPER}, 'the body has no "design", the text of a design.json'),
        ("servo", {"design": "{}", "share": "fast"}, "\"share\" is 'fast'; it is a number"),
    ],
)
def test_what_cannot_be_asked_is_refused(call: str, body: Any, message: str, bench: TestClient) -> None:
    answer = bench.post(f"/api/{call}", json=body)
    assert answer.status_code == 422
    assert message in answer.json()["message"]


def test_no_json_and_no_such_call(bench: TestClient) -> None:
    assert "the body is no JSON" in bench.post("/api/check", content=b"\xff").json()["message"]
    assert '"toml" holds half a sign' in bench.post("/api/check", content=b'{"toml": "\\ud800"}').json()["message"]
    assert bench.post("/api/nothing", json={"toml": PAPER}).status_code == 404
    assert bench.get("/api/design").status_code == 405


def test_saving_writes_two_files_and_nothing_else(bench: TestClient, folder: Path) -> None:
    before = {path.name for path in folder.iterdir()}
    answer = bench.post("/api/save", json={"toml": PAPER})
    assert answer.json() == {"files": ["job.toml", "design.json"]}
    assert {path.name for path in folder.iterdir()} - before == {"job.toml", "design.json"}
    assert (folder / "job.toml").read_text() == PAPER
    refused = bench.post("/api/save", json={"toml": SHORT})
    assert refused.json()["exit_code"] == 3
    assert (folder / "job.toml").read_text() == PAPER


def test_saving_writes_over_what_the_page_began_with_or_saved_and_nothing_else(tmp_path: Path) -> None:
    (tmp_path / "job.toml").write_text(PAPER)
    saved, other = Saved(tmp_path, PAPER), PAPER.replace("600 mm", "610 mm")
    saved.put(other, design_text(optimise(parse_job(other, "job"))).encode())
    saved.put(PAPER, design_text(optimise(parse_job(PAPER, "job"))).encode())
    assert sorted(path.name for path in tmp_path.iterdir()) == ["design.json", "job.toml"]
    (tmp_path / "job.toml").write_text("# mine\n" + PAPER)
    with pytest.raises(InputError, match=r"job\.toml: another job stands in the folder"):
        saved.put(PAPER, b"{}")
    (tmp_path / "job.toml").unlink()
    (tmp_path / "design.json").write_text("[1]")
    with pytest.raises(InputError, match=r"design\.json: another job stands in the folder"):
        saved.put(PAPER, b"{}")
    assert [path.name for path in tmp_path.iterdir()] == ["design.json"]


def test_the_command_says_where_it_listens_and_refuses_a_taken_port(
    address: str, capsys: pytest.CaptureFixture[str]
) -> None:
    port = address.split(":")[2].partition("/")[0]
    assert address.startswith("http://127.0.0.1:")
    assert main(["workbench", "--port", port, "--no-browser"]) == 2
    assert f"--port {port}: cannot be listened on" in capsys.readouterr().err
