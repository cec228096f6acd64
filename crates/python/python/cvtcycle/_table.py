"""Tables of columns, and conversion of arrays to native input."""

from __future__ import annotations

import array
import csv
import io
import numbers
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from . import _native
from ._errors import bad

if TYPE_CHECKING:
    import pandas
    import polars


class Table:
    """Columns of one length, each with name, unit and meaning. A missing number is NaN.

    A reader of the Arrow interface (polars, pyarrow, duckdb, pandas 3) takes the table as it is, without a copy:
    ``polars.DataFrame(table)``, ``pyarrow.table(table)``.
    """

    def __init__(self, table: _native.Table) -> None:
        self._table = table

    @property
    def columns(self) -> list[str]:
        """Names of the columns."""
        return [name for name, _, _ in self._table.heads]

    @property
    def units(self) -> dict[str, str]:
        """Unit of each column; ``-`` for plain ratios, an empty text for words and counts."""
        return {name: unit for name, unit, _ in self._table.heads}

    @property
    def meanings(self) -> dict[str, str]:
        """Meaning of each column, one phrase."""
        return {name: doc for name, _, doc in self._table.heads}

    def __len__(self) -> int:
        return len(self._table)

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __contains__(self, name: object) -> bool:
        return name in self.columns

    def __getitem__(self, name: str) -> Any:
        """Column as a read-only NumPy view (a list without NumPy); words as a list."""
        column = self._table.column(name)
        if isinstance(column, list):
            return column
        try:
            import numpy
        except ImportError:
            return column.tolist()
        return numpy.asarray(column)

    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object:
        return self._table.__arrow_c_stream__(requested_schema)

    def __arrow_c_schema__(self) -> object:
        return self._table.__arrow_c_schema__()

    def to_dict(self) -> dict[str, list[Any]]:
        """Converts the columns to lists, by name."""
        columns = {name: self._table.column(name) for name in self.columns}
        return {name: c if isinstance(c, list) else c.tolist() for name, c in columns.items()}

    def to_polars(self) -> polars.DataFrame:
        """Converts the table to a polars frame, without a copy."""
        import polars

        return polars.DataFrame(self)

    def to_pandas(self) -> pandas.DataFrame:
        """Converts the table to a pandas frame, with the units in ``attrs["units"]``."""
        import pandas

        frame: pandas.DataFrame = pandas.DataFrame({name: self[name] for name in self.columns})
        frame.attrs["units"] = self.units
        return frame

    def __repr__(self) -> str:
        return f"<cvtcycle.Table of {len(self)} rows and {len(self.columns)} columns>"

    def _repr_html_(self) -> str:
        shown = min(len(self), 5)
        data = {name: values[:shown] for name, values in self.to_dict().items()} if shown else {}
        head = "".join(f"<th>{_html(n)}<br><small>{_html(u)}</small></th>" for n, u in self.units.items())
        rows = "".join(
            "<tr>" + "".join(f"<td>{_cell(data[name][k])}</td>" for name in data) + "</tr>" for k in range(shown)
        )
        note = f"<p>{len(self)} rows, {len(self.columns)} columns</p>"
        return f"<table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>{note}"


def _html(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


def _cell(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else _html(str(value))


def doubles(key: str, values: Any) -> bytes:
    """Converts a NumPy array, a series of a frame or a sequence to contiguous doubles. Does not parse text as numbers."""
    if hasattr(values, "__array__") and hasattr(values, "dtype"):
        import numpy

        values = numpy.asarray(values)
        if values.dtype.kind not in "fiu":
            raise bad(key, f"an array of type {values.dtype} holds no real numbers")
        return numpy.ascontiguousarray(values, dtype=numpy.float64).tobytes()
    if isinstance(values, numbers.Real):
        values = [values]
    try:
        return array.array("d", _listed(key, values)).tobytes()
    except TypeError as error:
        raise bad(key, f"these are no numbers: {error}") from error
    except OverflowError as error:
        raise bad(key, f"a number is too large for a double: {error}") from error


def _listed(key: str, values: Any) -> list[Any]:
    if isinstance(values, (str, bytes, Mapping)):
        raise bad(key, f"{type(values).__name__} is no sequence of numbers")
    if getattr(getattr(values, "dtype", None), "kind", "") in ("m", "M") and hasattr(values, "astype") and not hasattr(values, "to_list"):
        # NumPy lists nanoseconds as whole numbers.
        values = values.astype("datetime64[us]" if values.dtype.kind == "M" else "timedelta64[us]")
    for method in ("to_list", "tolist"):
        if hasattr(values, method):
            return list(getattr(values, method)())
    try:
        return list(values)
    except TypeError as error:
        raise bad(key, f"{type(values).__name__} is no sequence of numbers") from error


def frame_columns(key: str, frame: Any) -> dict[str, list[Any]]:
    """Converts the columns of a mapping or frame (polars, pandas, pyarrow, Table) to lists."""
    if isinstance(frame, Table):
        return frame.to_dict()
    if isinstance(frame, Mapping):
        return {str(name): _listed(str(name), values) for name, values in frame.items()}
    names = getattr(frame, "column_names", None) or getattr(frame, "columns", None)
    if names is None:
        raise bad(key, f"{type(frame).__name__} has no columns", allowed="a mapping or a frame")
    try:
        return {str(name): _listed(str(name), frame[name]) for name in names}
    except (KeyError, TypeError) as error:
        raise bad(key, f"{type(frame).__name__} has no columns by name: {error}") from error


def timed_columns(key: str, frame: Any) -> dict[str, list[Any]]:
    """Columns of a frame as :func:`frame_columns`, with the index of a pandas frame where it is the time, and times as seconds."""
    columns = frame_columns(key, frame)
    index = getattr(frame, "index", None)
    if index is not None and hasattr(index, "dtype") and not _has_time(columns):
        # asammdf and loggers have their stamps in the index; a plain count of the rows has no name.
        name = str(getattr(index, "name", None) or "")
        kind = getattr(index.dtype, "kind", "")
        is_text = kind == "O" and name != "" and len(index) > 0 and isinstance(index[0], str)
        if kind in ("m", "M") or (name and kind in "fiu"):
            columns = {_time_name(name or "time"): _listed("index", index), **columns}
        elif is_text:
            columns = {name: _listed("index", index), **columns}
    timed = {}
    for name, values in columns.items():
        seconds = _seconds(values)
        timed[name if seconds is None else _time_name(name)] = values if seconds is None else seconds
    return timed


def _has_time(columns: Mapping[str, Sequence[Any]]) -> bool:
    return any(name.lower().startswith(("time", "t [", "timestamp", "elapsed", "date")) or name == "t" for name in columns)


def _time_name(name: str) -> str:
    """Name of a column of seconds: with that unit, unless it states one."""
    lower = name.lower()
    return name if lower.endswith(("_s", "[s]", "(s)")) else f"{lower.removesuffix('s') if lower == 'timestamps' else lower}_s"


def _seconds(values: Sequence[Any]) -> list[Any] | None:
    """Seconds since the first of datetimes or timedeltas; None for other values. Missing ones stay missing."""
    import datetime

    first = next((value for value in values if _is_there(value)), None)
    if isinstance(first, datetime.timedelta):
        return [value.total_seconds() if _is_there(value) else None for value in values]
    if isinstance(first, datetime.datetime):
        return [(value - first).total_seconds() if _is_there(value) else None for value in values]
    return None


def _is_there(value: Any) -> bool:
    """False for None, NaN, NaT, and for the missing value of pandas, whose comparison is no truth either."""
    same: Any = value is not None and value == value
    return type(same).__name__ != "NAType" and bool(same)


def table_text(columns: Mapping[str, Sequence[Any]]) -> bytes:
    """Formats columns of equal length as CSV with round-trip numbers. None becomes an empty cell."""
    lengths = {name: len(values) for name, values in columns.items()}
    if len(set(lengths.values())) > 1:
        raise bad(", ".join(columns), "the columns are of different lengths: " + _lengths(lengths))
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(columns)
    for row in zip(*columns.values()):
        writer.writerow([_word(value) for value in row])
    return out.getvalue().encode()


def _lengths(lengths: Mapping[str, int]) -> str:
    return ", ".join(f"{name} {n}" for name, n in lengths.items())


def _word(value: Any) -> str:
    if value is None or type(value).__name__ in ("NAType", "NaTType"):
        return ""
    if isinstance(value, bool):
        return str(int(value))
    if isinstance(value, numbers.Integral):
        return str(int(value))
    return repr(float(value)) if isinstance(value, numbers.Real) else str(value)


def texts(key: str, values: Iterable[str] | str) -> list[str]:
    """Converts one or several texts to a list."""
    listed = [values] if isinstance(values, str) else list(values)
    for value in listed:
        if not isinstance(value, str):
            raise bad(key, f"{value!r} is no text")
    return listed
