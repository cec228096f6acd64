"""Reads the numbers of an output file, by key. Words, notes and paths are left out.

A table is a dict: key -> Column. For CSV a key is the name of a column; for JSON and TOML it is the path of the value
without positions, such as `runs[].loss_kj.pump`. In vehicle files all keys are one: `{}.value`.
"""

import csv
import itertools
import json
import re
import tomllib

# Not numbers of the program: prose, names of files, versions, hashes of texts.
SKIPPED = set(
    "schema program build run command version sha256 plan_sha256 resolved_sha256 file path files title question what"
    " condition label reason cause remark note source doc meaning printed tolerance unit".split()
)
# Words that are results: they are compared as they are.
RESULT_WORDS = set("exit flags status belt_status verdict recorded phase branch formulation end".split())
# Texts whose numbers count although there are words between them.
RANGES = {"allowed"}
# Fields that name an element of a list, so that the order of the list does not matter.
IDENTITY = "baseline car vehicle role output id key name factor level ambient_degc ratio clamp launch".split()

NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?|[-+]?inf|NaN|nan")
NUMBER_IN_WORDS = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?(?!\w)")
NUMBER_LIST = re.compile(r"[\s\[\],eE.+-]*\d[\s\[\],0-9eE.+-]*")
UNIT = re.compile(r" \[[^\]]*\]$")
PROSE = "(words)"


class Column:
    """The cells of one key, in the order of the file. `paths` is None where the row number is the path."""

    def __init__(self, paths, cells):
        self.paths, self.cells = paths, cells

    def by_path(self, key):
        """Dict from path to cell."""
        if self.paths is None:
            return {f"{key}, row {number}": cell for number, cell in enumerate(self.cells, 1)}
        return dict(zip(self.paths, self.cells))


def last_name(key):
    """The last name of a key: `flags` of `rows[].flags[]`."""
    return key.removesuffix("[]").rsplit(".", 1)[-1]


def value(key, cell):
    """A number, a list of numbers, a result word, None for an empty cell, or PROSE."""
    if cell is None or cell == "":
        return None
    if not isinstance(cell, str):
        return float(cell)
    name = last_name(key)
    if NUMBER.fullmatch(cell):
        return float(cell)
    if name in RESULT_WORDS:
        return cell
    if name in RANGES or NUMBER_LIST.fullmatch(cell):
        return [float(text) for text in NUMBER_IN_WORDS.findall(cell)]
    return PROSE


def is_prose(key, column):
    """True for a column that holds words only, which are no results."""
    if last_name(key) in SKIPPED:
        return True
    values = {str(value(key, cell)) for cell in column.cells} - {"None"}
    return values == {PROSE}


def from_rows(rows):
    """Table of a header and rows of texts."""
    rows = list(rows)
    header = [UNIT.sub("", name.removeprefix("\ufeff")) for name in rows[0]]
    columns = list(itertools.zip_longest(*rows[1:], fillvalue="")) or [()] * len(header)
    table = {}
    for number, cells in enumerate(columns):
        name = header[number] if number < len(header) else f"(column {number + 1})"
        while name in table:
            name += "'"
        table[name] = Column(None, cells)
    return table


def identities(items):
    """Names of the elements of a list: from fields that name them where these are unique, else their positions."""
    if items and all(isinstance(item, dict) for item in items):
        fields = [
            field
            for field in IDENTITY
            if all(isinstance(i.get(field), (str, float)) and re.fullmatch(r"[\w.|+ -]+", str(i[field])) for i in items)
        ]
        names = [",".join(str(item[field]) for field in fields) for item in items]
        if fields and len(set(names)) == len(names):
            return names
    return [str(number) for number in range(len(items))]


def from_tree(tree, one_key=False):
    """Table of a JSON or TOML value. Names with a dot are paths, no keys; with `one_key` those of all inner tables."""
    found = {}

    def walk(node, key, path):
        if isinstance(node, dict):
            for name, inner in node.items():
                if one_key and isinstance(inner, dict):
                    below = "{}"
                else:
                    last = "{}" if "." in name else name
                    below = f"{key}.{last}" if key else last
                walk(inner, below, f"{path}.{name}" if path else name)
        elif isinstance(node, list):
            if not node and last_name(key) in RESULT_WORDS:
                # An empty list of flags is a result.
                found.setdefault(f"{key}[]", ([], []))
            for name, inner in zip(identities(node), node):
                walk(inner, f"{key}[]", f"{path}[{name}]")
        else:
            paths, cells = found.setdefault(key, ([], []))
            paths.append(path)
            cells.append(node)

    walk(tree, "", "")
    return {key: Column(paths, cells) for key, (paths, cells) in found.items()}


def read(directory, pattern, kind):
    """Table of an output file."""
    files = sorted(directory.glob(pattern))
    if not files:
        raise FileNotFoundError(f"the program wrote no {pattern}")
    if kind == "csv":
        with open(files[0], newline="", encoding="utf-8") as lines:
            table = from_rows(csv.reader(lines))
    elif kind == "json":
        table = from_tree(json.loads(files[0].read_text(encoding="utf-8"), parse_int=float))
    else:
        table = from_tree(tomllib.loads(files[0].read_text(encoding="utf-8")), one_key=True)
    return {key: column for key, column in table.items() if not is_prose(key, column)}
