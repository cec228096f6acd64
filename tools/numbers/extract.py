"""Reads the numbers of an output file, by key. Words, notes and paths are left out.

A table is a dict: key -> Column. For CSV and worksheets a key is the name of a column; for JSON and TOML it is the
path of the value without positions, such as `runs[].loss_kj.pump`. In vehicle files all keys are one: `{}.value`.
"""

import csv
import hashlib
import itertools
import json
import re
import struct
import tomllib
import xml.etree.ElementTree as xml
import zipfile
from array import array

# Not numbers of the program: prose, names of files, versions, hashes of texts.
SKIPPED = set(
    "schema program build run command version sha256 plan_sha256 resolved_sha256 file path files title question what condition"
    " label reason cause remark note source doc meaning printed tolerance unit".split()
)
# Words that are results: they are compared as they are. renamed.txt maps a new word to the old one.
RESULT_WORDS = set("bytes flags status belt_status verdict recorded phase branch formulation end".split())
# Texts whose numbers count although there are words between them.
RANGES = {"allowed"}
# What names an element of a list, so that the order of the list does not matter. First all of these that there are.
IDENTITY = "car vehicle role output id key name factor level".split()

NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?|[-+]?inf|NaN|nan")
NUMBER_IN_WORDS = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?(?!\w)")
NUMBER_LIST = re.compile(r"[\s\[\],eE.+-]*\d[\s\[\],0-9eE.+-]*")
UNIT = re.compile(r" \[[^\]]*\]$")


class Column:
    """The cells of one key, in the order of the file. `paths` is None where the row number is the path."""

    def __init__(self, paths, cells):
        self.paths, self.cells = paths, cells

    def digest(self, key):
        """Hash of all cells."""
        if self.paths is None:
            try:
                return hashlib.sha256(array("d", map(float, self.cells)).tobytes()).digest()
            except ValueError:
                return hashlib.sha256(b"".join(token(key, cell) for cell in self.cells)).digest()
        cells = sorted((path, token(key, cell)) for path, cell in zip(self.paths, self.cells))
        return hashlib.sha256(b"".join(path.encode() + b"\0" + cell + b"\n" for path, cell in cells)).digest()

    def by_path(self):
        """Dict from path to cell."""
        if self.paths is None:
            return {f"row {number}": cell for number, cell in enumerate(self.cells, 1)}
        return dict(zip(self.paths, self.cells))


def last_name(key):
    """The last name of a key: `flags` of `rows[].flags[]`."""
    return key.removesuffix("[]").rsplit(".", 1)[-1]


def token(key, cell):
    """Bytes of one cell: the 64 bits of a number, a result word, or a mark for an empty cell or prose."""
    if cell is None or cell == "":
        return b"-"
    if not isinstance(cell, str):
        return struct.pack("<d", cell)
    name = last_name(key)
    if NUMBER.fullmatch(cell):
        return struct.pack("<d", float(cell))
    if name in RESULT_WORDS:
        return b'"' + cell.encode() + b'"'
    if name in RANGES or NUMBER_LIST.fullmatch(cell):
        numbers = [float(text) for text in NUMBER_IN_WORDS.findall(cell)]
        return b"[" + struct.pack(f"<{len(numbers)}d", *numbers) + b"]"
    return b"?"


def is_prose(key, column):
    """Whether a column holds words only, which are no results."""
    if last_name(key) in SKIPPED:
        return True
    has_words = False
    for cell in column.cells:
        kind = token(key, cell)
        if kind not in (b"-", b"?"):
            return False
        has_words |= kind == b"?"
    return has_words


def numbers_of(table):
    """How many cells a table has."""
    return sum(len(column.cells) for column in table.values())


class Renamed:
    """New names of keys and words, to the names that the hashes were written with."""

    def __init__(self, names=()):
        self.names = dict(names)

    def __call__(self, name):
        if not self.names:
            return name
        whole = self.names.get(name)
        return whole or ".".join(self.names.get(part, part) for part in name.split("."))


def from_rows(rows, renamed):
    """Table of a header and rows of texts."""
    rows = list(rows)
    header = [renamed(UNIT.sub("", name.removeprefix("\ufeff"))) for name in rows[0]]
    columns = list(itertools.zip_longest(*rows[1:], fillvalue="")) or [()] * len(header)
    table = {}
    for number, cells in enumerate(columns):
        name = header[number] if number < len(header) else f"(column {number + 1})"
        while name in table:
            name += "'"
        if last_name(name) in RESULT_WORDS and renamed.names:
            cells = tuple("|".join(renamed(word) for word in cell.split("|")) for cell in cells)
        table[name] = Column(None, cells)
    return table


def identities(items, renamed):
    """Names of the elements of a list: from fields that name them where these are unique, else their positions."""
    if items and all(isinstance(item, dict) for item in items):
        fields = [
            field
            for field in IDENTITY
            if all(isinstance(i.get(field), (str, float)) and re.fullmatch(r"[\w.|+-]+", str(i[field])) for i in items)
        ]
        names = [",".join(renamed(str(item[field])) for field in fields) for item in items]
        if fields and len(set(names)) == len(names):
            return names
    return [str(number) for number in range(len(items))]


def from_tree(tree, renamed, one_key=False):
    """Table of a JSON or TOML value. Names with a dot are paths, no keys; with `one_key` those of all inner tables."""
    found = {}

    def walk(value, key, path):
        if isinstance(value, dict):
            for name, inner in value.items():
                name = renamed(name)
                if one_key and isinstance(inner, dict):
                    below = "{}"
                else:
                    last = "{}" if "." in name else name
                    below = f"{key}.{last}" if key else last
                walk(inner, below, f"{path}.{name}" if path else name)
        elif isinstance(value, list):
            if not value and last_name(key) in RESULT_WORDS:
                # No flags: that is a result.
                found.setdefault(f"{key}[]", ([], []))
            for name, inner in zip(identities(value, renamed), value):
                walk(inner, f"{key}[]", f"{path}[{name}]")
        else:
            if isinstance(value, str) and last_name(key) in RESULT_WORDS:
                value = renamed(value)
            paths, cells = found.setdefault(key, ([], []))
            paths.append(path)
            cells.append(value)

    walk(tree, "", "")
    return {key: Column(paths, cells) for key, (paths, cells) in found.items()}


def sheet_rows(file):
    """Rows of texts of the first sheet of a workbook."""
    space = "{http://schemas.openxmlformats.org/spreadsheetml/2006/main}"
    with zipfile.ZipFile(file) as book:
        shared = []
        if "xl/sharedStrings.xml" in book.namelist():
            items = xml.fromstring(book.read("xl/sharedStrings.xml")).iter(f"{space}si")
            shared = ["".join(text.text or "" for text in item.iter(f"{space}t")) for item in items]
        for row in xml.fromstring(book.read("xl/worksheets/sheet1.xml")).iter(f"{space}row"):
            cells = []
            for cell in row.iter(f"{space}c"):
                position = 0
                for letter in re.match("[A-Z]+", cell.get("r")).group():
                    position = 26 * position + ord(letter) - ord("A") + 1
                cells += [""] * (position - 1 - len(cells))
                value = cell.find(f"{space}v")
                text = "".join(part.text or "" for part in cell.iter(f"{space}t")) if value is None else value.text
                cells.append(shared[int(text)] if cell.get("t") == "s" else text)
            yield cells


def read(directory, pattern, kind, renamed):
    """Table of an output file; for kind `bytes` the hash of each file that `pattern` names."""
    files = sorted(directory.glob(pattern))
    if not files:
        raise FileNotFoundError(f"the program wrote no {pattern}")
    if kind == "bytes":
        hashes = [hashlib.sha256(file.read_bytes()).hexdigest() for file in files]
        return {"bytes": Column([file.name for file in files], hashes)}
    file = files[0]
    if kind == "csv":
        with open(file, newline="", encoding="utf-8") as lines:
            table = from_rows(csv.reader(lines), renamed)
    elif kind == "xlsx":
        table = from_rows(sheet_rows(file), renamed)
    elif kind == "json":
        table = from_tree(json.loads(file.read_text(encoding="utf-8"), parse_int=float), renamed)
    else:
        table = from_tree(tomllib.loads(file.read_text(encoding="utf-8")), renamed, one_key=True)
    return {key: column for key, column in table.items() if not is_prose(key, column)}
