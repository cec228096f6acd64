"""Benches, texts and studies: against the program."""

from __future__ import annotations

import io
import json
import os
import subprocess
import sys
import tempfile

import cvtcycle as cc
import numpy
import pandas
import polars
import pytest


def printed(*words: str, stdin: str | None = None) -> str:
    done = subprocess.run([sys.executable, "-m", "cvtcycle", *words], capture_output=True, text=True, input=stdin)
    assert done.returncode in (0, 1), done.stderr
    return done.stdout


def same(table: cc.Table, csv: str) -> None:
    frame = polars.read_csv(io.StringIO(csv), null_values=["", "NaN"], infer_schema_length=None)
    assert frame.columns == table.columns
    for name in frame.columns:
        ours = table[name]
        if isinstance(ours, list):
            theirs = [w.replace(";", "|") if w else "" for w in frame[name].cast(polars.String).to_list()]
            assert ours == theirs, name
        else:
            numpy.testing.assert_array_equal(ours, frame[name].cast(polars.Float64).fill_null(numpy.nan).to_numpy(), err_msg=name)


def test_losses_are_those_of_the_program() -> None:
    speeds = numpy.arange(1000.0, 4001.0, 500.0)
    table = cc.losses("rover_216_cvt", belt_ratio=1.5, input_speed_rpm=speeds, output_torque_nm=100.0, transmission_sump_degc=25)
    same(table, printed("losses", "--ratio", "1.5", "--speed", "1000..4000:500", "--torque", "100", "--temp", "25", "--format", "csv"))
    by_input = cc.losses("rover_216_cvt", belt_ratio=1.5, input_torque_nm=60.0)
    assert abs(by_input["input_torque_nm"][0] - 60.0) < 1e-9
    with pytest.raises(cc.InputError):
        cc.losses("rover_216_cvt", belt_ratio=1.5, input_torque_nm=60.0, output_torque_nm=0.0)
    table = cc.losses("rover_216_5mt", gear=[3], output_torque_nm=50)
    same(table, printed("losses", "--vehicle", "rover_216_5mt", "--gear", "3", "--torque", "50", "--format", "csv"))


def test_belt_is_that_of_the_program() -> None:
    points = {"ratio": [2.416, 0.5], "input_speed_rpm": [2000, 3000], "secondary_pressure_bar": [30.0, 12.5], "output_torque_nm": [60, 20]}
    csv = "\n".join([",".join(points), "2.416,2000,30,60", "0.5,3000,12.5,20"]) + "\n"
    same(cc.belt(polars.DataFrame(points)), printed("belt", "--points", "-", stdin=csv))


def test_losses_name_every_bad_point() -> None:
    with pytest.raises(cc.InputError) as caught:
        cc.losses("rover_216_cvt", belt_ratio=[1.5, 99, 1.0], input_speed_rpm=[2000, numpy.nan, -1])
    problems = [(p["key"], p["message"].split(":")[0]) for p in caught.value.problems]
    assert problems == [("belt_ratio", "row 1"), ("input_speed_rpm", "row 1"), ("input_speed_rpm", "row 2")]
    with pytest.raises(cc.InputError, match="other columns have 3"):
        cc.losses("rover_216_cvt", belt_ratio=[1.5, 1.2, 1.0], input_speed_rpm=[2000, 3000])
    with pytest.raises(cc.InputError, match="no such column"):
        cc.losses("rover_216_5mt", gear=1, throttle=0.5)
    with pytest.raises(cc.InputError, match="2.5 is out of range"):
        cc.losses("rover_216_5mt", gear=2.5)
    with pytest.raises(cc.InputError, match="needs it"):
        cc.losses("rover_216_cvt")


def test_texts_are_those_of_the_program() -> None:
    assert cc.explain("band_offset_mm") == json.loads(printed("explain", "band_offset_mm", "--json"))
    for kind in ("vehicle", "lubricant", "rig", "calibration", "validation", "plan", "levers"):
        assert cc.schema(kind) == json.loads(printed("schema", kind))
    assert cc.names("vehicle") and "ece15_eudc" in cc.names("cycle")


def test_validation_is_that_of_the_program() -> None:
    ours = cc.validate(chapter="C")
    theirs = json.loads(printed("validate", "--chapter", "C", "--json"))
    assert ours["rows"] == theirs["rows"] and ours["rows"]


def test_calibration_is_that_of_the_program() -> None:
    ours = cc.calibrate("rover_216_transmission", starts=1, folds=False)
    theirs = json.loads(printed("calibrate", "rover_216_transmission", "--starts", "1", "--no-folds", "--json", "--quiet"))
    assert ours["parameters"] == theirs["parameters"]


PLAN = """[study]
title = "T"
cycle = "ece15"
baselines = ["rover_216_5mt"]
design = { latin_hypercube = { samples = 40, seed = 3 } }

[[factor]]
key = "road_load.mass_kg"
status = "assumed"
distribution = { uniform = { low = 1000, high = 1400 } }
"""


def test_studies_are_those_of_the_program(tmp_path) -> None:
    (tmp_path / "plan.toml").write_text(PLAN)
    printed("study", str(tmp_path / "plan.toml"), "--out", str(tmp_path / "whole"), "--quiet")
    study = cc.Study(tmp_path / "plan.toml")
    assert (study.points, study.runs) == (40, 80)
    middle = study.parts // 2
    assert study.write_parts((middle, study.parts), tmp_path / "ours") == study.parts - middle
    assert cc.Study.open(tmp_path / "ours").parts == (study.parts - middle, study.parts)
    assert study.write_parts(None, tmp_path / "ours") == study.parts
    for file in sorted((tmp_path / "whole" / "parts").iterdir()):
        assert (tmp_path / "ours" / "parts" / file.name).read_bytes() == file.read_bytes(), file.name
    stored = cc.Study.open(tmp_path / "ours")
    answer = json.loads(printed("study", "show", str(tmp_path / "whole"), "--json"))
    ours = stored.answer()
    assert ours["outputs"] == answer["outputs"] if "outputs" in answer else ours == answer
    table = stored.table(["point", "vehicle", "headline_fuel_l_per_100km"])
    assert table.columns == ["point", "vehicle", "headline_fuel_l_per_100km"] and len(table) == 80
    in_memory = cc.Study.from_toml(PLAN).run()
    numpy.testing.assert_array_equal(in_memory["headline_fuel_l_per_100km"], table["headline_fuel_l_per_100km"])
    assert len(cc.Study.from_toml(PLAN, samples=10, seed=5).run((0, 2))) > 0


def test_bad_studies(tmp_path) -> None:
    study = cc.Study.from_toml(PLAN)
    for parts in [(0, study.parts + 1), (3, 2)]:
        with pytest.raises(cc.InputError, match="no such parts"):
            study.run(parts)
    with pytest.raises(cc.InputError) as caught:
        cc.Study.from_toml(PLAN.replace("mass_kg", "mas_kg"), name="mine.toml")
    problem = caught.value.problems[0]
    assert (problem["file"], problem["line"]) == ("mine.toml", 8)
    with pytest.raises(cc.InputError):
        cc.Study.open(tmp_path)
    study.write_parts((0, 1), tmp_path / "a")
    with pytest.raises(cc.InputError):
        cc.Study.from_toml(PLAN, seed=4).write_parts((0, 1), tmp_path / "a")
    with pytest.raises(cc.InputError, match="draws no samples"):
        cc.Study.from_toml(PLAN.replace("{ latin_hypercube = { samples = 40, seed = 3 } }", '"grid"').replace("distribution = { uniform = { low = 1000, high = 1400 } }", "values = [1000, 1400]"), samples=5)


@pytest.mark.parametrize(
    ("vehicle", "cycle", "ambient", "baseline", "oil", "values"),
    [
        ("rover_216_cvt", "ece15", -10.0, "rover_216_5mt", None, {}),
        ("rover_216_cvt", "ece15", 25.0, "rover_216_5mt", None, {"transmission.cvt.belt.band_offset_mm": 2}),
        ("rover_216_cvt", "eudc", -7.0, "rover_216_5mt", "dexron_iii", {}),
        ("civic_20_cvt", "ece15", 24.0, "twin", None, {}),
        ("justy_ecvt", "eudc", 20.0, "twin", None, {}),
    ],
)
def test_an_answer_is_that_of_the_program(
    vehicle: str, cycle: str, ambient: float, baseline: str, oil: str | None, values: dict[str, float]
) -> None:
    """Truth: `run --json`, which tests/cli/commands/one_answer.rs holds against terminal, report and live page."""
    car = cc.Car(vehicle, set=values, lubricant=oil)
    ours = car.answer(cycle, ambient_degc=ambient, baselines=[baseline], draws=24, levers=False)
    words = ["run", "--vehicle", vehicle, "--cycle", cycle, "--ambient", str(ambient), "--baseline", baseline, "--draws", "24"]
    words += ["--price", "never", "--json"]
    words += [part for key, value in values.items() for part in ("--set", f"{key}={value}")]
    words += ["--lubricant", oil] if oil else []
    theirs = json.loads(printed(*words))["answer"]
    for key in ("schema", "plan", "draws", "failed_draws", "reasons", "fuel_l_per_100km", "differences"):
        assert ours[key] == theirs[key], key


def test_fleet_takes_frames_with_missing_cells() -> None:
    """Truth: the same cars as text. pandas has NaN for a missing text or number, and then floats for whole numbers."""
    cars = {
        "carid": ["one", "two"],
        "mass": ["1300kg", "1400kg"],
        "displacement": ["1.8l", "2.0l"],
        "power": ["104kW", "110kW"],
        "engine": ["pfi", None],
        "engine_year": [2018, None],
        "hwfet_l_per_100km": [4.9, None],
    }
    text = "carid,mass,displacement,power,engine,engine_year,hwfet_l_per_100km\none,1300kg,1.8l,104kW,pfi,2018,4.9\ntwo,1400kg,2.0l,110kW,,,\n"
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, "cars.csv")
        with open(file, "w", encoding="utf-16") as out:
            out.write(text)
        wanted = cc.fleet(file, tests="hwfet")
    assert wanted["refused"] == ["", ""]
    for frame in (cars, pandas.DataFrame(cars), polars.DataFrame(cars)):
        got = cc.fleet(frame, tests="hwfet")
        for name in wanted.columns:
            if isinstance(wanted[name], list):
                assert got[name] == wanted[name], (type(frame), name)
            else:
                numpy.testing.assert_array_equal(got[name], wanted[name], err_msg=name)
