"""Results as tables: columns by name, which the libraries of tables take as they are."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

from ._errors import InputError

_MAKERS = {"pandas": "DataFrame", "polars": "DataFrame", "pyarrow": "table"}
_SHOWN = 10
"""Rows that a notebook shows."""


class Table(dict[str, Any]):
    """Columns of a result by name, as attributes as well: ``points.sinkage_m`` is ``points["sinkage_m"]``.

    It is a dict of arrays, so ``pandas.DataFrame(points)``, ``polars.DataFrame(points)`` and ``pyarrow.table(points)``
    take it as it is where its columns have one dimension; `to_frame` flattens others.
    """

    def __init__(self, *columns: Any, **named: Any) -> None:
        super().__init__(zip(type(self)._fields(), columns), **named)

    @classmethod
    def _fields(cls) -> list[str]:
        return [name for name in cls.__annotations__ if not name.startswith("_")]

    if not TYPE_CHECKING:  # a misspelt column is an error of types

        def __getattr__(self, name: str) -> Any:
            try:
                return self[name]
            except KeyError:
                hint = "use to_frame()" if name.startswith("to_") else _close(name, self)
                raise AttributeError(f"{type(self).__name__} has no `{name}`; {hint}") from None

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self]

    def _asdict(self) -> dict[str, Any]:
        return dict(self)

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (type(self), dict(self))

    def _flat(self) -> Iterator[tuple[str, Any]]:
        """Columns of one dimension; where one has an axis more than the others, a column for each of its places."""
        shape = min((np.shape(column) for column in self.values()), key=len, default=())
        for name, column in self.items():
            array = np.asarray(column)
            if array.ndim == len(shape):
                yield name, array.reshape(-1)
                continue
            rows = array.reshape((int(np.prod(shape)), -1))
            for k in range(rows.shape[1]):
                yield f"{name}_{k}", rows[:, k]

    def to_frame(self, library: str = "pandas") -> Any:
        """A data frame, a row for each point, in the order of the flat arrays.

        Parameters
        ----------
        library : str
            `pandas`, `polars` or `pyarrow`, which has to be installed.
        """
        flat = dict(self._flat())
        if library not in _MAKERS:
            raise InputError(f"library is `{library}`, but must be one of {', '.join(_MAKERS)}", "library", library)
        return getattr(import_module(library), _MAKERS[library])(flat)

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        """The table by Arrow's C interface; needs pyarrow."""
        return self.to_frame("pyarrow").__arrow_c_stream__(requested_schema)

    def plot(self, x: Any, y: str, *, ax: Any = None, **style: Any) -> Any:
        """Draws a column against another one, or against an array such as the slips that were given; needs matplotlib.

        Returns
        -------
        matplotlib.axes.Axes
        """
        ax = ax if ax is not None else import_module("matplotlib.pyplot").gca()
        ax.plot(np.ravel(self[x] if isinstance(x, str) else x), np.ravel(self[y]), **style)
        ax.set_ylabel(y)
        if isinstance(x, str):
            ax.set_xlabel(x)
        return ax

    def __repr__(self) -> str:
        columns = ", ".join(f"{name}={column!r}" for name, column in self.items())
        return f"{type(self).__name__}({columns})"

    def _repr_html_(self) -> str:
        import html  # not with the package: importing it stays fast

        flat = dict(self._flat())
        count = len(next(iter(flat.values()), ()))
        head = "".join(f"<th>{html.escape(name)}</th>" for name in flat)
        rows = (
            "<tr>" + "".join(f"<td>{html.escape(_short(column[k]))}</td>" for column in flat.values()) + "</tr>"
            for k in range(min(count, _SHOWN))
        )
        more = f"<p>{count} rows</p>" if count > _SHOWN else ""
        return f"<table><tr>{head}</tr>{''.join(rows)}</table>{more}"


def _close(name: str, names: Iterable[str]) -> str:
    import difflib  # not with the package: importing it stays fast

    near = difflib.get_close_matches(name, names, 1)
    return f"did you mean `{near[0]}`?" if near else f"it has {', '.join(names)}"


def _short(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, (float, np.floating)) else str(value)


def _restored(kind: type[Table], columns: dict[str, Any]) -> Table:
    return kind(**columns)
