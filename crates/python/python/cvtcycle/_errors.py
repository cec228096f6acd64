"""Exceptions of the package."""

from __future__ import annotations

from typing import TypedDict


class Problem(TypedDict):
    """One problem of an input. A part that is not known is None, or an empty text."""

    kind: str
    """Word for programs, such as ``out_of_range``."""
    file: str | None
    """File, or the name that was given to a text."""
    line: int | None
    """Line in the file, from 1."""
    column: int | None
    """Column in the line, from 1."""
    override: str | None
    """The change of a value that it is about, ``KEY=VALUE``."""
    argument: str | None
    """What it is about where that is a name or a path: ``vehicle``, ``cycle``, ``plan``."""
    key: str
    """Key of the file, column of the table, or argument of the call."""
    value: str
    """The value as it was given."""
    allowed: str
    """What would be accepted."""
    message: str
    """What is wrong, in a sentence."""
    hint: str
    """What to do about it."""
    suggested: list[str]
    """Known names that may have been meant."""


class InputError(ValueError):
    """An input has problems; ``problems`` has all of them, the text of the exception describes them."""

    problems: list[Problem]

    def __init__(self, text: str, problems: list[Problem]) -> None:
        super().__init__(text, problems)
        self.problems = problems

    def __str__(self) -> str:
        return str(self.args[0])


def bad(key: str, message: str, *, value: str = "", allowed: str = "", hint: str = "") -> InputError:
    """The exception of an argument."""
    problem: Problem = {
        "kind": "invalid",
        "file": None,
        "line": None,
        "column": None,
        "override": None,
        "argument": None,
        "key": key,
        "value": value,
        "allowed": allowed,
        "message": message,
        "hint": hint,
        "suggested": [],
    }
    lines = [f"{key}: {message}"]
    lines += [f"  allowed: {allowed}"] if allowed else []
    lines += [f"  hint: {hint}"] if hint else []
    return InputError("\n".join(lines), [problem])
