"""What a structured text holds: declarations, assignments, calls and their values, and what table readers ask of them."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from camwright.profiles.tables.text import refuse, shown


@dataclass(frozen=True, slots=True)
class Struct:
    """A structured initial value ``(a := 1, b := 2)``; member names in lower case."""

    members: dict[str, Value]
    line: int


@dataclass(frozen=True, slots=True)
class Call:
    """A call ``a.b(x, y := z)``; its name in lower case without what stands before the last point, and whether arguments have names."""

    name: str
    arguments: tuple[Value, ...]
    line: int
    named: bool = False


@dataclass(frozen=True, slots=True)
class Word:
    """An enumeration value or a variable, as written: ``MC_X.Y``."""

    text: str

    @property
    def last(self) -> str:
        """What stands behind the last point, in lower case."""
        return self.text.rpartition(".")[2].lower()


@dataclass(frozen=True, slots=True)
class Other:
    """An expression that is not a plain value."""

    line: int


Value = float | Word | Struct | Call | Other | list["Value"]


@dataclass(frozen=True, slots=True)
class Declaration:
    """A variable: its name, its type (of the elements, if an array), the array's bounds, and its initial value."""

    name: str
    type: str
    bounds: tuple[tuple[int, int], ...]
    value: Value | None
    line: int


@dataclass(frozen=True, slots=True)
class Assignment:
    """``path := value``: the path as lower-case names and indices."""

    path: tuple[str | int, ...]
    value: Value
    line: int


@dataclass(frozen=True)
class Program:
    """What was found in a text; of assignments under an index that nobody knows, what is assigned to, and the line."""

    declarations: tuple[Declaration, ...]
    assignments: tuple[Assignment, ...]
    calls: tuple[Call, ...]
    unplaced: tuple[tuple[str, int], ...] = ()

    def arrays_of(self, type_name: str) -> list[Declaration]:
        """List the arrays of a type that have an initial value."""
        wanted = type_name.lower()
        return [d for d in self.declarations if d.bounds and d.type == wanted and d.value is not None]


def number_of(value: Value | None, what: str, place: str, line: int) -> float:
    """Take a member that must be a number; a member that was left out is 0."""
    if value is None:
        return 0.0
    if not isinstance(value, float):
        raise refuse(place, line, f"{what} must be a number")
    return value


def structs_of(declaration: Declaration, place: str) -> list[Struct]:
    """Take an array's initial value as structures, as many as its bounds say."""
    value = declaration.value
    if not isinstance(value, list) or not all(isinstance(item, Struct) for item in value):
        raise refuse(
            place, declaration.line, f"the array {shown(declaration.name)} must be a list of ( member := value )"
        )
    low, high = declaration.bounds[0]
    if len(value) != high - low + 1:
        raise refuse(
            place,
            declaration.line,
            f"the array {shown(declaration.name)} has {high - low + 1} places but {len(value)} values",
        )
    return [item for item in value if isinstance(item, Struct)]


def assigned_to(
    program: Program, known: Collection[str], place: str, array: str = "", noun: str = "point", unread: str = ""
) -> dict[int, Struct]:
    """Gather what is assigned to members of an array's elements, by index.

    Parameters
    ----------
    known
        Members, in lower case.
    array
        Name of the array; any whose elements have such members where not given.
    noun
        What messages call an element.
    unread
        What is said of another member of that array, with a place for it.

    Raises
    ------
    InputError
        The text fills more than one array, a member twice, or one that is not known.
    """
    found: dict[int, Struct] = {}
    arrays: set[tuple[str | int, ...]] = set()
    for entry in program.assignments:
        if len(entry.path) < 3 or not isinstance(entry.path[-2], int) or (array and entry.path[-3] != array):
            continue
        member, index = str(entry.path[-1]), entry.path[-2]
        if member not in known:
            if array:
                raise refuse(place, entry.line, unread.format(shown(member)))
            continue
        arrays.add(entry.path[:-2])
        if len(arrays) > 1:
            raise refuse(place, entry.line, "the text fills more than one array of points; leave one in the file")
        members = found.setdefault(index, Struct({}, entry.line)).members
        if member in members:
            raise refuse(place, entry.line, f"{shown(member)} of {noun} {index} is given twice")
        members[member] = entry.value
    return dict(sorted(found.items()))


def in_turn(points: Mapping[int, Struct], place: str) -> list[Struct]:
    """List points in the order of their indices, of which none may be missing."""
    for (before, _), (index, struct) in pairwise(points.items()):
        if index != before + 1:
            raise refuse(place, struct.line, f"the points have a gap: {index} follows {before}")
    return list(points.values())


def numbers_of(structs: Sequence[Struct], members: Sequence[str], place: str) -> list[list[float]]:
    """Take members of structures as columns of numbers."""
    return [[number_of(s.members.get(m.lower()), m, place, s.line) for s in structs] for m in members]


def only(declarations: list[Declaration], what: str, place: str) -> Declaration:
    """Take the one declaration that there must be."""
    if not declarations:
        raise refuse(place, None, f"there is no {what} with an initial value")
    if len(declarations) > 1:
        names = ", ".join(shown(d.name) for d in declarations[:5])
        raise refuse(place, declarations[1].line, f"there is more than one {what}: {names}; leave one in the file")
    return declarations[0]
