"""Losses, belt, validation, calibration, explanations, schemas."""

from __future__ import annotations

import json
import math
import numbers
import os
from collections.abc import Iterable
from typing import Any

from . import _native
from ._car import Car, Set, assignments, path_word
from ._errors import bad
from ._run import as_car
from ._table import Table, frame_columns, doubles, table_text, texts


def names(kind: str) -> list[str]:
    """Names of embedded inputs of a kind: ``vehicle``, ``cycle``, ``lubricant``, ``plan``, ``calibration``, ``class``, ``rig``, ``levers``, ``test``."""
    return _native.names(kind)


def explain(word: str) -> dict[str, Any]:
    """Explains a key, column, flag, label of an equation or term, as ``cvtcycle explain --json`` prints it."""
    found: dict[str, Any] = json.loads(_native.explain(word))
    return found


def schema(kind: str) -> dict[str, Any]:
    """JSON Schema of a kind of file: ``vehicle``, ``lubricant``, ``rig``, ``calibration``, ``validation``, ``plan``, ``levers``."""
    found: dict[str, Any] = json.loads(_native.schema(kind))
    return found


def losses(
    car: Car | str | os.PathLike[str],
    *,
    belt_ratio: Any = None,
    gear: Any = None,
    input_speed_rpm: Any = 2500.0,
    output_torque_nm: Any = None,
    input_torque_nm: Any = None,
    transmission_sump_degc: Any = 80.0,
    belt_spray_degc: Any = None,
    throttle: Any = None,
    secondary_pressure_bar: Any = None,
    threads: int | None = None,
) -> Table:
    """Computes losses of each component of a transmission at operating points: torques at the input shaft, with the launch clutch locked.

    Arguments are numbers or arrays of one length; their names are those of the columns that come back. A CVT needs ``belt_ratio``, a manual
    box ``gear``. ``output_torque_nm`` is behind the final drive (0 if no torque is given); ``input_torque_nm`` takes its place, and that of
    ``throttle``: the clamping law sees it over full load. Without ``belt_spray_degc`` the belt is in steady state over the sump,
    without ``secondary_pressure_bar`` the pressure is that of the clamping law at ``throttle`` (0 if it is not given).
    """
    subject = as_car("car", car)
    ratio = "belt_ratio" if subject.is_cvt else "gear"
    given = {
        "belt_ratio": belt_ratio,
        "gear": gear,
        "input_speed_rpm": input_speed_rpm,
        "output_torque_nm": 0.0 if output_torque_nm is None and input_torque_nm is None else output_torque_nm,
        "input_torque_nm": input_torque_nm,
        "transmission_sump_degc": transmission_sump_degc,
        "belt_spray_degc": belt_spray_degc,
        "throttle": 0.0 if throttle is None and subject.is_cvt else throttle,
        "secondary_pressure_bar": secondary_pressure_bar,
    }
    for name, other in (("output_torque_nm", output_torque_nm), ("throttle", throttle)):
        if input_torque_nm is not None and other is not None:
            raise bad("input_torque_nm", f"it takes the place of {name}", hint=f"leave out {name}")
    if given[ratio] is None:
        raise bad(ratio, f"{subject.name} needs it", hint="give a number or an array")
    points = [(name, doubles(name, values)) for name, values in given.items() if values is not None]
    return Table(_native.losses(subject._car, points, threads))


def belt(
    points: Any,
    *,
    car: Car | str | os.PathLike[str] = "rover_216_cvt",
    formulation: str = "smooth",
    band_speed: float | None = None,
    name: str = "points",
) -> Table:
    """Evaluates the belt model at the points of a table, a mapping or a frame with the columns of ``cvtcycle belt``.

    It needs ``ratio``, ``input_speed_rpm``, ``secondary_pressure_bar`` and ``output_torque_nm`` (at the secondary pulley).
    """
    text = table_text(frame_columns("points", points))
    return Table(_native.belt(as_car("car", car)._car, name, text, formulation, band_speed))


def fleet(
    cars: Any,
    *,
    map: str | os.PathLike[str] | None = None,
    tests: Iterable[str] | str = ("ftp75", "hwfet"),
    set: Set = None,
    dt_s: float = 1.0,
    threads: int | None = None,
    name: str = "cars",
) -> Table:
    """Drives the cars of a table on tests, as ``cvtcycle fleet`` does: a mapping or a frame, a row a car, or the path of a CSV file.

    The result has a row for each row: the fuel of each figure in L/100 km with the range of 90 % of cars (``_low``, ``_high``) and what was measured,
    ``failed_checks``, ``doubts``, and for a row that is no car ``refused``, its reason. A value of ``set`` may be an expression of the columns of the
    table; with ``set`` a column ``_before`` has the fuel of each figure without it.

    >>> import cvtcycle as cc
    >>> cars = {"carid": ["mine"], "mass": ["1300kg"], "displacement": ["1.8l"], "power": ["104kW"]}
    >>> 4 < cc.fleet(cars, tests="hwfet")["hwfet_l_per_100km"][0] < 7
    True
    >>> table = cc.fleet(cars | {"seats": [4]}, tests="hwfet", set={"engine.electrical_w": "300 + 100*seats"})
    >>> table["hwfet_l_per_100km"][0] > table["hwfet_l_per_100km_before"][0]
    True
    """
    if isinstance(cars, (str, os.PathLike)):
        name = path_word("cars", cars)
        try:
            with open(name, "rb") as file:
                text = file.read()
        except OSError as error:
            raise bad("cars", f"cannot read the table: {error.strerror}", value=name, hint="check the path") from None
    else:
        columns = frame_columns("cars", cars)
        text = table_text({name: [_car_cell(value) for value in values] for name, values in columns.items()})
    word = None if map is None else path_word("map", map)
    return Table(_native.fleet(name, text, word, texts("tests", tests), assignments(set), float(dt_s), threads))


def _car_cell(value: Any) -> Any:
    """A cell of a frame of cars: pandas has NaN where a text or number is missing, and then a year as 2018.0."""
    if not isinstance(value, numbers.Real) or isinstance(value, numbers.Integral):
        return value
    number = float(value)
    if math.isnan(number):
        return None
    return int(number) if number.is_integer() else number


def validate(
    vehicle: str | os.PathLike[str] = "rover_216_cvt",
    *,
    lubricant: str | None = None,
    set: Set = None,
    rows: Iterable[str] | str = (),
    only_rows: bool = False,
    chapter: str | None = None,
) -> dict[str, Any]:
    """Compares the model with published values and with the user's own files of ``rows``, as ``cvtcycle validate --json`` does."""
    own = texts("rows", rows)
    word = path_word("vehicle", vehicle)
    found = _native.validate(word, lubricant, assignments(set), own, not only_rows, chapter)
    report: dict[str, Any] = json.loads(found)
    return report


def calibrate(
    plan: str | os.PathLike[str],
    *,
    starts: int | None = None,
    seed: int | None = None,
    folds: bool = True,
    threads: int | None = None,
) -> dict[str, Any]:
    """Fits parameters to measurements, as ``cvtcycle calibrate --json`` does. Without ``folds`` it computes no prediction errors."""
    found: dict[str, Any] = json.loads(_native.calibrate(path_word("plan", plan), starts, seed, folds, threads))
    return found
