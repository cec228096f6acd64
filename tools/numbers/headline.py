"""The headline values: the commands that make them, and the numbers that are picked from their outputs."""

import csv
import json
import re

import extract
from jobs import EXAMPLE, FACTORS

LAST = "--quiet --out out".split()
PLAIN = [*"--price never --sensitivity never".split(), *LAST]
# Units by the end of a name, the longest end first.
UNITS = {
    "l_per_100km": "L/100 km",
    "g_per_km": "g/km",
    "_mpg": "mpg",
    "percent": "%",
    "_kj": "kJ",
    "_km": "km",
    "degc": "degC",
    "_bar": "bar",
    "_nm": "N m",
    "_rpm": "rpm",
    "_m_s": "m/s",
    "_kg": "kg",
    "_g": "g",
    "_w_k": "W/K",
    "_s": "s",
}
BELT_POINTS = """formulation,ratio,input_speed_rpm,secondary_pressure_bar,output_torque_nm
appendix_c,2.416,2000,30,60
appendix_c,1.2,2500,20,20
appendix_c,0.5,4000,10,15
chapter_8,2.416,2000,30,60
chapter_8,1.2,2500,20,20
chapter_8,0.5,4000,10,15
smooth,2.416,2000,30,60
smooth,1.2,2500,20,20
smooth,0.5,4000,10,15
smooth,1.5,1000,15,-20
"""
MONTE_CARLO = """[study]
title = "headline values"
baselines = ["rover_216_5mt"]
cycle = "ece15"
[study.design.monte_carlo]
samples = 100

"""
FILES = {"points.csv": BELT_POINTS, "monte_carlo.toml": MONTE_CARLO + FACTORS.read_text(encoding="utf-8")}
OPTIMUM = "--grid 49 --dt 1 --no-line --json".split()

# Topic, arguments, file, and the paths that are kept. `*` is a name or a place in a list; a pattern also takes what is
# below it. For a CSV file: (columns that name a row, columns of values, condition on the row or None).
PICKS = []
for _cycle in ["ece15_eudc", "ftp75", "wltc_class3b", "hwfet", "jp_10_15_mode"]:
    for _ambient in ("-10", "25"):
        _short = f"{_cycle}/{_ambient}"
        _command = ["run", "--cycle", _cycle, "--ambient", _ambient, *PLAIN]
        _paths = ["runs[*].fuel_l_per_100km", "comparison[*].fuel_percent"]
        if _cycle in ("ece15_eudc", "ftp75"):
            _paths += ["runs[*].phases[*].fuel_l_per_100km"]
        if _cycle == "ece15_eudc":
            _paths += ["runs[*].end_degc.transmission_sump", "runs[*].end_degc.coolant"]
            _paths += [f"runs[{car}].loss_kj" for car in ("rover_216_cvt,subject", "rover_216_5mt,baseline")]
        PICKS.append((f"run/{_short}", _command, "out/summary.json", _paths))
PICKS += [
    (
        "run/civic/wltc_class3b/23",
        ["run", *"--vehicle civic_20_cvt --baseline civic_20_6mt --cycle wltc_class3b --ambient 23".split(), *PLAIN],
        "out/summary.json",
        ["runs[*].fuel_l_per_100km", "comparison[*].fuel_percent", "runs[civic_20_cvt,subject].loss_kj"],
    ),
    (
        "attribute/ece15_eudc/-10",
        "attribute --cycle ece15_eudc --ambient -10 --json".split(),
        "out_1",
        ["conditions[*].runs[*].price.losses.*.l_per_100km", "conditions[*].runs[*].price.together.l_per_100km"],
    ),
    (
        "label",
        "label rover_216_cvt civic_20_cvt --json".split(),
        "out_1",
        ["cars[*].derived.*_mpg", "cars[*].five_cycle.*_mpg", "cars[*].wltp[*].co2_g_per_km", "cars[*].co2_14_over_23"],
    ),
    (
        "levers",
        "levers --samples 16 --json".split(),
        "out_1",
        ["blocks[*].rows[*].fuel_percent.value"],
    ),
    (
        "optimum/ece15_eudc/25",
        ["optimum", *OPTIMUM],
        "out_1",
        ["bounds[*].own_l_per_100km", "bounds[*].least_l_per_100km", "bounds[*].driven_l_per_100km"],
    ),
    (
        "rig/transmission",
        ["rig", "transmission", *LAST],
        "out/summary.json",
        ["steady.ranges[*].*_*.from", "steady.ranges[*].*_*.to"],
    ),
    (
        "rig/variator",
        ["rig", "variator", *LAST],
        "out/curves.csv",
        (["belt_ratio", "secondary_pressure_bar"], ["capacity_nm"], None),
    ),
    (
        "belt",
        ["belt", "--points", "points.csv", "--quiet"],
        "out_1",
        (
            ["formulation", "ratio", "input_speed_rpm", "secondary_pressure_bar", "output_torque_nm"],
            ["belt_loss_nm", "slip_percent"],
            None,
        ),
    ),
    (
        "validate",
        ["validate", *LAST],
        "out/summary.json",
        ["counts", "groups.*.counts.agrees", "groups.*.counts.differs", "groups.*.held_out"],
    ),
    (
        "study/ambient",
        ["study", "ambient", *LAST],
        "out/matrix.csv",
        (
            ["output", "car", "row", "column"],
            ["value"],
            lambda row: row["output"] == "headline_fuel_l_per_100km" and row["row"] in ("-10 °C", "40 °C"),
        ),
    ),
    (
        "study/pump_and_offset",
        ["study", "pump_and_offset", *LAST],
        "out/statistics.json",
        ["outputs[*headline_fuel*].range.least", "outputs[*headline_fuel*].range.largest"],
    ),
    (
        "study/oil_at_minus_10",
        ["study", "oil_at_minus_10", *LAST],
        "out/tornado.csv",
        (["output", "car", "factor", "level"], ["value"], lambda row: row["output"] == "subject_excess_percent"),
    ),
    (
        "study/monte_carlo",
        ["study", "monte_carlo.toml", *LAST],
        "out/statistics.json",
        ["outputs[*headline_fuel*].summary.mean", "outputs[*headline_fuel*].summary.sd"]
        + [f"comparisons[*].excess_percent.{name}" for name in ("mean", "sd")],
    ),
    (
        "uncertainty",
        ["study", "uncertainty_rover", "--samples", "16", *LAST],
        "out/statistics.json",
        ["outputs[*headline_fuel*].summary.mean", "outputs[*headline_fuel*].summary.sd"]
        + [f"comparisons[*].excess_percent.{name}" for name in ("mean", "sd", "min", "max")],
    ),
    (
        "uncertainty/index",
        ["study", "uncertainty_rover", "--samples", "16", *LAST],
        "out/sobol_indices.csv",
        (
            ["output", "car", "factor"],
            ["first", "total"],
            lambda row: (
                row["output"] == "subject_excess_percent"
                and row["samples"] == "16"
                and row["factor"] in ("gear set", "engine efficiency over load", "hot engine friction")
            ),
        ),
    ),
]
for _name, _plan, _more in (
    ("transmission", "rover_216_transmission", ["--starts", "1", "--no-folds"]),
    ("warm_up", "rover_216_warm_up", []),
    ("example", str(EXAMPLE), []),
):
    _paths = [
        "cost_before",
        "cost_after",
        "chi2",
        "degrees_of_freedom",
        "parameters[*].value",
        "folds[*].predicted_rms_sd",
    ]
    PICKS.append((f"calibrate/{_name}", ["calibrate", _plan, *_more, "--json"], "out_1", _paths))


def unit_of(name):
    """Unit by the end of a name; of the part before where the last one is a component or a statistic."""
    parts = name.split("/")
    if "." in parts[-1]:
        return "unit of the key"
    if parts[-1] in ("first", "total"):
        return "1"
    for part in reversed(parts):
        for end, unit in UNITS.items():
            if part.endswith(end):
                return unit
    return "1"


def short(path):
    """Name of a path: `runs[rover_216_cvt,subject].loss_kj.pump` is `rover_216_cvt/loss_kj/pump`."""
    path = re.sub(r"^comparisons?\[", "over[", path.removeprefix("conditions[-10.0]."))
    parts = []
    for name, element in re.findall(r"([^.\[\]]+)|\[([^\]]*)\]", path):
        if element and parts and parts[-1] != "over":
            parts.pop()
        # Of a name of several fields, those that the path does not have yet: `rover_216_cvt,subject`.
        parts += (
            [name] if name else [part for part in element.split(",") if part not in [*parts, "subject", "baseline"]]
        )
    return "/".join(part for part in parts if part not in ("value", "summary", "price", "losses", "groups", "range"))


def matcher(pattern):
    """Regular expression of a path pattern: `*` takes a name, in brackets all of them."""
    text = re.sub(r"\\\[.*?\\\]", lambda part: part[0].replace(r"\*", r"[^\]]*"), re.escape(pattern))
    return re.compile(text.replace(r"\*", r"[^.\[\]]*") + r"(?:$|[.\[])")


def from_json(file, patterns):
    """(name, value) of the paths that match one of the patterns."""
    table = extract.from_tree(json.loads(file.read_text(encoding="utf-8"), parse_int=float))
    found = [matcher(pattern) for pattern in patterns]
    for column in table.values():
        for path, cell in zip(column.paths, column.cells):
            if isinstance(cell, float) and any(pattern.match(path) for pattern in found):
                yield short(path), cell


def from_csv(file, names, values, condition):
    """(name, value) of some columns of the rows that a condition takes."""
    with open(file, newline="", encoding="utf-8") as lines:
        for row in csv.DictReader(lines):
            if condition is None or condition(row):
                for value in values:
                    if row[value]:
                        yield (
                            "/".join([*(row[name] for name in names), *([] if value == "value" else [value])]),
                            float(row[value]),
                        )


def read(directory, topic, file, paths):
    """Name -> (value, unit) of one pick."""
    if isinstance(paths, tuple):
        found = from_csv(directory / file, *paths)
    else:
        found = from_json(directory / file, paths)
    values = {f"{topic}/{name}": value for name, value in found}
    if not values:
        raise LookupError(f"{topic}: {file} holds none of the numbers that are picked")
    return {name: (value, unit_of(name)) for name, value in values.items()}
