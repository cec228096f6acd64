"""The commands that are run, and which of their outputs hold numbers."""

import csv
import io
import re
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
GOLDEN = ROOT / "tests/golden"
EXAMPLE = ROOT / "docs/calibration_example/plan.toml"
FACTORS = Path(__file__).resolve().parent / "factors.toml"

CVT = "rover_216_cvt"
CARS = [CVT, "rover_216_5mt", "mondeo_20_5mt"]
LUBRICANTS = "cvtf_ezl799_class dexron_ii dexron_iii engine_10w40 engine_5w30 gear_75w80".split()
CYCLES = """artemis_motorway130 artemis_motorway150 artemis_road artemis_urban ece15 ece15_auto ece15_eudc
    ece15_eudc_auto ece15_eudc_low ece15_eudc_low_auto eudc eudc_auto eudc_low ftp75 hwfet jc08 jp_10_15_mode la92
    mvega_idle40 nycc sc03 udds us06 wltc_class1 wltc_class2 wltc_class3a wltc_class3b""".split()


@dataclass
class Job:
    """Commands run in an empty directory, and the items that are read there."""

    name: str
    # Arguments of each command; its standard output goes to `out_N`, N from 1.
    commands: list
    # (name of the item, file or pattern, kind). The first one also holds the exit codes.
    items: list
    # Files written before: name -> text.
    files: dict = field(default_factory=dict)
    # Seconds on one core, roughly: long jobs start first.
    seconds: float = 0.2


def read_golden(name):
    """Rows of a table of tests/golden as dicts."""
    with open(GOLDEN / name, newline="", encoding="utf-8") as lines:
        return list(csv.DictReader(lines))


def to_csv(rows):
    """Text of rows that are dicts with the same keys."""
    text = io.StringIO()
    writer = csv.DictWriter(text, rows[0].keys(), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def drive(name, car, cycle, ambient, start, extra=(), files=None, before=()):
    """One run of one car with its trace."""
    run = ["run", "--vehicle", car, "--cycle", cycle, "--ambient", str(ambient), "--start", str(start)]
    run += ["--baseline", "none", "--price", "never", "--sensitivity", "never", "--out", "out", "--quiet", *extra]
    items = [(f"{name}/summary", "out/summary.json", "json"), (f"{name}/trace", "out/trace_*.csv", "csv")]
    return Job(name, [*before, run], items, files or {})


def runs():
    """Every car on every cycle, cold and at 25 degC, from a soak and warm."""
    for car in CARS:
        for cycle in CYCLES:
            for ambient in (-10, 25):
                for start in ("soak", "warm"):
                    yield drive(f"run/{car}/{cycle}/{ambient}/{start}", car, cycle, ambient, start)


# Options that no shipped car uses, and other values where a shipped one is zero or of no effect.
CVT_OPTIONS = {
    "clamp_torque_following": ["transmission.cvt.clamp=torque_following"],
    "clamp_slip_limited": ["transmission.cvt.clamp=slip_limited"],
    "pump_dual_cavity": ["transmission.cvt.pump.kind=dual_cavity"],
    "pump_variable": ["transmission.cvt.pump.kind=variable"],
    "pump_all_terms": [
        "transmission.cvt.pump.friction_coefficient=0.02",
        "transmission.cvt.pump.constant_nm=0.1",
        "transmission.cvt.pump.line_drop_bar=3",
    ],
    "pump_too_small": ["transmission.cvt.pump.displacement_cc_rev=2"],
    "uncompensated": ["transmission.cvt.variator.compensated=false"],
    "thrust_ratio": ["transmission.cvt.belt.thrust_ratio=[[0.4, 1.2], [1, 1.1], [2.5, 0.9]]"],
    "initial_gap": ["transmission.cvt.belt.initial_gap_mm=0.3"],
    "cooler_bypassed": ["thermal.cooler.bypassed=true"],
    "cooler_bypass_below": ["thermal.cooler.bypass_below_degc=5"],
    "cooler_none": ["thermal.cooler.fitted=false"],
    "no_lift_off": ["lubricant.friction.film.enabled=false"],
}
CAR_OPTIONS = {
    "road": ["road_load.surface=road"],
    "body": [
        "road_load.form=body",
        "road_load.form.body.drag_coefficient=0.33",
        "road_load.form.body.frontal_area_m2=1.9",
        "road_load.form.body.rolling_coefficient=0.011",
        "road_load.surface=road",
    ],
    "loaded_uphill": [
        "road_load.payload_kg=400",
        "road_load.altitude_m=1500",
        "road_load.form.coefficients.f1_n_per_kmh=0.6",
    ],
    "bsfc_map": ["engine.model.bsfc_map.file=si_1900_bsfc"],
    "full_load": ["engine.full_load=[[600, 60], [1500, 90], [3000, 120], [4500, 110], [6500, 90]]"],
    "exchanger": ["thermal.transmission.exchanger_w_k=120", "thermal.transmission.exchanger_opens_degc=20"],
    "under_bonnet": ["thermal.under_bonnet_rise=0.2"],
}
# Options of the command: arguments beyond the car, ambient, start.
COMMAND_OPTIONS = {
    "appendix_c": (["--formulation", "appendix_c"], -10, "soak"),
    "chapter_8": (["--formulation", "chapter_8"], 25, "soak"),
    "dt_0.1": (["--dt", "0.1"], -10, "soak"),
    "dt_0.37": (["--dt", "0.37"], 25, "warm"),
    "start_60": ([], 10, 60),
    "ambient_-40": ([], -40, "soak"),
    "ambient_60": ([], 60, "soak"),
    "dexron_ii": (["--lubricant", "dexron_ii"], -10, "soak"),
    "dexron_iii": (["--lubricant", "dexron_iii"], -10, "soak"),
    "engine_5w30": (["--engine-oil", "engine_5w30"], -10, "soak"),
}
OWN_CYCLE = (
    "time_s,speed_kmh,gear,grade_percent,engine_off,phase\n0,0,0,0,0,one\n4,0,1,0,0,one\n12.5,22,2,1.5,0,one\n"
    "30,41,3,3,0,one\n60,41,3,-2,0,two\n75,5,1,0,0,two\n80,0,0,0,1,two\n100,0,0,0,0,three\n103,0,1,6,0,three\n"
    "125,38,2,6,0,three\n140,0,0,0,0,three\n"
)
MAPS = ["belt", "pump", "input_shaft", "clutch_drag", "final_drive"]
MAP_GRID = {
    "belt": ["--torque", "-50..200:50"],
    "final_drive": ["--torque", "-50..200:50"],
    "box": ["--torque", "-50..150:50", "--vehicle", "rover_216_5mt"],
}


def without(file, *keys):
    """Text of a TOML file without the first line of each of some keys."""
    text = file.read_text(encoding="utf-8")
    for key in keys:
        text = re.sub(rf"^{key} = .*\n", "", text, count=1, flags=re.MULTILINE)
    return text


def make_map(part):
    """Command that writes one component's loss as a map."""
    grid = ["--speed", "500..6000:1100", "--temp", "-10..90:50", *MAP_GRID.get(part, [])]
    return ["losses", "--as-map", part, *grid, *([] if part == "box" else ["--ratio", "high..low:0.4"])]


def options():
    """Runs with options that the shipped cars do not use."""
    for name, values in CVT_OPTIONS.items():
        sets = [word for value in values for word in ("--set", value)]
        yield drive(f"option/{CVT}/{name}", CVT, "ece15_eudc", -10, "soak", sets)
    for car in CARS[:2]:
        for name, values in CAR_OPTIONS.items():
            sets = [word for value in values for word in ("--set", value)]
            yield drive(f"option/{car}/{name}", car, "jp_10_15_mode", -10, "soak", sets)
        for name, (extra, ambient, start) in COMMAND_OPTIONS.items():
            if car == CVT or name in ("dt_0.1", "start_60", "ambient_-40", "ambient_60", "engine_5w30"):
                yield drive(f"option/{car}/{name}", car, "jp_10_15_mode", ambient, start, extra)
        text = without(ROOT / f"vehicles/{car}.toml", "mass_kg")
        sets = ["--set", "road_load.form=r83", "--set", "road_load.form.r83.reference_mass_kg=1250"]
        yield drive(f"option/{car}/r83", "car.toml", "jp_10_15_mode", -10, "soak", sets, {"car.toml": text})
        yield drive(f"option/{car}/constant_120", car, "constant_120", 25, "soak")
        yield drive(f"option/{car}/own_cycle", car, "own.csv", 0, "soak", files={"own.csv": OWN_CYCLE})
    table = "viscosity_table = [[-20, 1800], [0, 330], [40, 36], [100, 7.3]]\n"
    text = table + without(ROOT / "lubricants/dexron_iii.toml", "kv40_mm2_s", "kv100_mm2_s")
    extra = ["--lubricant", "oil.toml"]
    yield drive(f"option/{CVT}/viscosity_table", CVT, "ece15_eudc", -10, "soak", extra, {"oil.toml": text})
    for part in [*MAPS, "box"]:
        car, box = ("rover_216_5mt", "manual") if part == "box" else (CVT, "cvt")
        job = drive(f"option/{car}/map_{part}", car, "jp_10_15_mode", -10, "soak")
        # Standard output of the first command is the map.
        job.commands = [make_map(part), [*job.commands[0], "--set", f"transmission.{box}.maps.{part}=out_1"]]
        job.items.append((f"{job.name}/map", "out_1", "csv"))
        yield job


def together():
    """The cars in one run: comparison, sensitivities, inputs, and the trace in Parquet."""
    for cycle, ambient, start in (("ece15_eudc", -10, "soak"), ("ftp75", 25, "warm")):
        name = f"together/{cycle}/{ambient}/{start}"
        run = [
            "run",
            "--cycle",
            cycle,
            "--ambient",
            str(ambient),
            "--start",
            start,
            "--sensitivity",
            "always",
        ]
        items = [
            (f"{name}/summary", "out/summary.json", "json"),
            (f"{name}/inputs", "out/inputs.json", "json"),
            (f"{name}/printed", "out_2", "json"),
        ]
        commands = [
            [*run, "--format", "parquet", "--out", "out", "--quiet"],
            [*run[:-2], "--json", "--set-all", "road_load.mass_kg=1200"],
        ]
        yield Job(name, commands, items, seconds=1)


def prices():
    """What each loss costs: singles, pairs, groups, alone; a part of each loss."""
    for car in CARS:
        for factor, cycle in ((0, "ece15_eudc"), (0.5, "ftp75")):
            name = f"attribute/{car}/{factor}"
            words = ["attribute", "--vehicle", car, "--cycle", cycle, "--ambient", "-10,25", "--factor", str(factor)]
            words += ["--pairs", "all", "--shapley", "--json"]
            yield Job(name, [words], [(name, "out_1", "json")], seconds=0.5)


def rigs():
    """The virtual test rigs."""
    tables = "steady loaded strip_down transient second_box".split()
    cases = {
        "default": (tables, []),
        "chapter_8": (["steady", "loaded"], ["--formulation", "chapter_8"]),
        "appendix_c": (["steady", "loaded"], ["--formulation", "appendix_c"]),
        "cold_dexron": (
            tables,
            ["--temp", "-20,-10,0", "--lubricant", "dexron_ii", "--ratio", "low,0.99,1,1.7,high"],
        ),
    }
    for case, (files, extra) in cases.items():
        name = f"rig/transmission/{case}"
        items = [(f"{name}/summary", "out/summary.json", "json")]
        items += [(f"{name}/{table}", f"out/{table}.csv", "csv") for table in files]
        tests = ["all"] if files == tables else files
        yield Job(
            name,
            [["rig", "transmission", "--test", test, "--out", "out", "--quiet", "--force", *extra] for test in tests],
            items,
        )
    cases = {
        "default": [],
        "chapter_8": ["--formulation", "chapter_8"],
        "appendix_c": ["--formulation", "appendix_c"],
        "points": [
            "--ratio",
            "low,1.5,0.8",
            "--pressure",
            "8,20,40",
            "--torque",
            "-100..400:12.5",
            "--temp",
            "20",
            "--speed",
            "1500",
        ],
    }
    for case, extra in cases.items():
        name = f"rig/variator/{case}"
        items = [
            (f"{name}/{file.split('.')[0]}", f"out/{file}", file.split(".")[1])
            for file in ("summary.json", "curves.csv", "points.csv")
        ]
        yield Job(name, [["rig", "variator", "--out", "out", "--quiet", *extra]], items)


def losses():
    """Losses at operating points."""
    grid = ["--speed", "800..5600:400", "--temp", "-20,25,90", "--torque", "-60..240:60"]
    cases = {f"{CVT}/default": []}
    for formulation in ("smooth", "appendix_c", "chapter_8"):
        cases[f"{CVT}/{formulation}"] = ["--ratio", "high..low:0.27", "--formulation", formulation, *grid]
    cases[f"{CVT}/held"] = ["--ratio", "0.7,1,2", "--pressure", "5,15,40", "--belt-temp", "20,110", *grid]
    cases[f"{CVT}/throttle"] = ["--throttle", "0,0.3,1", *grid]
    for car in CARS[1:]:
        cases[f"{car}/grid"] = ["--vehicle", car, *grid]
    for case, extra in cases.items():
        name = f"losses/{case}"
        items = [(f"{name}/summary", "out/summary.json", "json"), (f"{name}/table", "out/losses.csv", "csv")]
        yield Job(name, [["losses", "--out", "out", "--quiet", *extra]], items)


def belt():
    """The belt model at the golden points."""
    inputs = """case ratio input_speed_rpm secondary_pressure_bar output_torque_nm pulley_half_angle_deg
        wedge_half_angle_deg band_offset_mm band_friction segment_friction band_count primary_on_stop""".split()
    for points in ("belt_points", "belt_edge_points"):
        rows = read_golden(f"{points}.csv")
        as_printed = [{name: row[name] for name in [*inputs, "formulation"]} for row in rows]
        # In driving: no formulation, friction and stop from the vehicle, belt temperatures across the range.
        left_out = ("segment_friction", "band_friction", "primary_on_stop")
        smooth = [
            {name: row[name] for name in inputs if name not in left_out}
            for row in rows
            if row["formulation"] == "appendix_c"
        ]
        for number, row in enumerate(smooth):
            row["belt_temp_degc"] = ["", "-20", "25", "60", "95", "140"][number % 6]
        cases = {
            "printed": (as_printed, []),
            "smooth": (smooth, []),
            "band_speed": (smooth, ["--band-speed", "0.5"]),
        }
        for case, (table, extra) in cases.items():
            name = f"belt/{points}/{case}"
            command = ["belt", "--points", "points.csv", "--quiet", *extra]
            items = [(f"{name}/csv", "table.csv", "csv"), (f"{name}/json", "out_2", "json")]
            yield Job(
                name,
                [[*command, "--out", "table.csv"], [*command, "--json"]],
                items,
                {"points.csv": to_csv(table)},
            )


def validate():
    """Every comparison with a published number, and the verdict."""
    cases = {
        "default": [],
        "large_pump": ["--set", "transmission.cvt.pump.displacement_cc_rev=12"],
        "dexron_iii": ["--lubricant", "dexron_iii"],
    }
    for case, extra in cases.items():
        name = f"validate/{case}"
        items = [
            (f"{name}/summary", "out/summary.json", "json"),
            (f"{name}/table", "out/validation.csv", "csv"),
        ]
        yield Job(name, [["validate", "--out", "out", "--quiet", *extra]], items)


def studies():
    """Studies: a Sobol sequence of 4 000 points, the other designs over the same factors, the shipped plans."""
    factors = FACTORS.read_text(encoding="utf-8")
    designs = {
        "sobol_4000": ("sobol", "samples = 4000\nseed = 7", ""),
        "latin_hypercube": (
            "latin_hypercube",
            "samples = 300\nseed = 3",
            'keep = ["time_s", "belt_ratio", "secondary_pressure_bar", "fuel_g_s", "flags"]',
        ),
        "monte_carlo": ("monte_carlo", "samples = 300", ""),
        "saltelli": ("saltelli", "samples = 16", ""),
        "one_at_a_time": ("one_at_a_time", "quantile = 0.1", 'keep = "everything"'),
    }
    plans = {}
    for name, (design, keys, study) in designs.items():
        head = f'[study]\ntitle = "{name}"\nbaselines = ["rover_216_5mt"]\ncycle = "ece15"\n{study}\n'
        plans[name] = (
            ["study", "plan.toml"],
            {"plan.toml": f"{head}[study.design.{design}]\n{keys}\n\n{factors}"},
        )
    plans["pump_and_offset"] = (["study", "pump_and_offset"], {})
    plans["oil_at_minus_10"] = (["study", "oil_at_minus_10"], {})
    plans["uncertainty_rover"] = (["study", "uncertainty_rover", "--samples", "4"], {})
    plans["ambient"] = (["study", "ambient"], {})
    for plan, (command, files) in plans.items():
        name = f"study/{plan}"
        commands = [
            [*command, "--out", "out", "--quiet", "--threads", "1", "--format", "both"],
            ["study", "export", "out", "--out", "runs.csv", "--quiet"],
        ]
        items = [
            (f"{name}/runs", "runs.csv", "csv"),
            (f"{name}/statistics", "out/statistics.json", "json"),
            (f"{name}/statistics_table", "out/statistics.csv", "csv"),
        ]
        if plan == "sobol_4000":
            items.append((f"{name}/study", "out/study.json", "json"))
        if plan in ("latin_hypercube", "one_at_a_time", "ambient"):
            commands.append(["study", "export", "out", "--table", "traces", "--out", "traces.csv", "--quiet"])
            items.append((f"{name}/traces", "traces.csv", "csv"))
        if plan in ("saltelli", "uncertainty_rover"):
            items.append((f"{name}/sobol_indices", "out/sobol_indices.csv", "csv"))
        if plan in ("pump_and_offset", "ambient"):
            items.append((f"{name}/main_effects", "out/main_effects.csv", "csv"))
        if plan in ("oil_at_minus_10", "one_at_a_time"):
            items.append((f"{name}/tornado", "out/tornado.csv", "csv"))
        yield Job(name, commands, items, files, seconds=30 if plan == "sobol_4000" else 3)


def calibrations():
    """The shipped calibrations, and the example of the docs."""
    plans = {
        "rover_216_transmission": "rover_216_transmission",
        "rover_216_warm_up": "rover_216_warm_up",
        "example": str(EXAMPLE),
    }
    for plan, argument in plans.items():
        name = f"calibrate/{plan}"
        items = [
            (f"{name}/calibration", "out/calibration.json", "json"),
            (f"{name}/vehicle", f"out/{CVT}_fitted.toml", "toml"),
        ]
        items += [
            (f"{name}/{table}", f"out/{table}.csv", "csv") for table in ("parameters", "residuals", "correlation")
        ]
        if plan == "rover_216_transmission":
            items.append((f"{name}/lubricant", "out/cvtf_ezl799_class_fitted.toml", "toml"))
        yield Job(
            name,
            [["calibrate", argument, "--out", "out", "--quiet", "--threads", "1"]],
            items,
            seconds=80 if plan == "rover_216_transmission" else 1,
        )


def data():
    """What the program carries: values and ranges of cars and fluids, cycles."""
    for name in [*CARS, *LUBRICANTS]:
        yield Job(f"data/{name}", [["show", name, "--json"]], [(f"data/{name}", "out_1", "json")])
    yield Job("data/cycles", [["list", "cycles", "--json"]], [("data/cycles", "out_1", "json")])


def all_jobs():
    """Every job; the long ones first."""
    jobs = [
        *calibrations(),
        *studies(),
        *runs(),
        *options(),
        *together(),
        *prices(),
        *rigs(),
        *losses(),
        *belt(),
        *validate(),
        *data(),
    ]
    return sorted(jobs, key=lambda job: -job.seconds)
