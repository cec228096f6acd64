"""Runs against the program, and their internal consistency."""

from __future__ import annotations

import json
import math
import pickle
import subprocess
import sys
from xml.etree import ElementTree

import cvtcycle as cc
import numpy
import pytest


@pytest.fixture(scope="module")
def cold() -> cc.Run:
    return cc.run("rover_216_cvt", "ece15_eudc", ambient_degc=-10, baselines=["rover_216_5mt", "twin"])


def program(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-m", "cvtcycle", *words], capture_output=True, text=True)


def test_summary_is_that_of_the_program(cold: cc.Run) -> None:
    """Outside truth: the program's own `run --json`. All numbers, bit by bit; only the identity of the call differs."""
    words = ["--cycle", "ece15_eudc", "--ambient", "-10", "--baseline", "rover_216_5mt", "--baseline", "twin"]
    printed = json.loads(program("run", "--json", "--price", "never", *words).stdout)
    ours = json.loads(json.dumps(cold.summary))
    assert ours["settings"].pop("dt_s") == printed["settings"].pop("dt_s")
    for key in ("runs", "comparison", "cycle", "ambient_degc", "start", "settings"):
        assert ours[key] == printed[key], key


def test_price_is_that_of_the_program() -> None:
    run = cc.run("rover_216_cvt", "ece15", price=True, trace=False)
    printed = json.loads(program("run", "--json", "--cycle", "ece15", "--baseline", "none").stdout)
    assert run.summary["runs"][0]["price"] == printed["runs"][0]["price"]


def test_fuel_without_a_trace_is_the_same(cold: cc.Run) -> None:
    bare = cc.run("rover_216_cvt", "ece15_eudc", ambient_degc=-10, trace=False)
    assert bare.fuel_l_per_100km == cold.fuel_l_per_100km == cold.summary["runs"][0]["fuel_l_per_100km"]
    with pytest.raises(cc.InputError, match="kept no steps"):
        bare.trace


def test_trace_adds_up_to_the_summary(cold: cc.Run) -> None:
    """Conservation: fuel flow and losses of the steps are those of the summary."""
    trace, summary = cold.trace, cold.summary["runs"][0]
    dt_s = trace["dt_s"]
    assert math.isclose(numpy.dot(trace["fuel_g_s"], dt_s) / 1e3, summary["fuel_kg"], rel_tol=1e-12)
    pump_kj = numpy.dot(trace["pump_loss_w"], dt_s) / 1e3
    assert math.isclose(pump_kj, summary["loss_kj"]["pump"], rel_tol=1e-12)
    assert len(trace) == len(dt_s) and trace["phase"][0] == "ECE15_1"


def test_trace_is_that_of_the_program(cold: cc.Run, tmp_path) -> None:
    import polars

    done = program("run", "--ambient", "-10", "--baseline", "none", "--out", str(tmp_path / "run"))
    assert done.returncode == 0, done.stderr
    written = polars.read_csv(tmp_path / "run" / "trace_rover_216_cvt.csv", infer_schema_length=None)
    assert list(written.columns) == cold.trace.columns
    for name in written.columns:
        ours = cold.trace[name]
        if isinstance(ours, list):
            assert ours == [word or "" for word in written[name]], name
        else:
            theirs = written[name].cast(polars.Float64).fill_null(numpy.nan)
            numpy.testing.assert_array_equal(ours, theirs.to_numpy(), err_msg=name)


def test_plots_are_svg(cold: cc.Run, tmp_path) -> None:
    for kind in ("losses", "driveline", "pressure", "temperatures", "operating_points", "fuel"):
        ElementTree.fromstring(cold.plot(kind).svg)
    cold.plot("losses", car="rover_216_5mt").save(tmp_path / "losses.svg")
    assert (tmp_path / "losses.svg").read_text().startswith("<svg")
    with pytest.raises(cc.InputError, match="pressure"):
        cold.plot("pressure", car="rover_216_5mt")
    with pytest.raises(cc.InputError, match="no such car"):
        cold.plot("losses", car="other")


def test_a_notebook_shows_it(cold: cc.Run) -> None:
    bundle = cold._repr_mimebundle_()
    assert set(bundle) == {"text/plain", "text/html", "image/svg+xml"}
    ElementTree.fromstring(bundle["image/svg+xml"])
    assert "L/100 km" in bundle["text/html"]
    assert "<table>" in cold.trace._repr_html_()


def test_report_and_files(cold: cc.Run, tmp_path) -> None:
    paths = cold.report(tmp_path / "out.html")
    page = (tmp_path / "out.html").read_text()
    assert paths[0].endswith("out.html") and "<html" in page and len(paths) >= 5
    with pytest.raises(cc.InputError, match="there already"):
        cold.report(tmp_path / "out.html")
    cold.report(tmp_path / "out.html", force=True)
    written = cold.write(tmp_path / "files", format="parquet")
    assert any(path.endswith("trace_rover_216_cvt.parquet") for path in written)
    assert program("report", str(tmp_path / "files")).returncode in (0, 1)


def test_changes_and_fluids() -> None:
    car = cc.Car("rover_216_cvt", set={"road_load.mass_kg": 1300, "road_load.mass_kg+": 0}, lubricant="dexron_iii")
    assert car["road_load.mass_kg"] == "1300"
    heavy, own = (cc.run(c, "ece15", trace=False).fuel_l_per_100km for c in (car, "rover_216_cvt"))
    assert heavy > own
    same = cc.Car("rover_216_cvt", set=["road_load.mass_kg=1300"], lubricant="dexron_iii")
    assert cc.run(same, "ece15", trace=False).fuel_l_per_100km == heavy


def test_starts() -> None:
    soak, warm, hot = (cc.run("rover_216_cvt", "ece15", start=s, trace=False).fuel_l_per_100km for s in ("soak", "warm", 90))
    assert soak > warm > hot


def test_cars_and_cycles_are_pickled() -> None:
    car = pickle.loads(pickle.dumps(cc.Car("rover_216_cvt", set={"road_load.mass_kg": 1300}).twin()))
    cycle = pickle.loads(pickle.dumps(cc.Cycle.from_arrays([0, 10, 60], [0, 15, 15])))
    assert (car.is_cvt, car["road_load.mass_kg"], cycle.duration_s) == (False, "1300", 60)


def test_texts_and_dicts(tmp_path) -> None:
    import tomllib

    text = '[vehicle]\ntitle = "Mine"\nlike = "rover_216_cvt"\n\n[road_load]\nmass_kg = 1300\n'
    fuel = cc.run(cc.Car.from_toml(text), "ece15", trace=False).fuel_l_per_100km
    of_dict = cc.Car.from_dict(tomllib.loads(text))
    assert cc.run(of_dict, "ece15", trace=False).fuel_l_per_100km == fuel
    file = tmp_path / "mine.toml"
    file.write_text(text)
    assert cc.run(cc.Car(file), "ece15", trace=False).fuel_l_per_100km == fuel
    assert cc.Car.from_toml(text).twin().is_cvt is False
    with pytest.raises(cc.InputError, match="write the text into a file"):
        cc.run(of_dict, "ece15").report(tmp_path / "no.html")
    assert not (tmp_path / "no.html").exists()


def test_cycles_of_arrays_frames_and_files(tmp_path) -> None:
    import pandas
    import polars

    time_s, speed_m_s = [0, 10, 60, 80], [0.0, 15.0, 15.0, 0.0]
    data = {"time_s": time_s, "speed_m_s": speed_m_s, "phase": ["a", "a", "b", "b"]}
    made = [
        cc.Cycle.from_arrays(time_s, numpy.array(speed_m_s), phase=data["phase"]),
        cc.Cycle.from_frame(pandas.DataFrame(data)),
        cc.Cycle.from_frame(polars.DataFrame(data)),
    ]
    file = tmp_path / "own.csv"
    pandas.DataFrame(data).to_csv(file, index=False)
    made.append(cc.Cycle.read(file))
    with open(file, "rb") as opened:
        made.append(cc.Cycle.read(opened))
    fuels = {cc.run("rover_216_cvt", cycle, trace=False).fuel_l_per_100km for cycle in made}
    assert len(fuels) == 1 and {cycle.distance_m for cycle in made} == {75.0 + 750.0 + 150.0}
    assert made[0].phases == ["a", "b"]


def test_logs_of_frames_with_times() -> None:
    """Truth: the same drive with seconds."""
    import pandas
    import polars

    seconds = [float(k) for k in range(121)]
    speed_kmh = [min(3.0 * t, 60.0) if t < 90 else max(60.0 - 3.0 * (t - 90), 0.0) for t in seconds]
    start = pandas.Timestamp("2026-01-05T23:59:30")
    plain = pandas.DataFrame({"time_s": seconds, "speed_kmh": speed_kmh})
    since = pandas.to_timedelta(plain.time_s, unit="s")
    frames = [
        plain.set_index("time_s"),
        plain.assign(time_s=since),
        plain.assign(time_s=start + since),
        plain.assign(rpm=900.0, note="x"),
        plain.drop(columns="time_s").set_index(pandas.DatetimeIndex(start + since)),
        polars.DataFrame({"time": (start + since).dt.to_pydatetime().tolist(), "speed_kmh": speed_kmh}),
        {"t": numpy.array((start + since).values), "speed_kmh": numpy.array(speed_kmh)},
    ]
    right = cc.run("rover_216_cvt", cc.Cycle.from_frame(plain), trace=False).fuel_l_per_100km
    for frame in frames:
        fuel = cc.run("rover_216_cvt", cc.Cycle.from_frame(frame), trace=False).fuel_l_per_100km
        assert abs(fuel - right) < 1e-9
    spike = plain.assign(speed_kmh=[95.0 if k == 50 else v for k, v in enumerate(speed_kmh)])
    mended = cc.Cycle.from_frame(spike)
    assert [(name, count) for name, count, _ in mended.repairs] == [("spikes", 1)] and mended.doubts == []
    with pytest.raises(cc.InputError, match="1 sample against both neighbours"):
        cc.Cycle.from_frame(spike, repair="no-spikes")
    two = pandas.concat([plain.assign(vehicle_id="a"), plain.assign(vehicle_id="b")])
    with pytest.raises(cc.InputError, match='try: columns="time=time_s:s,speed=speed_kmh:km/h,where=vehicle_id:a"'):
        cc.Cycle.from_frame(two)


def test_wltc_of_the_car() -> None:
    assert cc.run("rover_216_cvt", "wltc", trace=False).summary["cycle"].startswith("wltc_class")


def test_a_drive_without_way_is_in_litres_an_hour():
    idle = cc.Cycle.from_arrays([0, 100.0], [0.0, 0.0])
    run = cc.run("rover_216_cvt", idle, start=85)
    own = run.summary["runs"][0]
    assert own["fuel_l_per_100km"] is None and run.fuel_l_per_100km != run.fuel_l_per_100km
    assert run.fuel_l_per_h == own["fuel_l_per_h"] and abs(own["fuel_g"] / own["fuel_kg"] - 1000) < 1e-9
    assert "L/h" in repr(run) and "L/h" in run._repr_html_() and "L/h" in run.plot("fuel").svg


def test_starts_with_temperatures_of_nodes():
    nodes = {"coolant": 81, "sump": 60}
    by_dict, by_text = (cc.run("rover_216_cvt", "ece15", start=s, trace=False) for s in (nodes, "coolant=81,sump=60"))
    assert by_dict.fuel_l_per_100km == by_text.fuel_l_per_100km and by_dict.summary["start"] == nodes
    for start in ({"oil": 80}, "coolant=1,coolant=2", {"sump": 200}):
        with pytest.raises(cc.InputError, match="nodes: coolant, engine_oil, sump, metal, belt, tyre") as caught:
            cc.run("rover_216_cvt", "ece15", start=start)
        assert [problem["key"] for problem in caught.value.problems] == ["start"]


def test_full_throttle():
    car = cc.Car("civic_20_6mt")
    found = car.accelerate(0, 60, dt_s=0.1)
    (span,) = found["spans"]
    assert 3 < span["time_s"] < 8 and span["error_s"] < 0.1 and found["drives"][0]["shifts"]
    heavy = cc.Car("civic_20_6mt", set={"road_load.payload_kg+": 300}).accelerate(0, 60, dt_s=0.1)
    assert heavy["spans"][0]["time_s"] > span["time_s"] + 0.2
    for wrong in ({"gear": 9}, {"grip": 9}, {"driven": "left"}, {"to_kmh": 0}):
        with pytest.raises(cc.InputError):
            car.accelerate(0, **{"to_kmh": 60, **wrong})
