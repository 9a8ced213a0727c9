"""Reading IEC 61131-3 structured text: declarations with initial values, assignments, calls; the rest is skipped."""

from __future__ import annotations

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
from camwright.profiles.tables.st_words import MOST_TOKENS, Token, tokens_of
from camwright.profiles.tables.text import real, refuse, shown

DEEPEST = 8
_TYPED = frozenset(
    ("LREAL", "REAL", "INT", "UINT", "DINT", "UDINT", "LINT", "ULINT", "SINT", "USINT", "BYTE", "WORD", "DWORD", "BOOL")
)

_END = Token("end", "", 0)


class Reader:
    """Reads one text from its first word to its last; `program` is the result."""

    def __init__(self, text: str, place: str) -> None:
        self.place = place
        self.words = tokens_of(text, place)
        self.variables: dict[str, int] = {}
        self.declarations: list[Declaration] = []
        self.assignments: list[Assignment] = []
        self.calls: list[Call] = []
        self.line = 1
        self.now, self.after = _END, next(self.words, _END)
        self.step()

    def step(self) -> Token:
        """Go on by one word and return the one left behind."""
        past = self.now
        self.now, self.after = self.after, next(self.words, _END)
        self.line = self.now.line or self.line
        return past

    def accept(self, text: str) -> bool:
        """Go on if this is the word that stands here."""
        word = self.now.text
        if word == text or word.upper() == text:
            self.step()
            return True
        return False

    def expect(self, text: str) -> None:
        """Go on if this is the word that stands here, refuse otherwise."""
        if not self.accept(text):
            raise self.refusal(f"{text!r} is missing before {shown(self.now.text) if self.now.text else 'the end'}")

    def refusal(self, reason: str) -> Exception:
        """Make an error at the present line."""
        return refuse(self.place, self.line, reason)

    # -- statements -------------------------------------------------------------------------------------------------

    def program(self) -> Program:
        """Read all statements."""
        while self.now.kind != "end":
            if self.now.kind == "name":
                self.statement()
            else:
                self.step()
        return Program(tuple(self.declarations), tuple(self.assignments), tuple(self.calls))

    def statement(self) -> None:
        """Read a declaration, an assignment or a call; of anything else one word is passed over."""
        line = self.line
        if self.after.text == ":":
            name = self.step().text
            self.step()
            self.declaration(name, line)
            return
        if self.after.text not in (":=", ".", "[", "("):
            self.step()
            return
        path = self.path(0)
        if self.accept(":="):
            value = self.value(0)
            if self.now.text not in (";", ",", ")", ""):
                value = self.sum_of(value)
            elif isinstance(value, Word) and (number := self.known(value)) is not None:
                value = number
            self.assign(path, value, line)
        elif self.now.text == "(":
            self.calls.append(self.call(str(path[-1]) if path else "", 0))

    def assign(self, path: tuple[str | int, ...] | None, value: Value, line: int) -> None:
        """Note an assignment; whole numbers given to plain variables are remembered, for they serve as indices."""
        if path is None:
            return
        if len(path) == 1 and isinstance(path[0], str):
            if isinstance(value, float) and value == int(value):
                self.variables[path[0]] = int(value)
            else:
                self.variables.pop(path[0], None)
        if not isinstance(value, Other):
            self.assignments.append(Assignment(path, value, line))

    def sum_of(self, value: Value) -> Value:
        """``value + 1`` and ``value - 1`` of whole numbers; any other expression is passed over."""
        sign = {"+": 1.0, "-": -1.0}.get(self.now.text)
        first = self.known(value)
        if sign is not None and first is not None and self.after.kind == "number":
            self.step()
            second = self.value(0)
            if isinstance(second, float) and self.now.text == ";":
                return first + sign * second
        while self.now.text not in (";", ""):
            self.step()
        return Other(self.line)

    def known(self, value: Value) -> float | None:
        """Find the number that a value is or that its variable was given last."""
        if isinstance(value, Word):
            number = self.variables.get(value.text.lower())
            return None if number is None else float(number)
        return value if isinstance(value, float) else None

    def declaration(self, name: str, line: int) -> None:
        """``name : type := value`` after the colon."""
        bounds: list[tuple[int, int]] = []
        if self.accept("ARRAY"):
            self.expect("[")
            while True:
                low = self.bound()
                self.expect("..")
                bounds.append((low, self.bound()))
                if not self.accept(","):
                    break
            self.expect("]")
            self.expect("OF")
        if self.now.kind != "name":
            return
        type_name = self.dotted()
        value: Value | None = None
        if self.accept(":="):
            value = self.value(0)
            if isinstance(value, float) and not bounds and value == int(value):
                self.variables[name.lower()] = int(value)
        self.declarations.append(Declaration(name, type_name.rpartition(".")[2].lower(), tuple(bounds), value, line))

    def bound(self) -> int:
        """One bound of an array."""
        value = self.known(self.value(0))
        if value is None or value != int(value) or abs(value) > 1e6:
            raise self.refusal("an array's bound must be a whole number up to 1000000")
        return int(value)

    def path(self, depth: int) -> tuple[str | int, ...] | None:
        """``a.b[1].c`` as names and indices; ``None`` if an index is not known."""
        parts: list[str | int] = [self.step().text.lower()]
        known = True
        while True:
            if self.now.text == "." and self.after.kind == "name":
                self.step()
                parts.append(self.step().text.lower())
            elif self.now.text == "[":
                self.step()
                while True:
                    index = self.known(self.value(depth + 1))
                    if index is None or index != int(index):
                        known = False
                    else:
                        parts.append(int(index))
                    if not self.accept(","):
                        break
                if not known:
                    self.close("]")
                else:
                    self.expect("]")
            else:
                return tuple(parts) if known else None

    def close(self, bracket: str) -> None:
        """Go on behind the next closing bracket."""
        while self.now.kind != "end" and not self.accept(bracket):
            self.step()

    # -- values -----------------------------------------------------------------------------------------------------

    def value(self, depth: int) -> Value:
        """Read a number, a word, a structure, an array, or a call."""
        if depth > DEEPEST:
            raise self.refusal(f"values are nested more than {DEEPEST} deep")
        if self.now.kind in ("number", "based"):
            return self.number(self.step())
        text = self.now.text
        if text in ("-", "+"):
            self.step()
            inner = self.value(depth + 1)
            return (-inner if text == "-" else inner) if isinstance(inner, float) else Other(self.line)
        if text == "(":
            return self.structure(depth)
        if text == "[":
            return self.array(depth)
        if self.now.kind == "string":
            self.step()
            return Other(self.line)
        if self.now.kind == "name":
            return self.named(depth)
        raise self.refusal(f"a value is missing before {shown(text) if text else 'the end'}")

    def number(self, token: Token) -> float:
        """Compute a literal's value."""
        plain = token.text.replace("_", "")
        if token.kind == "based":
            base, digits = plain.split("#")
            try:
                return float(int(digits, int(base)))
            except ValueError as error:
                raise self.refusal(f"{shown(token.text)} is not a number of base {base}") from error
        return real(plain, self.place, token.line)

    def named(self, depth: int) -> Value:
        """Read a typed literal, a call, or a word."""
        if self.after.text == "#" and self.now.text.upper() in _TYPED:
            self.step()
            self.step()
            return self.value(depth + 1)
        name = self.dotted()
        if self.now.text == "(":
            return self.call(name.rpartition(".")[2], depth)
        if self.now.text == "[":
            while self.accept("["):
                self.close("]")
            return Other(self.line)
        return Word(name)

    def dotted(self) -> str:
        """``a.b.c`` or ``A#b`` as written."""
        parts = [self.step().text]
        while self.now.text in (".", "#") and self.after.kind == "name":
            self.step()
            parts.append(self.step().text)
        return ".".join(parts)

    def call(self, name: str, depth: int) -> Call:
        """Read the arguments of a call, from its opening bracket."""
        if depth > DEEPEST:
            raise self.refusal(f"calls are nested more than {DEEPEST} deep")
        line = self.line
        self.expect("(")
        arguments: list[Value] = []
        while not self.accept(")"):
            if self.now.kind == "end":
                raise self.refusal("a bracket is never closed")
            if self.now.kind == "name" and self.after.text in (":=", "=>"):
                self.step()
                self.step()
                if self.now.text in (",", ")"):
                    continue
            arguments.append(self.value(depth + 1))
            while self.now.text not in (",", ")", ""):  # the rest of an expression
                self.value(depth + 1) if self.now.text in ("(", "[") else self.step()
            self.accept(",")
        return Call(name.lower(), tuple(arguments), line)

    def structure(self, depth: int) -> Value:
        """Read ``(a := 1, b := 2)``; a bracket around anything else is an expression."""
        line = self.line
        self.expect("(")
        if not (self.now.kind == "name" and self.after.text == ":="):
            inner = self.value(depth + 1)
            if self.accept(")"):
                return inner
            while not self.accept(")"):  # an expression
                if self.now.kind == "end":
                    raise self.refusal("a bracket is never closed")
                self.value(depth + 1) if self.now.text in ("(", "[") else self.step()
            return Other(line)
        members: dict[str, Value] = {}
        while True:
            name = self.step().text.lower()
            if name in members:
                raise self.refusal(f"the member {shown(name)} is given twice")
            self.expect(":=")
            members[name] = self.value(depth + 1)
            if not self.accept(","):
                break
            if not (self.now.kind == "name" and self.after.text == ":="):
                raise self.refusal(f"a member's name is missing before {shown(self.now.text)}")
        self.expect(")")
        return Struct(members, line)

    def array(self, depth: int) -> list[Value]:
        """``[1, 2, 3(0.0)]``, a number before a bracket repeating what stands inside."""
        self.expect("[")
        items: list[Value] = []
        while not self.accept("]"):
            if self.now.kind == "number" and self.after.text == "(":
                count = self.number(self.step())
                self.expect("(")
                inner = self.value(depth + 1)
                self.expect(")")
                if count != int(count) or len(items) + count > MOST_TOKENS:
                    raise self.refusal(f"a value cannot be repeated {count:g} times")
                items.extend([inner] * int(count))
            else:
                items.append(self.value(depth + 1))
            if not self.accept(",") and self.now.text != "]":
                raise self.refusal(
                    f"',' or ']' is missing before {shown(self.now.text) if self.now.text else 'the end'}"
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
