"""`Recipe`: the one data model that every file of a recipe folder is made from."""

from __future__ import annotations

from typing import Any, Final, Literal

from pydantic import ConfigDict
from pydantic.dataclasses import dataclass

from camwright.house.language import Language

RECIPE_VERSION: Final = 1
"""Version of the layout of recipe.json; it changes when an older reader would misread the file."""

_STRICT = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)


@dataclass(frozen=True, config=_STRICT)
class Profile:
    """One cycle as pieces of polynomials, as in a design.json.

    Parameters
    ----------
    breaks
        Ends of the pieces on the master (m).
    coefficients
        Per piece, ascending powers of the distance from its first break (slave unit per m**power).
    """

    breaks: tuple[float, ...]
    coefficients: tuple[tuple[float, ...], ...]


@dataclass(frozen=True, config=_STRICT)
class JobRecord:
    """The job: its text, and its numbers in SI units.

    Parameters
    ----------
    toml
        The job file as it was read.
    si
        The same in plain SI numbers, with everything that the design chose; laid out as in a design.json.
    """

    toml: str
    si: dict[str, Any]


@dataclass(frozen=True, config=_STRICT)
class RecipeObjective:
    """What was minimised, and its value at the job's line speed."""

    name: str
    value: float | None
    unit: str


@dataclass(frozen=True, config=_STRICT)
class Zones:
    """Where the zones lie on the master, as parts of the period ``[0, cut length]`` (m): two parts over the seam."""

    sync: tuple[tuple[float, float], ...]
    shear: tuple[tuple[float, float], ...]


@dataclass(frozen=True, config=_STRICT)
class RecipeCheck:
    """One judgement: as `camwright.validation.check.Check`, SI units."""

    name: str
    passed: bool
    value: float | None
    limit: float | None
    unit: str
    at: float | None
    source: str


@dataclass(frozen=True, config=_STRICT)
class AtSpeed:
    """What to expect at a share of the line speed, the cam over the master being the same (SI units).

    Parameters
    ----------
    share
        Share of the job's line speed, 1 for all of it.
    line_speed
        The line speed (m/s).
    speed, acceleration, jerk
        Peaks of the slave (slave unit over s, s², s³); ``None`` where unbounded.
    motor_speed
        Peak speed of the motor (rad/s).
    peak_torque, rms_torque
        Torque of the motor (N·m); ``None`` where the job says nothing of what is moved.
    following_error
        Greatest command minus axis (m); ``None`` for an unstable servo, like all below.
    sync_error
        Greatest sync error in the shear zone (m).
    length_offset, length_offset_with_lead, length_variation
        As `camwright.validation.servo.lead.LengthError` (m): mean sync error in the shear zone, positive where the tool is late and
        the piece too
        long; the same with the recipe's lead time set; what changes from cut to cut.
    worst_sync_error
        The greatest sync error with any servo at the corners of the job's ranges (m); ``None`` where the job gives none.
    """

    share: float
    line_speed: float
    speed: float
    acceleration: float | None
    jerk: float | None
    motor_speed: float
    peak_torque: float | None
    rms_torque: float | None
    following_error: float | None
    sync_error: float | None
    length_offset: float | None
    length_offset_with_lead: float | None
    length_variation: float | None
    worst_sync_error: float | None = None


@dataclass(frozen=True, config=_STRICT)
class Edge:
    """One end of a range: the value (SI), and what binds there; ``None`` where nothing ends the range.

    Parameters
    ----------
    binding
        A limit, ``"reversal"``, ``"stroke"``, ``"sync_zone"``, ``"motor"``; ``"axis"`` where it leaves its tolerance; ``"none"`` where
        nothing ends the range, ``"not_found"`` where no end was found.
    """

    value: float | None
    binding: str


@dataclass(frozen=True, config=_STRICT)
class WorkingRange:
    """How far a machine can go at the job's other numbers: cut lengths (m) and line speeds (m/s)."""

    min_length: Edge
    max_length: Edge
    min_line_speed: Edge
    max_line_speed: Edge


@dataclass(frozen=True, config=_STRICT)
class SpeedPart:
    """Line speeds at which this cam passes every check, without a gap between (m/s), and what binds at both ends: names of checks."""

    low: float
    high: float
    low_binding: str
    high_binding: str


@dataclass(frozen=True, config=_STRICT)
class RampRecord:
    """A start or a stop: slave travel (slave unit), master (m), time (s), peak acceleration (slave unit over s²)."""

    arc: float
    master: float
    time: float
    peak_acceleration: float


@dataclass(frozen=True, config=_STRICT)
class StartStop:
    """How the machine starts into the running line and stops out of it, with least peak acceleration.

    Parameters
    ----------
    standing_up_to
        Highest line speed at which the slave can stand between two cuts (m/s); ``None`` where none was found.
    park
        Slave coordinate at which the slave stands (slave unit); like all below ``None`` where it cannot start and stop at the line speed.
    one_shot_master
        Master that one piece on demand takes (m).
    least_arc
        Least way of a start (slave unit).
    latency, sensor_ahead
        Time from the sensor to the start (s), and how far ahead of the cut at mid sync zone the sensor must stand for this start (m).
    passed
        Whether every check of start and stop passed, the axis from rest among them.
    """

    standing_up_to: float | None
    park: float | None = None
    ramp_in: RampRecord | None = None
    ramp_out: RampRecord | None = None
    one_shot_master: float | None = None
    least_arc: float | None = None
    latency: float | None = None
    sensor_ahead: float | None = None
    passed: bool = False


@dataclass(frozen=True, config=_STRICT)
class MarkEnds:
    """How early (not above zero) and how late a print mark may come (m); ``None`` for no limit."""

    earliest: float | None
    latest: float | None


@dataclass(frozen=True, config=_STRICT)
class MarksAt:
    """How far a print mark may be off at a line speed (m/s), by what the controller does; no offset where it is not in sync."""

    line_speed: float
    redesign: MarkEnds
    master_phase: MarkEnds
    slave_offset: MarkEnds | None


@dataclass(frozen=True, config=_STRICT)
class TableFile:
    """A file of a table: path inside the recipe folder, SHA-256 of its bytes."""

    path: str
    sha256: str


@dataclass(frozen=True, config=_STRICT)
class TableUnit:
    """A unit of a table: symbol, and size in m or rad."""

    symbol: str
    size: float


@dataclass(frozen=True, config=_STRICT)
class Points:
    """The points of a table in its own units, as they were read back; ``None`` for what the table does not hold.

    Parameters
    ----------
    master, slave
        Positions.
    ratio, ratio_slope
        First and second derivative of the slave over the master; ``None`` where a point holds none.
    """

    master: tuple[float, ...]
    slave: tuple[float, ...]
    ratio: tuple[float | None, ...] | None
    ratio_slope: tuple[float | None, ...] | None


@dataclass(frozen=True, config=_STRICT)
class RecipeTable:
    """The cam written for one target, and what the target makes of it.

    Parameters
    ----------
    target, title
        Name of the target; maker and mechanism.
    released
        Whether every check of it and of the cam passed; a table that is not released has no files.
    files
        Its files, the one that holds the points first.
    master_unit, slave_unit
        Units of the points.
    position_error
        Greatest error of the rebuilt position, at the tool for a slave in rad (m).
    ratio_error
        Greatest error of the rebuilt ratio.
    acceleration_error
        Greatest error of the rebuilt acceleration, relative to the peak; ``None`` where it is unbounded.
    within_asked_error
        Whether the errors are below what was asked for.
    wraps
        Cycles that were judged.
    checks
        The checks on the rebuilt motion.
    interpolation, number_format, evidence, tested_on_controller, steps
        As the target states them, in English.
    """

    target: str
    title: str
    released: bool
    files: tuple[TableFile, ...]
    master_unit: TableUnit
    slave_unit: TableUnit
    points: Points
    position_error: float
    ratio_error: float
    acceleration_error: float | None
    within_asked_error: bool
    wraps: int
    checks: tuple[RecipeCheck, ...]
    interpolation: str
    number_format: str
    evidence: str
    tested_on_controller: bool
    steps: tuple[str, ...]


@dataclass(frozen=True, config=_STRICT)
class Refusal:
    """A target that cannot take the cam, and why not."""

    target: str
    reasons: tuple[str, ...]


@dataclass(frozen=True, config=_STRICT)
class RampTables:
    """The tables of a start, a stop or one piece on demand.

    Parameters
    ----------
    profile
        The motion, from zero on the master and the slave.
    tables
        Its tables, in the order of the targets.
    refused
        Targets that cannot take it.
    """

    motion: Literal["ramp_in", "ramp_out", "one_shot"]
    profile: Profile
    tables: tuple[RecipeTable, ...]
    refused: tuple[Refusal, ...]


@dataclass(frozen=True, config=_STRICT)
class Origin:
    """Where the recipe comes from: versions, and the SHA-256 of the job file."""

    camwright: str
    job_sha256: str
    libraries: dict[str, str]


@dataclass(frozen=True, config=_STRICT)
class RampAt:
    """The greatest ramps of the line at one line speed (m/s, m/s²), ``None`` where nothing binds, and what binds."""

    line_speed: float
    acceleration: float | None
    stop: float | None
    binding: str


@dataclass(frozen=True, config=_STRICT)
class LineRampRecord:
    """How hard the line may ramp on this cam, at any phase (SI units).

    Parameters
    ----------
    acceleration
        Greatest ramp up and down between standstill and the job's line speed; ``None`` where nothing binds.
    stop
        Greatest deceleration of an emergency stop from there.
    binding
        ``"acceleration"``, ``"jerk"``, ``"torque"`` or ``"none"``.
    stop_length
        Material that passes in the hardest stop; ``None`` where none is allowed.
    by_acceleration_alone
        What the limit of acceleration alone would allow at the job's line speed.
    by_speed
        The ramps at shares of the line speed, each at that speed alone.
    sync_error
        Greatest sync error while the line ramps as the job says; ``None`` where it says nothing.
    """

    acceleration: float | None
    stop: float | None
    binding: str
    stop_length: float | None
    by_acceleration_alone: float | None
    by_speed: tuple[RampAt, ...]
    sync_error: float | None


@dataclass(frozen=True, config=_STRICT)
class Particulars:
    """What the user gives to stand on the sheet, each any text and never taken from clock or machine."""

    revision: str = ""
    customer: str = ""
    author: str = ""
    date: str = ""


@dataclass(frozen=True, config=_STRICT)
class Recipe:
    """All that one product needs on one machine; SI units, angles in rad.

    Parameters
    ----------
    kind
        Tells the file apart from others.
    note
        What the user wants to be read, any text.
    language
        Language of PDF, HTML and XLSX.
    released
        Whether every check of the design and of every table passed.
    slave_start
        Slave coordinate of the machine where the master is zero (slave unit).
    pitch
        Slave travel per cycle (slave unit).
    checks
        The checks on the cam.
    speeds
        What to expect at shares of the line speed.
    lead_time
        Lead time of the master that makes up for the servo's mean lag (s).
    speed_band
        Line speeds at which this cam is released: parts with gaps between them, none for one that passes nowhere.
    start_stop
        How the machine starts and stops; ``None`` in a recipe of an earlier version.
    marks
        What print marks may ask of it, over the line speed; none in a recipe of an earlier version.
    line_ramp
        How hard the line may ramp; ``None`` in recipes that were made before it was told.
    start_tables
        Tables of start, stop and one piece on demand; none where the machine cannot start and stop at the line speed, and in recipes that
        were made before they were held.
    """

    schema_version: Literal[1]
    kind: Literal["camwright recipe"]
    name: str
    note: str
    language: Language
    released: bool
    job: JobRecord
    slave_unit: Literal["m", "rad"]
    slave_start: float
    pitch: float
    objective: RecipeObjective
    profile: Profile
    zones: Zones
    checks: tuple[RecipeCheck, ...]
    speeds: tuple[AtSpeed, ...]
    lead_time: float
    speed_band: tuple[SpeedPart, ...]
    working_range: WorkingRange
    tables: tuple[RecipeTable, ...]
    refused: tuple[Refusal, ...]
    provenance: Origin
    particulars: Particulars = Particulars()
    start_stop: StartStop | None = None
    marks: tuple[MarksAt, ...] = ()
    line_ramp: LineRampRecord | None = None
    start_tables: tuple[RampTables, ...] = ()
