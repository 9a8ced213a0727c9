"""The errors of the whole house, one class for each party at fault."""

from __future__ import annotations

from dataclasses import dataclass

from camwright.profiles.message import Message


class CamwrightError(Exception):
    """Base of every error that camwright raises on purpose.

    ``exit_code`` is what the command line ends with when the error reaches it.

    Examples
    --------
    >>> from camwright import CamwrightError, InfeasibleError, InputError, MissingExtraError, SolverError
    >>> [error.exit_code for error in (InputError, InfeasibleError, SolverError)], issubclass(MissingExtraError, CamwrightError)
    ([2, 3, 4], True)
    """

    exit_code: int = 1


class InputError(CamwrightError):
    """The input is at fault: a job file, a table, an option, an argument.

    Parameters
    ----------
    faults
        One message for each fault found, in the order in which they stand in the input. A message holds the quantity, its
        value and unit, the limit, the place, and the way out; where it is a `Message` it is kept, for the front door to word.

    Examples
    --------
    >>> from camwright import InputError
    >>> InputError("length = 400: a number without a unit", "speed: missing").faults
    ('length = 400: a number without a unit', 'speed: missing')
    """

    exit_code = 2

    def __init__(self, *faults: str | Message) -> None:
        super().__init__("\n".join(map(str, faults)))
        self.messages: tuple[str | Message, ...] = faults

    @property
    def faults(self) -> tuple[str, ...]:
        """The messages in plain words."""
        return tuple(map(str, self.messages))


@dataclass(frozen=True)
class Suggestion:
    """A single change that makes an infeasible job work.

    Parameters
    ----------
    change
        What to change: ``"line_speed"``, ``"length"``, ``"line_speeds"``, or the name of a limit.
    value, unit
        The nearest value that works, in the unit named; for ``"reversal"`` 1 and no unit; for ``"line_speeds"`` where they begin.
    """

    change: str
    value: float
    unit: str


@dataclass(frozen=True)
class Covered:
    """What of a job's band of line speeds can be held where no one command holds all of it.

    Parameters
    ----------
    part
        Line speeds (m/s), the least and the job's own, over which one command keeps the tolerance; ``None`` where that was not looked for
        or there is no such part.
    family
        Bands of line speeds (m/s) that one cam each holds and which together cover the job's; ``None`` where that was not looked for or
        there are none.
    """

    part: tuple[float, float] | None = None
    family: tuple[tuple[float, float], ...] | None = None


class InfeasibleError(CamwrightError):
    """Physics is at fault: no motion keeps the limits.

    Parameters
    ----------
    message
        What binds, by how much, and what would work.
    binding
        Name of the limit that binds (``"speed"``, ``"acceleration"``, ``"jerk"``, ``"reversal"``).
    excess, unit
        By how much the limit would have to be exceeded, in the unit named; None if no value of this limit alone would do.
    suggestions
        Single changes that work, each checked.
    covered
        What of the job's line speeds can be held, where no one command holds all of them.

    Examples
    --------
    >>> from dataclasses import replace
    >>> from camwright import InfeasibleError, load_job, optimise
    >>> job = load_job()
    >>> try:
    ...     optimise(replace(job, limits=replace(job.limits, jerk=100.0)))
    ... except InfeasibleError as error:
    ...     print(error.binding, error.exit_code, [suggestion.change for suggestion in error.suggestions][:2])
    jerk 3 ['line_speed', 'length']
    """

    exit_code = 3

    def __init__(
        self,
        message: str | Message,
        binding: str,
        excess: float | None,
        unit: str,
        suggestions: tuple[Suggestion, ...],
        covered: Covered = Covered(),
    ) -> None:
        super().__init__(str(message))
        self.message = message
        self.binding = binding
        self.excess = excess
        self.unit = unit
        self.suggestions = suggestions
        self.covered = covered


class SolverError(CamwrightError):
    """The solver is at fault: it ended without an answer although the problem has one.

    Examples
    --------
    >>> from camwright import SolverError
    >>> SolverError.exit_code
    4
    """

    exit_code = 4


class MissingExtraError(InputError):
    """A library of an optional extra is not installed.

    Parameters
    ----------
    library
        What could not be imported.
    extra
        The extra of camwright that brings it.

    Examples
    --------
    >>> from camwright import MissingExtraError
    >>> print(MissingExtraError("typst", "recipe"))
    typst is not installed. It comes with: pip install 'camwright[recipe]'
    """

    def __init__(self, library: str, extra: str) -> None:
        super().__init__(f"{library} is not installed. It comes with: pip install 'camwright[{extra}]'")
