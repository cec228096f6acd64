"""Bad input raises an exception with the place of the problem, and never ends the process."""

from __future__ import annotations

import io
import math
import os
import pickle
import signal
import subprocess
import sys
import threading
import time

import cvtcycle as cc
import numpy
import pytest

JUNK = [None, 7, 7.5, math.nan, math.inf, True, b"x", [], {}, object(), "", "\0", "nothing", numpy.zeros(3), 10**400, float("-inf"), [1, "x"], {"a": 1}, lambda: 1]
CALLS = {
    "Car": lambda x: cc.Car(x),
    "set": lambda x: cc.Car("rover_216_cvt", set={"road_load.mass_kg": x} if x is not True else {"road_load.mass_kg": {}}),
    "set texts": lambda x: cc.Car("rover_216_cvt", set=[x]),
    "lubricant": lambda x: cc.Car("rover_216_cvt", lubricant=x if x is not None else 3),
    "formulation": lambda x: cc.Car("rover_216_cvt", formulation=x),
    "from_toml": lambda x: cc.Car.from_toml(x),
    "from_dict": lambda x: cc.Car.from_dict(x),
    "from_dict value": lambda x: cc.Car.from_dict({"vehicle": x}),
    "Cycle": lambda x: cc.Cycle(x),
    "Cycle.read": lambda x: cc.Cycle.read(x),
    "from_arrays": lambda x: cc.Cycle.from_arrays(x, [0, 1, 2]),
    "from_arrays grade": lambda x: cc.Cycle.from_arrays([0, 1, 2], [0, 1, 2], grade=x if x is not None and not isinstance(x, numpy.ndarray) else 1),
    "from_frame": lambda x: cc.Cycle.from_frame(x),
    "run car": lambda x: cc.run(x, "ece15"),
    "run cycle": lambda x: cc.run("rover_216_cvt", x),
    "ambient": lambda x: cc.run("rover_216_cvt", "ece15", ambient_degc=x if x not in (7, 7.5, True) else 700),
    "start": lambda x: cc.run("rover_216_cvt", "ece15", start=x if x not in (7, 7.5, True) else 700),
    "dt": lambda x: cc.run("rover_216_cvt", "ece15", dt_s=x if x not in (7, 7.5, True) else -1),
    "baselines": lambda x: cc.run("rover_216_cvt", "ece15", baselines=[x]),
    "Family keys": lambda x: cc.Family("rover_216_cvt", "ece15", x)(numpy.zeros((1, 0))),
    "losses": lambda x: cc.losses("rover_216_cvt", belt_ratio=x if x not in (7, 7.5, True, []) else -1),
    "belt": lambda x: cc.belt(x),
    "validate": lambda x: cc.validate(x),
    "calibrate": lambda x: cc.calibrate(x),
    "explain": lambda x: cc.explain(x if x != "nothing" else "nothing at all"),
    "schema": lambda x: cc.schema(x),
    "names": lambda x: cc.names(x),
    "Study": lambda x: cc.Study(x),
    "open": lambda x: cc.Study.open(x),
    "samples": lambda x: cc.Study("uncertainty_rover", samples=x if x not in (None, 7, True) else -1),
}


def junk() -> list[tuple[str, object]]:
    # Comparisons of numpy arrays have no truth value, so calls that compare are skipped.
    comparing = {"ambient", "start", "dt", "losses", "samples"}
    return [(name, x) for name in CALLS for x in JUNK if not (name in comparing and isinstance(x, numpy.ndarray))]


@pytest.mark.parametrize(("name", "x"), junk(), ids=lambda value: value if isinstance(value, str) and value in CALLS else repr(value)[:20])
def test_junk_is_an_exception(name: str, x: object) -> None:
    with pytest.raises((cc.InputError, TypeError, ValueError, OverflowError)):
        CALLS[name](x)


def test_problems_are_data() -> None:
    text = '[vehicle]\ntitel = "x"\nlike = "rover_216_cvt"\n[road_load]\nmass_kg = -3\n'
    with pytest.raises(cc.InputError) as caught:
        cc.Car.from_toml(text, name="mine.toml")
    problems = {p["key"]: p for p in caught.value.problems}
    mass = problems["road_load.mass_kg"]
    assert (mass["file"], mass["line"], mass["column"], mass["value"], mass["kind"]) == ("mine.toml", 5, 11, "-3", "out_of_range")
    assert "kg" in mass["allowed"]
    assert any("title" in p["hint"] for p in caught.value.problems)
    again = pickle.loads(pickle.dumps(caught.value))
    assert again.problems == caught.value.problems and str(again) == str(caught.value)
    with pytest.raises(cc.InputError) as caught:
        cc.Car("rover_216_cvt", set={"road_load.mass_kg": -3})
    assert caught.value.problems[0]["override"] == "road_load.mass_kg=-3"
    with pytest.raises(cc.InputError) as caught:
        cc.Cycle("ece15_euc")
    assert caught.value.problems[0]["argument"] == "cycle" and "ece15_eudc" in caught.value.problems[0]["suggested"]


def test_bad_cycles_have_their_line() -> None:
    with pytest.raises(cc.InputError) as caught:
        cc.Cycle.from_arrays([0, 1, 0.5, 3], [0, 1, 2, 1e6], name="log")
    assert {(p["file"], p["line"]) for p in caught.value.problems} >= {("log", 4), ("log", 5)}
    # Rows without a time and doubled ones are repaired, and counted.
    repairs = cc.Cycle.from_arrays([0, 1, 1, math.nan], [0, 1, 2, 3]).repairs
    assert [repair[:2] for repair in repairs] == [("empty", 1), ("stamps", 1)]
    with pytest.raises(cc.InputError, match="different lengths"):
        cc.Cycle.from_arrays([0, 1], [0, 1, 2])
    with pytest.raises(cc.InputError):
        cc.Cycle.from_arrays(numpy.zeros((2, 2)), numpy.zeros((2, 2)))


def test_closed_files(tmp_path) -> None:
    closed = io.StringIO("time_s,speed_kmh\n0,0\n1,1\n")
    closed.close()
    with pytest.raises(cc.InputError, match="closed file"):
        cc.Cycle.read(closed)
    with open(tmp_path / "x", "wb") as written, pytest.raises(cc.InputError, match="cannot read it"):
        cc.Cycle.read(written)
    with pytest.raises(cc.InputError):
        cc.Cycle.read(tmp_path / "missing.csv")
    run = cc.run("rover_216_cvt", "ece15")
    with pytest.raises(cc.InputError, match="no directory"):
        run.report(tmp_path / "no" / "folder" / "x.html")
    with pytest.raises(cc.InputError):
        run.write(tmp_path / "x")


def interrupted(call) -> float:
    """Seconds from the signal to KeyboardInterrupt."""
    # A shell starts what it leaves in the background with the signal ignored, and Python keeps that.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    timer = threading.Timer(0.4, lambda: os.kill(os.getpid(), signal.SIGINT))
    begun = time.monotonic()
    timer.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            call()
            # Work that ends before the signal would pass untested.
            raise AssertionError(f"done after {time.monotonic() - begun:.1f} s")
    finally:
        timer.cancel()
    return time.monotonic() - begun - 0.4


def long_cycle() -> cc.Cycle:
    return cc.Cycle.from_arrays(numpy.arange(0.0, 60_000.0, 1000.0), numpy.full(60, 20.0))


def test_ctrl_c_ends_long_work(tmp_path) -> None:
    family = cc.Family("rover_216_cvt", "ftp75", ["road_load.mass_kg"])
    calls = [
        lambda: family(numpy.full((200_000, 1), 1200.0)),
        lambda: cc.run("rover_216_cvt", long_cycle(), dt_s=0.01, trace=False),
        lambda: cc.Study("uncertainty_rover", samples=20_000).run(),
        lambda: cc.losses("rover_216_cvt", belt_ratio=1.5, input_speed_rpm=numpy.linspace(1000, 5000, 1_000_000)),
    ]
    for call in calls:
        assert interrupted(call) < 3.0
    assert cc.run("rover_216_cvt", "ece15", trace=False).fuel_l_per_100km > 5


def test_an_interrupted_study_goes_on(tmp_path) -> None:
    study = cc.Study("uncertainty_rover", samples=600)
    folder = tmp_path / "s"
    interrupted(lambda: study.write_parts(None, folder))
    there, parts = cc.Study.open(folder).parts
    assert there < parts
    assert study.write_parts((0, there + 1), folder) >= there


def test_the_lock_of_the_interpreter_is_free() -> None:
    """Another Python thread keeps counting during a drive."""
    family = cc.Family("rover_216_cvt", "ece15_eudc", ["road_load.mass_kg"], threads=1)
    counted, done = [0], threading.Event()

    def count() -> None:
        while not done.is_set():
            counted[0] += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    begun = time.monotonic()
    family(numpy.full((200, 1), 1200.0))
    seconds = time.monotonic() - begun
    done.set()
    thread.join()
    assert counted[0] > 50 * seconds


def test_a_child_made_by_fork_computes() -> None:
    code = """
import os, sys, numpy, cvtcycle as cc
family = cc.Family("rover_216_cvt", "ece15", ["road_load.mass_kg"])
own = family([1200.0])
child = os.fork()
if child == 0:
    os._exit(0 if family([1200.0]) == own else 3)
sys.exit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
"""
    assert subprocess.run([sys.executable, "-W", "ignore", "-c", code], timeout=120).returncode == 0


def test_threads_share_objects() -> None:
    car, cycle = cc.Car("rover_216_cvt"), cc.Cycle("ece15")
    found: list[float] = []
    drive = lambda: found.extend(cc.run(car, cycle).fuel_l_per_100km for _ in range(5))  # noqa: E731
    threads = [threading.Thread(target=drive) for _ in range(8)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    assert len(found) == 40 and len(set(found)) == 1


@pytest.mark.parametrize("threads", [0, -1, 5000, "two"])
def test_bad_threads(threads: object) -> None:
    with pytest.raises((cc.InputError, TypeError, OverflowError)):
        cc.losses("rover_216_cvt", belt_ratio=1.5, threads=threads)
