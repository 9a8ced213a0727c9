"""Where a machine has its sync zone, as files that hold a cam state it: ``sync_at: 1.7 rad``."""

from __future__ import annotations

import re

from camwright.jobs.wording import place_of
from camwright.profiles.errors import InputError
from camwright.profiles.machines import Machine


def place_in(machine: Machine, text: str) -> str | None:
    """Find the number that the head of a file gives as the place of a machine's sync zone; nothing where it gives none."""
    if not machine.place_name:
        return None
    found = re.search(rf"\b{machine.place_name}: ([0-9.eE+-]{{1,30}}) {machine.slave_unit}\b", text)
    return found[1] if found else None


def not_placed(machine: Machine, file: str) -> InputError:
    """Say that neither file nor job knows the place."""
    return InputError(
        f"{file}: does not say where on the {machine.noun} its sync zone lies, and neither does the job; give "
        f"{place_of(f'machine.{machine.place_name}')}"
    )
