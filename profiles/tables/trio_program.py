"""Statements of a program in Trio's BASIC, and what its expressions come to."""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import lru_cache

from camwright.profiles.errors import InputError
from camwright.profiles.tables.cam_table import LARGEST_VALUE
from camwright.profiles.tables.text import lines_of, refuse, shown

MOST_STEPS = 200_000
"""Statements that loops may come to."""
_DEEPEST = 20
"""Loops inside one another."""
_LONGEST = 200
"""Signs of the longest expression that is computed."""

_GIVEN = re.compile(r"(?:DEFCONST\s+([A-Za-z]\w{0,59})\s+|([A-Za-z]\w{0,59})\s*=)(.*)", re.IGNORECASE)
_CHANGED = re.compile(r"(?:.*\bTHEN\s+([A-Za-z]\w{0,59})\s*=|([A-Za-z]\w{0,59})\s*\.\s*\w{1,20}\s*=).*", re.IGNORECASE)
_FOR = re.compile(r"FOR\s+([A-Za-z]\w{0,59})\s*=\s*(.+?)\s+TO\s+(.+?)(?:\s+STEP\s+(.+))?", re.IGNORECASE)
_GOES_ON = re.compile(r"(?:^|[\s,(+*/=-])_\s*$")
"""A line whose statement goes on in the next; a name may end with the sign, too."""
_NEXT = re.compile(r"NEXT\b.*", re.IGNORECASE)
_TOKEN = re.compile(r"\s*(?:((?:\d{1,30}\.?\d{0,30}|\.\d{1,30})(?:[eE][-+]?\d{1,3})?)|([A-Za-z]\w{0,59})|([-+*/^()]))")

_FUNCTIONS: dict[str, Callable[[float], float]] = {
    "sin": math.sin, "cos": math.cos, "tan": math.tan, "atan": math.atan, "sqr": math.sqrt, "exp": math.exp, "ln": math.log,
    "abs": abs, "int": math.trunc,
}  # fmt: skip
_JOINED: dict[str, tuple[int, Callable[[float, float], float]]] = {
    "+": (1, operator.add),
    "-": (1, operator.sub),
    "*": (2, operator.mul),
    "/": (2, operator.truediv),
    "^": (4, math.pow),
}
_SIGN = 3
"""How strongly a sign binds: before a product, behind a power."""


def numbered_statements(text: str, place: str) -> Iterator[tuple[int, str]]:
    """Go through a program's statements, each with the number of its first line.

    Lines are cut at colons, without what stands behind an apostrophe; one that ends with an underscore goes on in the next.
    """
    first, begun = 0, ""
    for number, line in enumerate(lines_of(text, place), start=1):
        first = first if begun else number
        plain = begun + line.partition("'")[0]
        if _GOES_ON.search(plain):
            begun = plain.rstrip()[:-1]
            continue
        begun = ""
        yield from ((first, part.strip()) for part in plain.split(":") if part.strip())
    if begun:
        yield first, begun.strip()


@dataclass(frozen=True)
class Numbers:
    """What a program's variables are.

    Parameters
    ----------
    given
        The one expression that the program gives each, names in small letters; ``None`` where it gives more than one.
    loops
        Values of the variables of the loops at hand.
    """

    given: Mapping[str, str | None]
    loops: Mapping[str, float | None] = field(default_factory=dict)

    @classmethod
    def of(cls, text: str, place: str) -> Numbers:
        """Find what a program gives its variables, wherever it stands."""
        given: dict[str, str | None] = {}
        for _, statement in numbered_statements(text, place):
            if found := _GIVEN.fullmatch(statement):
                name, value = (found[1] or found[2]).lower(), found[3].strip()
                given[name] = value if given.setdefault(name, value) == value else None
            elif changed := _CHANGED.fullmatch(statement):
                given[(changed[1] or changed[2]).lower()] = None
        return cls(given)

    def within(self, name: str, value: float | None) -> Numbers:
        """Give the variables inside a loop over one of them; ``None`` where its values are not known."""
        return Numbers(self.given, {**self.loops, name.lower(): value})

    def value(self, text: str, place: str, line: int) -> float:
        """Compute an expression.

        Raises
        ------
        InputError
            It is none, or holds a variable to which the program does not give one number.
        """
        try:
            value = self._computed(text.strip(), ())
        except (ValueError, ArithmeticError, RecursionError) as error:
            why = f": {error}" if isinstance(error, _UnknownError) else ""
            raise refuse(place, line, f"{shown(text.strip())} is not a number{why}") from error
        if not abs(value) <= LARGEST_VALUE:
            raise refuse(place, line, f"{shown(text.strip())} is beyond {LARGEST_VALUE:g}")
        return value

    def whole(self, text: str, place: str, line: int) -> int:
        """Compute an expression that must be a whole number."""
        value = self.value(text, place, line)
        if value != round(value):
            raise refuse(place, line, f"{shown(text.strip())} is not a whole number")
        return round(value)

    def _computed(self, text: str, inside: tuple[str, ...]) -> float:
        tokens = list(_tokens(text))
        value = self._sum(tokens, 0, inside)
        if tokens:
            raise ValueError(text)
        return value

    def _sum(self, tokens: list[str], least: int, inside: tuple[str, ...]) -> float:
        """Take what binds at least so strongly off the front of the tokens."""
        value = self._atom(tokens, inside)
        while tokens and tokens[0] in _JOINED and _JOINED[tokens[0]][0] >= least:
            strength, join = _JOINED[tokens.pop(0)]
            value = join(value, self._sum(tokens, strength + 1, inside))
        return value

    def _atom(self, tokens: list[str], inside: tuple[str, ...]) -> float:
        """Take a number, a variable, a function or what stands in brackets."""
        if not tokens:
            raise ValueError("it ends too early")
        part = tokens.pop(0)
        if part in "+-":
            value = self._sum(tokens, _SIGN, inside)
            return value if part == "+" else -value
        if part == "(":
            return self._closed(tokens, inside)
        if part[0] in ".0123456789":
            return float(part)
        name = part.lower()
        if name in _FUNCTIONS and tokens and tokens[0] == "(":
            tokens.pop(0)
            return float(_FUNCTIONS[name](self._closed(tokens, inside)))
        return self._variable(name, inside)

    def _closed(self, tokens: list[str], inside: tuple[str, ...]) -> float:
        value = self._sum(tokens, 0, inside)
        if not tokens or tokens.pop(0) != ")":
            raise ValueError("a bracket is not closed")
        return value

    def _variable(self, name: str, inside: tuple[str, ...]) -> float:
        if name in self.loops:
            value = self.loops[name]
            if value is None:
                raise _UnknownError(f"what {name} runs over is not known")
            return value
        meant = self.given.get(name)
        if meant is not None and name not in inside:
            return self._computed(meant, (*inside, name))
        if name == "pi":
            return math.pi
        raise _UnknownError(f"the program does not give {name} one number")


class _UnknownError(ValueError):
    """A variable that is not known."""


@lru_cache(maxsize=256)
def _tokens(text: str) -> tuple[str, ...]:
    """Take an expression apart."""
    if len(text) > _LONGEST:
        raise ValueError("too long")
    found, at = [], 0
    while at < len(text):
        token = _TOKEN.match(text, at)
        if token is None:
            raise ValueError(text)
        found.append(token[1] or token[2] or token[3])
        at = token.end()
    return tuple(found)


def run(text: str, place: str, numbers: Numbers) -> Iterator[tuple[int, str, Numbers]]:
    """Go through a program's statements as its loops repeat them, each with the variables there; nothing else is executed.

    Raises
    ------
    InputError
        Loops come to more than `MOST_STEPS` statements.
    """
    statements = list(numbered_statements(text, place))
    for step, (line, statement, known) in enumerate(_run(statements, (0, len(statements)), numbers, place)):
        if step >= MOST_STEPS:
            raise refuse(place, line, f"the loops of the program come to more than {MOST_STEPS} statements")
        yield line, statement, known


def _run(
    statements: list[tuple[int, str]], part: tuple[int, int], numbers: Numbers, place: str, depth: int = 0
) -> Iterator[tuple[int, str, Numbers]]:
    """Go through some of the statements."""
    at, last = part
    while at < last:
        line, statement = statements[at]
        loop = _FOR.fullmatch(statement)
        if loop is None:
            yield line, statement, numbers
            at += 1
            continue
        if depth >= _DEEPEST:
            raise refuse(place, line, f"more than {_DEEPEST} loops lie inside one another")
        end = _end_of(statements, at, last)
        for value in _values(loop, numbers, place, line):
            yield line, statement, numbers  # so that empty loops are counted too
            yield from _run(statements, (at + 1, end), numbers.within(loop[1], value), place, depth + 1)
        at = end + 1


def _end_of(statements: list[tuple[int, str]], at: int, last: int) -> int:
    """Find the statement that closes a loop; the end where none does."""
    depth = 0
    for later in range(at, last):
        depth += 1 if _FOR.fullmatch(statements[later][1]) else -1 if _NEXT.fullmatch(statements[later][1]) else 0
        if depth == 0:
            return later
    return last


def _values(loop: re.Match[str], numbers: Numbers, place: str, line: int) -> Iterator[float | None]:
    """Values of a loop's variable; once an unknown one where its bounds are not known."""
    try:
        start, end, step = (numbers.value(text, place, line) for text in (loop[2], loop[3], loop[4] or "1"))
    except InputError:
        yield None
        return
    if step == 0.0:
        raise refuse(place, line, f"{shown(loop[0])} never ends")
    count = math.floor(min((end - start) / step + 1e-9, MOST_STEPS)) + 1
    yield from (start + step * k for k in range(count))
