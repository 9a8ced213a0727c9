"""Reading IEC 61131-3 structured text: declarations with initial values, assignments, calls; the rest is skipped."""

from __future__ import annotations

from dataclasses import dataclass, field

from camwright.profiles.tables.st_program import (
    Assignment,
    Call,
    Declaration,
    Other,
    Program,
    Struct,
    Value,
    Word,
)
from camwright.profiles.tables.st_words import MOST_TOKENS, Token, Words
from camwright.profiles.tables.text import real, shown

DEEPEST = 8
_TYPED = frozenset(
    ("LREAL", "REAL", "INT", "UINT", "DINT", "UDINT", "LINT", "ULINT", "SINT", "USINT", "BYTE", "WORD", "DWORD", "BOOL")
)


@dataclass(frozen=True)
class _Found:
    """Statements found so far, and assignments whose place is not known, by their last name and line."""

    declarations: list[Declaration] = field(default_factory=list)
    assignments: list[Assignment] = field(default_factory=list)
    calls: list[Call] = field(default_factory=list)
    unplaced: list[tuple[str, int]] = field(default_factory=list)


class Reader:
    """Reads one text from its first word to its last; `program` is the result."""

    def __init__(self, text: str, place: str) -> None:
        self.words = Words(text, place)
        self.variables: dict[str, int] = {}
        self._found = _Found()
        self._last = ""

    # -- statements -------------------------------------------------------------------------------------------------

    def program(self) -> Program:
        """Read all statements."""
        while self.words.now.kind != "end":
            if self.words.now.kind == "name":
                self.statement()
            else:
                self.words.step()
        found = self._found
        return Program(tuple(found.declarations), tuple(found.assignments), tuple(found.calls), tuple(found.unplaced))

    def statement(self) -> None:
        """Read a declaration, an assignment or a call; of anything else one word is passed over."""
        line = self.words.line
        if self.words.after.text == ":":
            name = self.words.step().text
            self.words.step()
            self.declaration(name, line)
            return
        if self.words.after.text not in (":=", ".", "[", "("):
            self.words.step()
            return
        path = self.path(0)
        if self.words.accept(":="):
            value = self.value(0)
            if self.words.now.text not in (";", ")", ""):
                value = self.sum_of(value)
            elif isinstance(value, Word) and (number := self.known(value)) is not None:
                value = number
            if path is None:
                self._found.unplaced.append((self._last, line))
            self.assign(path, value, line)
        elif self.words.now.text == "(":
            self._found.calls.append(self.call(str(path[-1]) if path else "", 0))

    def assign(self, path: tuple[str | int, ...] | None, value: Value, line: int) -> None:
        """Note an assignment; whole numbers given to plain variables are remembered, for they serve as indices."""
        if path is None:
            return
        if len(path) == 1 and isinstance(path[0], str):
            if isinstance(value, float) and value == int(value):
                self.variables[path[0]] = int(value)
            else:
                self.variables.pop(path[0], None)
        self._found.assignments.append(Assignment(path, value, line))

    def sum_of(self, value: Value) -> Value:
        """Add a number to a variable, ``point + 1``; any other expression is no number, which table readers refuse."""
        sign = {"+": 1.0, "-": -1.0}.get(self.words.now.text)
        first = self.known(value) if isinstance(value, Word) else None
        if sign is not None and first is not None and self.words.after.kind == "number":
            self.words.step()
            second = self.value(0)
            if isinstance(second, float) and self.words.now.text == ";":
                return first + sign * second
        while self.words.now.text not in (";", ""):
            self.words.step()
        return Other(self.words.line)

    def known(self, value: Value) -> float | None:
        """Find the number that a value is or that its variable was given last."""
        if isinstance(value, Word):
            number = self.variables.get(value.text.lower())
            return None if number is None else float(number)
        return value if isinstance(value, float) else None

    def declaration(self, name: str, line: int) -> None:
        """``name : type := value`` after the colon."""
        bounds: list[tuple[int, int]] = []
        if self.words.accept("ARRAY"):
            self.words.expect("[")
            while True:
                low = self.bound()
                self.words.expect("..")
                bounds.append((low, self.bound()))
                if not self.words.accept(","):
                    break
            self.words.expect("]")
            self.words.expect("OF")
        if self.words.now.kind != "name":
            return
        type_name = self.dotted()
        value: Value | None = None
        if self.words.accept(":="):
            value = self.value(0)
            if self.words.now.text not in (";", ")", ",", ""):
                value = self.sum_of(value)
            if isinstance(value, float) and not bounds and value == int(value):
                self.variables[name.lower()] = int(value)
        self._found.declarations.append(
            Declaration(name, type_name.rpartition(".")[2].lower(), tuple(bounds), value, line)
        )

    def bound(self) -> int:
        """One bound of an array."""
        value = self.known(self.value(0))
        if value is None or value != int(value) or abs(value) > 1e6:
            raise self.words.refusal("an array's bound must be a whole number up to 1000000")
        return int(value)

    def path(self, depth: int) -> tuple[str | int, ...] | None:
        """``a.b[1].c`` as names and indices; ``None`` if an index is not known."""
        parts: list[str | int] = [self.words.step().text.lower()]
        self._last = str(parts[0])
        known = True
        while True:
            if self.words.now.text == "." and self.words.after.kind == "name":
                self.words.step()
                parts.append(self.words.step().text.lower())
                self._last = str(parts[-1])
            elif self.words.now.text == "[":
                self.words.step()
                while True:
                    index = self.known(self.value(depth + 1))
                    if index is None or index != int(index):
                        known = False
                    else:
                        parts.append(int(index))
                    if not self.words.accept(","):
                        break
                if not known:
                    self.words.close("]")
                else:
                    self.words.expect("]")
            else:
                return tuple(parts) if known else None

    # -- values -----------------------------------------------------------------------------------------------------

    def value(self, depth: int) -> Value:
        """Read a number, a word, a structure, an array, or a call."""
        if depth > DEEPEST:
            raise self.words.refusal(f"values are nested more than {DEEPEST} deep")
        if self.words.now.kind in ("number", "based"):
            return self.number(self.words.step())
        text = self.words.now.text
        if text in ("-", "+"):
            self.words.step()
            again = self.words.now.text in (
                "-",
                "+",
                "(",
            )  # a sign of a sign, or of what stands in brackets, is an expression
            inner = self.value(depth + 1)
            if again:
                return Other(self.words.line)
            return (-inner if text == "-" else inner) if isinstance(inner, float) else Other(self.words.line)
        if text == "(":
            return self.structure(depth)
        if text == "[":
            return self.array(depth)
        if self.words.now.kind == "string":
            self.words.step()
            return Other(self.words.line)
        if self.words.now.kind == "name":
            return self.named(depth)
        raise self.words.refusal(f"a value is missing before {shown(text) if text else 'the end'}")

    def number(self, token: Token) -> float:
        """Compute a literal's value."""
        plain = token.text.replace("_", "")
        if token.kind == "based":
            base, digits = plain.split("#")
            try:
                return float(int(digits, int(base)))
            except ValueError as error:
                raise self.words.refusal(f"{shown(token.text)} is not a number of base {base}") from error
        return real(plain, self.words.place, token.line)

    def named(self, depth: int) -> Value:
        """Read a typed literal, a call, or a word."""
        if self.words.after.text == "#" and self.words.now.text.upper() in _TYPED:
            self.words.step()
            self.words.step()
            return self.value(depth + 1)
        name = self.dotted()
        if self.words.now.text == "(":
            return self.call(name.rpartition(".")[2], depth)
        if self.words.now.text == "[":
            while self.words.accept("["):
                self.words.close("]")
            return Other(self.words.line)
        return Word(name)

    def dotted(self) -> str:
        """``a.b.c`` or ``A#b`` as written."""
        parts = [self.words.step().text]
        while self.words.now.text in (".", "#") and self.words.after.kind == "name":
            self.words.step()
            parts.append(self.words.step().text)
        return ".".join(parts)

    def call(self, name: str, depth: int) -> Call:
        """Read the arguments of a call, from its opening bracket."""
        if depth > DEEPEST:
            raise self.words.refusal(f"calls are nested more than {DEEPEST} deep")
        line = self.words.line
        self.words.expect("(")
        arguments: list[Value] = []
        named = False
        while not self.words.accept(")"):
            if self.words.now.kind == "end":
                raise self.words.refusal("a bracket is never closed")
            if self.words.now.kind == "name" and self.words.after.text in (":=", "=>"):
                named = True
                self.words.step()
                self.words.step()
                if self.words.now.text in (",", ")"):
                    continue
            arguments.append(self.value(depth + 1))
            if self.words.now.text not in (",", ")", ""):
                arguments[-1] = Other(self.words.line)
            while self.words.now.text not in (",", ")", ""):  # the rest of an expression
                self.value(depth + 1) if self.words.now.text in ("(", "[") else self.words.step()
            if self.words.accept(",") and self.words.now.text == ")":
                raise self.words.refusal("a value is missing before ')'")
        return Call(name.lower(), tuple(arguments), line, named)

    def structure(self, depth: int) -> Value:
        """Read ``(a := 1, b := 2)``; a bracket around anything else is an expression."""
        line = self.words.line
        if depth + 1 < DEEPEST and (numbers := self.words.members()) is not None:
            return Struct(dict[str, Value](numbers), line)
        self.words.expect("(")
        if not (self.words.now.kind == "name" and self.words.after.text == ":="):
            return self.expression(depth, line)
        members: dict[str, Value] = {}
        while True:
            name = self.words.step().text.lower()
            if name in members:
                raise self.words.refusal(f"the member {shown(name)} is given twice")
            self.words.expect(":=")
            members[name] = self.value(depth + 1)
            if not self.words.accept(","):
                break
            if not (self.words.now.kind == "name" and self.words.after.text == ":="):
                raise self.words.refusal(f"a member's name is missing before {shown(self.words.now.text)}")
        self.words.expect(")")
        return Struct(members, line)

    def expression(self, depth: int, line: int) -> Value:
        """Read what stands in a bracket that holds no members, up to where it closes."""
        inner = self.value(depth + 1)
        if self.words.accept(")"):
            return inner
        while not self.words.accept(")"):
            if self.words.now.kind == "end":
                raise self.words.refusal("a bracket is never closed")
            self.value(depth + 1) if self.words.now.text in ("(", "[") else self.words.step()
        return Other(line)

    def array(self, depth: int) -> list[Value]:
        """``[1, 2, 3(0.0)]``, a number before a bracket repeating what stands inside."""
        self.words.expect("[")
        items: list[Value] = []
        while not self.words.accept("]"):
            if self.words.now.kind == "number" and self.words.after.text == "(":
                count = self.number(self.words.step())
                self.words.expect("(")
                inner = self.value(depth + 1)
                self.words.expect(")")
                if count != int(count) or len(items) + count > MOST_TOKENS:
                    raise self.words.refusal(f"a value cannot be repeated {count:g} times")
                items.extend([inner] * int(count))
            else:
                items.append(self.value(depth + 1))
            if not self.words.accept(",") and self.words.now.text != "]":
                raise self.words.refusal(
                    f"',' or ']' is missing before {shown(self.words.now.text) if self.words.now.text else 'the end'}"
                )
        return items


def parse(text: str, place: str) -> Program:
    """Read a text.

    Raises
    ------
    InputError
        The text breaks off, nests too deeply, or holds what is no structured text, with file and line.
    """
    return Reader(text, place).program()
