"""A car with varied numbers, as a function of them."""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from . import _native
from ._car import Car, Cycle
from ._errors import bad
from ._run import as_car, as_cycle
from ._table import Table, doubles, texts

if TYPE_CHECKING:
    import numpy
    from numpy.typing import NDArray


class Family:
    """A car and a cycle as a function of some keys, for optimisers and sensitivity analyses.

    ``keys`` are numbers of the car's files (``lubricant.`` and ``engine_oil.`` for the fluids), and ``ambient_degc``. Calls are
    vectorised: each row of ``X`` is a point, driven on all cores. A car that cannot be driven gives NaN; :meth:`table` has the reason.
    """

    def __init__(
        self,
        car: Car | str | os.PathLike[str],
        cycle: Cycle | str | os.PathLike[str],
        keys: Iterable[str] | str,
        *,
        ambient_degc: float = 25.0,
        start: str | float = "soak",
        dt_s: float = 1.0,
        threads: int | None = None,
    ) -> None:
        own, driven, names = as_car("car", car), as_cycle(cycle), texts("keys", keys)
        self._made = (own, driven, names, ambient_degc, start, dt_s)
        self._family = _native.Family(own._car, driven._cycle, names, ambient_degc, start, dt_s)
        self.threads = threads

    def __reduce__(self) -> tuple[Any, ...]:
        return _family, (self._made, self.threads)

    @property
    def keys(self) -> list[str]:
        """Keys in the order of the columns of ``X``."""
        return [key for key, _, _ in self._family.arguments]

    @property
    def units(self) -> dict[str, str]:
        """Unit of each key."""
        return {key: unit for key, unit, _ in self._family.arguments}

    @property
    def base(self) -> dict[str, float]:
        """Value of each key in the unchanged car; NaN for a key missing in its files."""
        return {key: base for key, _, base in self._family.arguments}

    @property
    def outputs(self) -> dict[str, str]:
        """Outputs with unit and meaning."""
        return {name: f"{unit}: {doc}" if unit else doc for name, unit, doc in self._family.outputs}

    def table(self, X: Any, outputs: Iterable[str] | str = ()) -> Table:
        """Computes all outputs at the points of ``X`` (N, D). The column ``reason`` explains cars that were not driven or failed a check."""
        return Table(self._family.points(self._points(X), texts("outputs", outputs), self.threads))

    def __call__(self, X: Any, outputs: Iterable[str] | str = "headline_fuel_l_per_100km") -> NDArray[numpy.float64]:
        """Computes outputs at the points of ``X`` (N, D) or at one point (D,): one number per point for one name, one column per name for a list.

        Needs NumPy.
        """
        import numpy

        wanted = texts("outputs", outputs)
        if not wanted:
            raise bad("outputs", "there is no output", hint="name one, or several")
        found = self.table(X, wanted)
        Y = numpy.column_stack([found[name] for name in wanted])
        Y = Y[:, 0] if isinstance(outputs, str) else Y
        return Y[0] if numpy.ndim(X) == 1 and len(Y) == 1 else Y

    def _points(self, X: Any) -> bytes:
        width, shape = len(self.keys), getattr(X, "shape", None)
        if shape is None and not isinstance(X, (str, bytes)):
            try:
                numbers = list(X)
                rows = [list(row) for row in numbers] if hasattr(next(iter(numbers), None), "__iter__") else [numbers]
            except TypeError:
                rows = [[]]
            rows = [] if rows == [[]] and hasattr(X, "__len__") else rows
            shape = (len(rows), width if all(len(row) == width for row in rows) else -1)
            X = [number for row in rows for number in row]
        elif shape is not None and len(shape) == 1:
            shape = (1, *shape)
        if shape is None or len(shape) != 2 or shape[1] != width:
            allowed = f"rows of {width} numbers, one for each key: shape (N, {width})"
            raise bad("X", "these are no points of this family", value=f"shape {tuple(shape or ())}", allowed=allowed)
        return doubles("X", X)

    def __repr__(self) -> str:
        return f"<cvtcycle.Family of {self._made[0].name} over {', '.join(self.keys)}>"


def _family(made: tuple[Any, ...], threads: int | None) -> Family:
    car, cycle, keys, ambient_degc, start, dt_s = made
    return Family(car, cycle, keys, ambient_degc=ambient_degc, start=start, dt_s=dt_s, threads=threads)
