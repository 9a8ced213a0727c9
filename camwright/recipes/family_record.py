"""What a family.json has: its keys and their types, none missing, none more."""

from __future__ import annotations

import json
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field
from pydantic.dataclasses import dataclass

from camwright.recipes.family_sheet import FAMILY_FILE
from camwright.recipes.model import RecipeCheck, RecipeObjective
from camwright.recipes.recipe_file import parse_record

_STRICT = ConfigDict(strict=True, extra="forbid", allow_inf_nan=False)


@dataclass(frozen=True, config=_STRICT)
class FamilyCamRecord:
    """A cam and what was found of it."""

    cam: int
    name: str
    band_m_per_s: tuple[float, float]
    objective: RecipeObjective
    worst_sync_error_m: float
    worst_of_all_servos_m: float
    designed_sync_error_m: float | None
    sync_tolerance_m: float
    speed_band: list[tuple[float, float]]
    speed_band_binds: list[str]
    failed_checks: list[str]
    passed: bool


@dataclass(frozen=True, config=_STRICT)
class ChangeRecord:
    """How it goes from one cam to the next."""

    how: str
    name: str | None
    velocity_jump_m_per_s: float
    acceleration_jump_m_per_s2: float
    position_jump_m: float
    checks: list[RecipeCheck]


@dataclass(frozen=True, config=_STRICT)
class WaysRecord:
    """Both ways between two cams."""

    up: ChangeRecord
    down: ChangeRecord


@dataclass(frozen=True, config=_STRICT)
class SwitchingRecord:
    """Two neighbours and where the controller changes."""

    slower: int
    faster: int
    up_m_per_s: float
    down_m_per_s: float
    both_hold_m_per_s: tuple[float, float]
    how: str
    hold_line_speed: bool
    transition: WaysRecord
    passed: bool


@dataclass(frozen=True, config=_STRICT)
class SeamsRecord:
    """What was found at the seams of a target's tables."""

    number_format: str
    velocity_jump_m_per_s: float
    acceleration_jump_m_per_s2: float
    position_jump_m: float
    passed: bool
    withheld: dict[str, str]
    refused: list[str]


@dataclass(frozen=True, config=_STRICT)
class OriginRecord:
    """What made it of which job."""

    camwright: str
    job_sha256: str
    libraries: dict[str, str]
    schema_version: int


@dataclass(frozen=True, config=_STRICT)
class ProfileRecord:
    """A profile."""

    breaks: list[float]
    coefficients: list[list[float]]


@dataclass(frozen=True, config=_STRICT)
class TransitionRecord:
    """A designed cycle from one cam to another."""

    before: Annotated[int, Field(alias="from")]
    to: int
    profile: ProfileRecord


@dataclass(frozen=True, config=_STRICT)
class ProfilesRecord:
    """All motions."""

    cams: dict[str, ProfileRecord]
    transitions: list[TransitionRecord]


@dataclass(frozen=True, config=_STRICT)
class FamilyRecord:
    """All of it."""

    job: str
    line_speeds_m_per_s: tuple[float, float]
    overlap: float
    cams: list[FamilyCamRecord]
    fewest: bool
    at_least: int
    bands_found_to: float
    switching: list[SwitchingRecord]
    seams: dict[str, SeamsRecord]
    passed: bool
    hold_line_speed: bool
    language: Literal["en", "de", "zh"]
    toml: str
    si: dict[str, Any]
    provenance: OriginRecord
    profiles: ProfilesRecord


def parse_family(content: bytes) -> dict[str, Any]:
    """Read a family.json.

    Raises
    ------
    InputError
        It is none of this version: each fault with its place in the file.
    """
    parse_record(FamilyRecord, content, FAMILY_FILE)
    return dict(json.loads(content))
