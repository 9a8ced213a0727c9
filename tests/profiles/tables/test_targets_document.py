"""The document of the targets is made from the registry and from files written by the tests."""

from __future__ import annotations

import re

from targets_document import DOCUMENT, document

from camwright.profiles.tables.targets import TARGETS


def test_the_document_is_up_to_date() -> None:
    made = re.sub(r"[0-9.e-]{6,}", "#", document())  # the last digits may differ from machine to machine
    assert re.sub(r"[0-9.e-]{6,}", "#", DOCUMENT.read_text(encoding="utf-8")) == made, (
        "run python tests/profiles/tables/targets_document.py"
    )


def test_every_target_says_what_it_is() -> None:
    for target in TARGETS.values():
        assert not target.tested_on_controller
        assert len(target.steps) >= 2
        assert all(step.endswith(".") and len(step) > 15 for step in target.steps)
        assert target.evidence.endswith(".")
