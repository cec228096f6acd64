"""Runs: cars through a cycle."""

from __future__ import annotations

import json
import math
import os
import shlex
from collections.abc import Iterable, Mapping
from functools import cached_property
from typing import Any

from . import _native
from ._car import Car, Cycle, path_word
from ._errors import bad
from ._table import Table, _html


class Picture:
    """SVG drawing, displayed by notebooks."""

    def __init__(self, svg: str) -> None:
        self.svg = svg

    def _repr_svg_(self) -> str:
        return self.svg

    def save(self, file: str | os.PathLike[str]) -> None:
        """Writes the drawing to a file."""
        with open(path_word("file", file), "w", encoding="utf-8") as out:
            out.write(self.svg)

    def __repr__(self) -> str:
        return f"<cvtcycle.Picture, {len(self.svg)} bytes of SVG>"


class Run:
    """Drives of cars through a cycle. The first car is the subject, the others are its baselines."""

    def __init__(self, run: _native.Run, words: list[str]) -> None:
        self._run = run
        self._words = words

    @property
    def cars(self) -> list[str]:
        """Names of the cars, the subject first."""
        return self._run.cars

    @property
    def fuel_l_per_100km(self) -> float:
        """Fuel of the subject over the whole cycle, L/100 km; NaN below 10 m and below a mean speed of 1 km/h."""
        return self._run.fuel_l_per_100km

    @property
    def fuel_l_per_h(self) -> float:
        """Fuel of the subject over the whole cycle, L/h."""
        return self._run.fuel_l_per_h

    @cached_property
    def summary(self) -> dict[str, Any]:
        """All numbers of the run, as ``cvtcycle run --json`` prints them."""
        found: dict[str, Any] = json.loads(self._run.summary())
        return found

    @cached_property
    def traces(self) -> dict[str, Table]:
        """Trace of each car by name."""
        return {name: self._trace(k) for k, name in enumerate(self.cars)}

    @cached_property
    def trace(self) -> Table:
        """Trace of the subject, one row per step."""
        return self._trace(0)

    def _trace(self, car: int) -> Table:
        if not self._run.has_trace:
            raise bad("trace", "this run kept no steps", hint="drive it with trace=True")
        return Table(self._run.trace(car))

    def plot(self, kind: str = "losses", car: str | int = 0) -> Picture:
        """Draws ``losses``, ``driveline``, ``pressure``, ``temperatures`` or ``operating_points`` of a car, or ``fuel`` of all."""
        if not self._run.has_trace:
            raise bad("trace", "this run kept no steps to draw", hint="drive it with trace=True")
        return Picture(self._run.picture(kind, self._index(car)))

    def _index(self, car: str | int) -> int:
        cars = self.cars
        if isinstance(car, str) and car in cars:
            return cars.index(car)
        if isinstance(car, int) and 0 <= car < len(cars):
            return car
        raise bad("car", "there is no such car in this run", value=str(car), allowed=", ".join(cars))

    def write(self, folder: str | os.PathLike[str], *, format: str = "csv", force: bool = False) -> list[str]:
        """Writes the files of ``cvtcycle run --out``: summary, inputs, traces, plots. Returns their paths."""
        paths = self._with_trace("write").write(path_word("folder", folder), format, force, self._command)
        return [os.fspath(path) for path in paths]

    def report(
        self, file: str | os.PathLike[str], *, cover: str | os.PathLike[str] | None = None, force: bool = False
    ) -> list[str]:
        """Writes a report for a design review, HTML or Markdown by the extension of its name. Returns the paths of its files."""
        cover = None if cover is None else path_word("cover", cover)
        paths = self._with_trace("report").report(path_word("file", file), cover, force, self._command)
        return [os.fspath(path) for path in paths]

    def _with_trace(self, what: str) -> _native.Run:
        if not self._run.has_trace:
            raise bad(what, "this run kept no steps", hint="drive it with trace=True")
        return self._run

    @property
    def _command(self) -> str:
        return "python: " + shlex.join(self._words)

    def __repr__(self) -> str:
        return f"<cvtcycle.Run of {', '.join(self.cars)}: {self._fuel}>"

    @property
    def _fuel(self) -> str:
        fuel = self.fuel_l_per_100km
        return f"{self.fuel_l_per_h:.2f} L/h" if math.isnan(fuel) else f"{fuel:.2f} L/100 km"

    def _repr_html_(self) -> str:
        rows = ""
        over = "fuel_l_per_h" if math.isnan(self.fuel_l_per_100km) else "fuel_l_per_100km"
        for car in self.summary["runs"]:
            fuel, co2 = (car[key] for key in (over, "co2_g_per_km"))
            cells = [car["vehicle"], car["title"], _shown(fuel, 2), _shown(co2, 1)]
            rows += "<tr>" + "".join(f"<td>{_html(str(cell))}</td>" for cell in cells) + "</tr>"
        unit = "L/h" if over == "fuel_l_per_h" else "L/100 km"
        head = f"<tr><th>car</th><th></th><th>fuel, {unit}</th><th>CO2, g/km</th></tr>"
        ambient = self.summary["ambient_degc"]
        return f"<p>{_html(self.summary['cycle'])}, ambient {ambient:g} degC</p><table>{head}{rows}</table>"

    def _repr_mimebundle_(self, include: object = None, exclude: object = None) -> dict[str, str]:
        bundle = {"text/plain": repr(self), "text/html": self._repr_html_()}
        if self._run.has_trace:
            bundle["image/svg+xml"] = self.plot("fuel" if len(self.cars) > 1 else "losses").svg
        return bundle


def _shown(number: float | None, decimals: int) -> str:
    return "-" if number is None else f"{number:.{decimals}f}"


def as_car(key: str, car: Car | str | os.PathLike[str]) -> Car:
    """Returns a car, reading it from a name or path if needed."""
    return car if isinstance(car, Car) else Car(path_word(key, car))


def as_cycle(cycle: Cycle | str | os.PathLike[str]) -> Cycle:
    """Returns a cycle, reading it from a name or path if needed."""
    return cycle if isinstance(cycle, Cycle) else Cycle(path_word("cycle", cycle))


def run(
    car: Car | str | os.PathLike[str],
    cycle: Cycle | str | os.PathLike[str],
    *,
    ambient_degc: float = 25.0,
    start: str | float | Mapping[str, float] = "auto",
    dt_s: float = 1.0,
    baselines: Iterable[Car | str | os.PathLike[str]] = (),
    trace: bool = True,
    price: bool = False,
) -> Run:
    """Drives a car and its baselines through a cycle.

    ``start`` is ``auto`` (as a log begins that has temperatures, else ``soak``), ``soak`` (everything at ambient), ``warm`` (directly after the
    same cycle from a soak), a temperature in degC, or those of single nodes, ``{"coolant": 81, "sump": 60}`` or ``"coolant=81,sump=60"``: coolant, engine_oil, sump, metal, belt, tyre; the others follow (TH-10).
    ``dt_s`` is the longest time step. ``baselines`` are cars, names or paths, and ``twin`` for the same car with a manual box. Without ``trace`` no
    steps are kept, which is faster. With ``price`` each car is driven again without each of its losses, for the fuel that it costs.
    """
    subject = as_car("car", car)
    if isinstance(baselines, (str, os.PathLike, Car)):
        baselines = [baselines]
    others = [subject.twin() if own == "twin" else as_car("baselines", own) for own in baselines]
    cycle = as_cycle(cycle)
    start = dict(start) if isinstance(start, Mapping) else start
    made = _native.run(
        [own._car for own in (subject, *others)], cycle._cycle, ambient_degc, start, dt_s, bool(trace), bool(price)
    )
    words = ["run", subject.name, cycle.name, f"ambient_degc={ambient_degc:g}", f"start={start}", f"dt_s={dt_s:g}"]
    return Run(made, words)
