"""Cars and cycles."""

from __future__ import annotations

import json
import numbers
import os
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from . import _native
from ._errors import bad
from ._table import table_text, texts, timed_columns

Set = Mapping[str, Any] | Iterable[str] | None
"""Changes of values: a mapping from key to value, or texts ``KEY=VALUE``."""


def path_word(key: str, path: object) -> str:
    """Converts a name or path to text."""
    if not isinstance(path, (str, os.PathLike)):
        raise bad(key, f"{type(path).__name__} is no name and no path", allowed="a text or a path")
    return os.fspath(path)


def assignments(changes: Set) -> list[str]:
    """Converts changes of values to texts ``KEY=VALUE``."""
    if changes is None:
        return []
    if isinstance(changes, Mapping):
        return [f"{key}={_toml(str(key), value)}" for key, value in changes.items()]
    return texts("set", changes)


def _toml(key: str, value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, numbers.Integral):
        return str(int(value))
    if isinstance(value, numbers.Real):
        return repr(float(value))
    if isinstance(value, str):
        return value
    if isinstance(value, (list, tuple)) or hasattr(value, "tolist"):
        items = value.tolist() if hasattr(value, "tolist") else value
        if not isinstance(items, (list, tuple)):
            return _toml(key, items)
        return "[" + ", ".join(_quoted(key, item) for item in items) + "]"
    raise bad("set", f"{key}: a value of type {type(value).__name__} cannot be set", allowed="numbers, texts, lists of them")


def _quoted(key: str, value: Any) -> str:
    return json.dumps(value) if isinstance(value, str) else _toml(key, value)


def _plain(place: str, value: Any) -> Any:
    """Converts a value of a dict to JSON types."""
    if isinstance(value, Mapping):
        return {str(name): _plain(f"{place}.{name}" if place else str(name), own) for name, own in value.items()}
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return [_plain(f"{place}[{k}]", own) for k, own in enumerate(value)]
    if isinstance(value, float) and (value != value or value in (float("inf"), float("-inf"))):
        raise bad(place, f"{value} is not a finite number")
    if isinstance(value, (bool, int, float, str)):
        return value
    raise bad(place, f"a value of type {type(value).__name__} has no place in a vehicle file")


class Car:
    """A car with its fluids, checked.

    ``word`` is a shipped vehicle (``names("vehicle")``) or the path of a vehicle file. ``set`` changes values:
    ``{"transmission.cvt.pump.displacement_cc_rev": 7}``, a mapping from key to value in the unit of the key; a key that ends in ``*``
    multiplies, one that ends in ``+`` adds. ``lubricant`` and ``engine_oil`` are names or paths in place of the vehicle's own.
    """

    def __init__(
        self,
        word: str | os.PathLike[str],
        *,
        set: Set = None,
        lubricant: str | None = None,
        engine_oil: str | None = None,
        formulation: str = "smooth",
    ) -> None:
        word = path_word("word", word)
        self._made: tuple[Any, ...] = ("word", word, assignments(set), lubricant, engine_oil, formulation)
        self._car = _native.Car(*self._made[1:])

    @classmethod
    def _build(cls, made: tuple[Any, ...]) -> Car:
        car = cls.__new__(cls)
        kind, *rest = made
        car._made = made
        if kind == "twin":
            car._car = cls._build(rest[0])._car.twin()
        else:
            car._car = (_native.Car if kind == "word" else _native.Car.from_text)(*rest)
        return car

    def __reduce__(self) -> tuple[Any, ...]:
        return Car._build, (self._made,)

    @classmethod
    def from_toml(
        cls,
        text: str,
        *,
        name: str = "text.toml",
        folder: str | os.PathLike[str] = ".",
        set: Set = None,
        lubricant: str | None = None,
        engine_oil: str | None = None,
        formulation: str = "smooth",
    ) -> Car:
        """Reads the text of a vehicle file. Problems cite it as ``name``; relative paths of maps start at ``folder``."""
        if not isinstance(text, str):
            raise bad("text", f"{type(text).__name__} is no text")
        folder = path_word("folder", folder)
        return cls._build(("text", name, text, folder, assignments(set), lubricant, engine_oil, formulation))

    @classmethod
    def from_dict(cls, data: Mapping[str, Any], **options: Any) -> Car:
        """Reads the tables of a vehicle file as dicts; options as in :meth:`from_toml`."""
        if not isinstance(data, Mapping):
            raise bad("data", f"{type(data).__name__} is no dict")
        return cls.from_toml(_native.Car.json_to_toml(json.dumps(_plain("", data))), **{"name": "dict.toml", **options})

    def accelerate(
        self,
        from_kmh: float | None = None,
        to_kmh: float | None = None,
        *,
        grip: float | None = 0.9,
        driven: str = "front",
        axle_share: float | None = None,
        height_over_base: float = 0.21,
        grade_percent: float = 0.0,
        shift_s: float = 0.5,
        gear: int | None = None,
        ambient_degc: float = 25.0,
        start: str | float | Mapping[str, float] = "coolant=90,sump=80",
        dt_s: float = 0.05,
    ) -> dict[str, Any]:
        """Full-throttle times, as ``cvtcycle accelerate --json`` prints them: ``spans`` with times and errors, ``drives`` with what happened.

        Without speeds 0-100 km/h, 0-60 mph, 80-120 km/h, a quarter mile and 1000 m. ``grip`` is the friction coefficient of the ``driven`` tyres
        (``front``, ``rear``, ``all``), None for no limit. ``gear`` keeps a gear of a manual box. ``start`` as in :func:`run`. A load is
        ``set={"road_load.payload_kg+": 150}`` of the car.
        """
        speeds = None
        if from_kmh is not None or to_kmh is not None:
            speeds = (0.0 if from_kmh is None else from_kmh, 100.0 if to_kmh is None else to_kmh)
        start = dict(start) if isinstance(start, Mapping) else start
        found: dict[str, Any] = json.loads(
            self._car.accelerate(
                speeds, grip, driven, axle_share, height_over_base, grade_percent, shift_s, gear, ambient_degc, start, dt_s
            )
        )
        return found

    def answer(
        self,
        cycle: str = "ece15_eudc",
        *,
        ambient_degc: float = 25.0,
        start: str | float | Mapping[str, float] = "soak",
        baselines: Sequence[str] | None = None,
        draws: int = 256,
        levers: bool = True,
        dt_s: float = 1.0,
    ) -> dict[str, Any]:
        """What page 1 of ``cvtcycle report`` says, from one sample of the uncertain values: the same numbers, as ``report --json`` has them.

        ``fuel_l_per_100km`` and each of ``prices`` (per cent of the fuel that a loss costs) are quantiles 0.05, 0.5 and 0.95;
        ``differences`` the car against itself before ``set`` and ``lubricant`` and against each of ``baselines`` (those of its file by
        default), per cent; ``levers`` what changes of the design save, with side effects; ``information`` which value is worth a test. ``levers``
        False leaves the changes out. The car must have a file. 256 draws of 25 levers take about ten seconds.

        >>> import cvtcycle
        >>> found = cvtcycle.Car("rover_216_cvt").answer("ece15", draws=16, levers=False)
        >>> [name for name, _ in found["differences"]]
        ['rover_216_5mt', 'mondeo_20_5mt']
        """
        start = dict(start) if isinstance(start, Mapping) else start
        others = None if baselines is None else list(baselines)
        found: dict[str, Any] = json.loads(self._car.answer(cycle, ambient_degc, start, others, draws, levers, dt_s))
        return found

    def twin(self) -> Car:
        """Same car with a manual box."""
        return Car._build(("twin", self._made))

    @property
    def name(self) -> str:
        """Name of its file."""
        return self._car.name

    @property
    def title(self) -> str:
        """Title for display."""
        return self._car.title

    @property
    def is_cvt(self) -> bool:
        """True for a CVT, False for a manual box."""
        return self._car.is_cvt

    @property
    def baselines(self) -> list[str]:
        """Baselines of its file, for ``baselines`` of :func:`run`."""
        return self._car.baselines

    @property
    def notes(self) -> list[str]:
        """Notes on its results, one sentence each."""
        return self._car.notes

    def keys(self) -> list[dict[str, str]]:
        """Every key with value, unit, status, source, note, allowed values and meaning."""
        listed: list[dict[str, str]] = json.loads(self._car.keys())
        return listed

    def __getitem__(self, key: str) -> str:
        """Value of a key as written in its file."""
        for own in self.keys():
            if own["key"] == key:
                return own["value"]
        raise KeyError(key)

    def __repr__(self) -> str:
        return f"<cvtcycle.Car {self.name}: {self.title}>"


class Cycle:
    """A drive cycle: a shipped one (``names("cycle")``), ``constant_V`` with V in km/h, or the path of a table of time and speed."""

    def __init__(self, word: str | os.PathLike[str]) -> None:
        self._made: tuple[Any, ...] = ("word", path_word("word", word), None, None)
        self._cycle = _native.Cycle(*self._made[1:])

    @classmethod
    def _build(cls, made: tuple[Any, ...]) -> Cycle:
        cycle = cls.__new__(cls)
        kind, *rest = made
        cycle._made = made
        cycle._cycle = (_native.Cycle if kind == "word" else _native.Cycle.from_bytes)(*rest)
        return cycle

    def __reduce__(self) -> tuple[Any, ...]:
        return Cycle._build, (self._made,)

    @classmethod
    def read(cls, file: Any, *, columns: str | None = None, repair: str | None = None) -> Cycle:
        """Reads a path or an open file in the program's own form, or of EPA, FASTSim, VECTO or a logger.

        ``columns`` names those that are meant, such as ``time=Time_ADC:s,speed=VehSpd:mph``; ``repair`` the repairs of a log that are
        wanted, such as ``cut,no-smooth``. What was repaired is in :attr:`repairs`, what is doubted in :attr:`doubts`.
        """
        if not hasattr(file, "read"):
            return cls._build(("word", os.path.join(os.path.dirname(path_word("file", file)) or ".", os.path.basename(file)), columns, repair))
        try:
            data = file.read()
        except (OSError, ValueError) as error:
            raise bad("file", f"cannot read it: {error}") from error
        name = str(getattr(file, "name", "file"))
        return cls._build(("text", name, data.encode() if isinstance(data, str) else bytes(data), columns, repair))

    @classmethod
    def from_arrays(
        cls,
        time_s: Any,
        speed_m_s: Any,
        *,
        grade: Any = None,
        phase: Any = None,
        gear: Any = None,
        engine_off: Any = None,
        name: str = "arrays",
    ) -> Cycle:
        """Builds a cycle from arrays: time in s, speed in m/s, slope as rise over run, names of phases, gears, and 1 while the engine is off, else 0."""
        given = {
            "time_s": time_s,
            "speed_m_s": speed_m_s,
            "grade": grade,
            "phase": phase,
            "gear": gear,
            "engine_off": engine_off,
        }
        return cls.from_frame({key: values for key, values in given.items() if values is not None}, name=name)

    @classmethod
    def from_frame(cls, frame: Any, *, name: str = "frame", columns: str | None = None, repair: str | None = None) -> Cycle:
        """Builds a cycle from a frame or mapping with the columns of a cycle file, such as ``time_s`` and ``speed_kmh``.

        Times may be datetimes, timedeltas or the index of a pandas frame; columns that mean nothing are passed over. ``columns`` and
        ``repair`` as in :meth:`read`.
        """
        return cls._build(("text", name, table_text(timed_columns("frame", frame)), columns, repair))

    @property
    def name(self) -> str:
        """Name used in results."""
        return self._cycle.name

    @property
    def title(self) -> str:
        """Title for display."""
        return self._cycle.title

    @property
    def read_as(self) -> str | None:
        """Interpretation of a file of another program; None for the program's own form."""
        return self._cycle.read_as

    @property
    def repairs(self) -> list[tuple[str, int, str]]:
        """Repairs of its recording: name, count, what was done."""
        return self._cycle.repairs

    @property
    def doubts(self) -> list[str]:
        """Doubts about its recording, a sentence each."""
        return self._cycle.doubts

    @property
    def phases(self) -> list[str]:
        """Names of its phases."""
        return self._cycle.phases

    @property
    def duration_s(self) -> float:
        """Duration, s."""
        return self._cycle.duration_s

    @property
    def distance_m(self) -> float:
        """Distance of a car with a CVT, m."""
        return self._cycle.distance_m

    def __repr__(self) -> str:
        return f"<cvtcycle.Cycle {self.name}: {self.duration_s:g} s, {self.distance_m / 1000:.3f} km>"
