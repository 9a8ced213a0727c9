"""`Notice`: a sentence in English that knows its parts, so that it can be said in another language."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Number:
    """A number in a notice.

    Parameters
    ----------
    value
        The number, in the unit that the sentence names.
    form
        How it is written, a format of Python such as ``".3f"``.
    """

    value: float
    form: str

    def __str__(self) -> str:
        return f"{self.value:{self.form}}"


class Notice(str):
    """A sentence, with its template and the values in it.

    Parameters
    ----------
    text
        The template, in English, with ``{name}`` where a value belongs.
    **values
        Names, numbers, and notices within the notice.

    Examples
    --------
    >>> told = Notice("{name} is {size} mm long", name="LINE #2F", size=Number(12.34567, ".3f"))
    >>> told, told.text
    ('LINE #2F is 12.346 mm long', '{name} is {size} mm long')
    """

    text: str
    values: dict[str, str | Number]

    def __new__(cls, text: str, **values: str | Number) -> Notice:
        """Write the sentence."""
        self = super().__new__(cls, text.format(**{name: str(value) for name, value in values.items()}))
        self.text, self.values = text, values
        return self

    def __str__(self) -> str:
        return self
