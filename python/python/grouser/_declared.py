"""Kinds of measurements and fields of results, as the library declares them: functions of `Sample`, properties of results."""

from __future__ import annotations

from collections.abc import Callable
from inspect import Parameter, Signature
from typing import Any

from ._core import OperatingPoint, Sample

__all__ = ["OperatingPoint", "Sample"]


def _function(kind: str, words: str, parameters: list[Parameter]) -> Callable[..., Sample]:
    signature = Signature(parameters, return_annotation="Sample")

    def of(*positional: Any, **keywords: Any) -> Sample:
        given = signature.bind(*positional, **keywords)
        given.apply_defaults()
        return Sample._of(kind, given.arguments)

    of.__name__ = kind.replace("-", "_")
    of.__qualname__ = f"Sample.{of.__name__}"
    of.__doc__ = words
    of.__signature__ = signature  # type: ignore[attr-defined]
    return of


for _kind, _words, _of_a_wheel, _fields in Sample._kinds():
    _keywords = [("time_ns", False), *([("wheel", False)] if _of_a_wheel else [])]
    _keywords += [(key, may_lack) for key, _, may_lack in _fields]
    _parameters = [
        Parameter(key, Parameter.KEYWORD_ONLY, default=None if may_lack else Parameter.empty)
        for key, may_lack in _keywords
    ]
    _made = staticmethod(_function(_kind, _words.strip(), _parameters))
    setattr(Sample, _kind.replace("-", "_"), _made)


def _property(key: str, words: str) -> property:
    return property(lambda result: result._value(key), doc=f"{words[0].upper()}{words[1:]}.")


for _key, _field_words in OperatingPoint._fields():
    setattr(OperatingPoint, _key, _property(_key, _field_words))
