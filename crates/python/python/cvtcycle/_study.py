"""Studies: many runs of a plan."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from typing import Any

from . import _native
from ._car import path_word
from ._errors import bad
from ._table import Table, texts


class StoredStudy:
    """A study in a folder, finished or not."""

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self.folder = path_word("folder", folder)
        self._study = _native.StoredStudy(self.folder)

    @property
    def parts(self) -> tuple[int, int]:
        """Number of parts present, and in total."""
        return self._study.parts

    def answer(self, confidence: float | None = None) -> dict[str, Any]:
        """Results of the study, as ``cvtcycle study show --json`` prints them."""
        found: dict[str, Any] = json.loads(self._study.answer(confidence))
        return found

    def table(self, columns: Iterable[str] | str = ()) -> Table:
        """Runs of the parts present: some columns, or all."""
        return Table(self._study.table(texts("columns", columns)))

    def __repr__(self) -> str:
        return "<cvtcycle.StoredStudy {}: {} of {} parts>".format(self.folder, *self.parts)


class Study:
    """Plan with its cars loaded and every value tried: a shipped plan (``names("plan")``), or the path of a TOML file."""

    def __init__(
        self, plan: str | os.PathLike[str], *, samples: int | None = None, seed: int | None = None
    ) -> None:
        self._study = _native.Study(path_word("plan", plan), None, samples, seed)

    @classmethod
    def from_toml(
        cls, text: str, *, name: str = "plan.toml", samples: int | None = None, seed: int | None = None
    ) -> Study:
        """Reads the text of a plan, which problems cite as ``name``."""
        study = cls.__new__(cls)
        study._study = _native.Study(name, text, samples, seed)
        return study

    @staticmethod
    def open(folder: str | os.PathLike[str]) -> StoredStudy:
        """Opens the study in a folder."""
        return StoredStudy(folder)

    @staticmethod
    def merge(
        folder: str | os.PathLike[str], shards: Iterable[str | os.PathLike[str]], *, force: bool = False
    ) -> StoredStudy:
        """Merges shards, folders with parts of one plan, and writes the results: byte for byte the study of one machine."""
        if isinstance(shards, (str, bytes, os.PathLike)):
            raise bad("shards", f"{type(shards).__name__} is no list of folders")
        _native.StoredStudy.merge(path_word("folder", folder), [path_word("shards", own) for own in shards], force)
        return StoredStudy(folder)

    @property
    def title(self) -> str:
        """Title of the plan."""
        return self._study.title

    @property
    def points(self) -> int:
        """Number of points of the design."""
        return self._study.points

    @property
    def runs(self) -> int:
        """Number of runs: points times cars."""
        return self._study.runs

    @property
    def parts(self) -> int:
        """Number of parts, the units in which points are written."""
        return self._study.parts

    @property
    def points_per_part(self) -> int:
        """Number of points of a part; the last part may have fewer."""
        return self._study.points_per_part

    def run(self, parts: tuple[int, int] | None = None, *, threads: int | None = None) -> Table:
        """Drives the points of the parts from ``parts[0]`` up to, excluding, ``parts[1]``; of all parts by default."""
        return Table(self._study.run(self._range(parts), threads))

    def write_parts(
        self, parts: tuple[int, int] | None, folder: str | os.PathLike[str], *, threads: int | None = None
    ) -> int:
        """Writes missing parts into a folder, and returns the number of parts there."""
        return self._study.write_parts(self._range(parts), path_word("folder", folder), threads)

    def _range(self, parts: tuple[int, int] | None) -> tuple[int, int]:
        return (0, self.parts) if parts is None else parts

    def __repr__(self) -> str:
        return f"<cvtcycle.Study {self.title!r}: {self.points} points, {self.runs} runs, {self.parts} parts>"
