"""Exceptions that name the field, its value, the limit and the unit."""

from __future__ import annotations

from typing import Any


class _Described(Exception):
    """An exception with the bad field, its value, the limit and the unit, where they are known."""

    field: str | None
    value: Any
    limit: Any
    unit: str | None

    def __init__(
        self,
        message: str,
        field: str | None = None,
        value: Any = None,
        limit: Any = None,
        unit: str | None = None,
    ) -> None:
        super().__init__(message)
        self.field = field
        self.value = value
        self.limit = limit
        self.unit = unit

    def add_note(self, note: str, /) -> None:
        """Adds a note. The one with which the extension module names the argument at fault becomes the field."""
        name = note.removeprefix("while processing '").removesuffix("'")
        if name == note or self.field is not None:
            # Python 3.10 has no notes
            getattr(super(), "add_note", lambda note: None)(note)
        else:
            self.field = name
            self.args = (f"{name} {self.args[0]}",)

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.args[0], self.field, self.value, self.limit, self.unit)


class InputError(_Described, ValueError):
    """A value outside its limits.

    Attributes
    ----------
    field : str or None
        The keyword or key of the value.
    value : object
        What was given.
    limit : float, tuple or None
        What is allowed: a range (least, greatest), or a number that must be exceeded.
    unit : str or None
        The unit of value and limit; "1" for a pure number.

    Examples
    --------
    >>> from grouser import InputError
    >>> from grouser.wheel import Wheel
    >>> try:
    ...     Wheel(radius_m=-0.1, width_m=0.1)
    ... except InputError as error:
    ...     print(error.field, error.value, error.limit, error.unit)
    radius_m -0.1 (0.001, 100.0) m
    """


class InputTypeError(_Described, TypeError):
    """A value of the wrong type: text, objects or complex numbers where real numbers are needed."""
