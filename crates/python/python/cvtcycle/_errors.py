"""Exceptions of the package."""

from __future__ import annotations

from typing import TypedDict


class Problem(TypedDict):
    """One problem of an input. An unknown part is None or an empty text."""

    kind: str
    """Machine-readable kind, such as ``out_of_range``."""
    file: str | None
    """File, or the name given to a text."""
    line: int | None
    """Line in the file, from 1."""
    column: int | None
    """Column in the line, from 1."""
    override: str | None
    """Change of a value concerned, ``KEY=VALUE``."""
    argument: str | None
    """Kind of the name or path concerned: ``vehicle``, ``cycle``, ``plan``."""
    key: str
    """Key of the file, column of the table, or argument of the call."""
    value: str
    """Value as given."""
    allowed: str
    """Accepted values."""
    message: str
    """Description of the problem, one sentence."""
    hint: str
    """Advice."""
    suggested: list[str]
    """Known names similar to the given one."""


class InputError(ValueError):
    """Bad input. ``problems`` has all problems, which the text of the exception describes."""

    problems: list[Problem]

    def __init__(self, text: str, problems: list[Problem]) -> None:
        super().__init__(text, problems)
        self.problems = problems

    def __str__(self) -> str:
        return str(self.args[0])


def bad(key: str, message: str, *, value: str = "", allowed: str = "", hint: str = "") -> InputError:
    """Exception for an argument."""
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
