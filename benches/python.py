"""Times of the Python package, and of FASTSim 3 on the same machine.

    pip install numpy polars fastsim==3.1.0 target/wheels/cvtcycle-*.whl
    python benches/python.py [--native target/release/examples/native_run]
    python benches/python.py --ratio        both programs in turn on UDDS, time a step; `benches/against_fastsim` installs all of it

Each time is the median of many calls; of --ratio it is processor time, with its quartiles. `native_run` drives the same run without Python and prints its own median.

RUST_BACKTRACE and RUST_LIB_BACKTRACE are unset first: FASTSim 3.1 makes an error value in each step, and with either variable a backtrace for it,
which is most of its time then. --keep-environment leaves them as they are.
"""

import argparse
import os
import platform
import statistics
import subprocess
import sys
import time
from importlib.metadata import version

BACKTRACE = ("RUST_BACKTRACE", "RUST_LIB_BACKTRACE")


def environment():
    """Processor, load, versions and variables that a time depends on."""
    with open("/proc/cpuinfo") as file:
        models = [line.split(":")[1].strip() for line in file if line.startswith("model name")]
    yield "processor", f"{models[0] if models else platform.machine()}, {os.cpu_count()} processors"
    yield "load", " ".join(f"{load:.1f}" for load in os.getloadavg())
    yield "system", f"{platform.system()} {platform.release()}, {' '.join(platform.libc_ver())}, Python {platform.python_version()}"
    for name in ("cvtcycle", "fastsim", "numpy"):
        yield name, version(name)
    for name in BACKTRACE:
        yield name, os.environ.get(name, "unset, for both programs")
    for name, value in sorted(os.environ.items()):
        if name.startswith(("RUST", "RAYON", "OMP_", "POLARS")) and name not in BACKTRACE:
            yield name, value


def median_us(call, count):
    call()
    times = []
    for _ in range(count):
        begun = time.perf_counter_ns()
        call()
        times.append((time.perf_counter_ns() - begun) / 1e3)
    return statistics.median(times)


def import_ms(module):
    code = f"import time; t = time.perf_counter(); import {module}; print((time.perf_counter() - t) * 1e3)"
    times = [float(subprocess.check_output([sys.executable, "-c", code])) for _ in range(7)]
    return statistics.median(times)


def cvtcycle(native):
    import cvtcycle as cc
    import numpy

    car, cycle = cc.Car("rover_216_cvt"), cc.Cycle("ece15_eudc")
    yield "cvtcycle: import, ms", import_ms("cvtcycle")
    yield "cvtcycle: run, us", median_us(lambda: cc.run(car, cycle, trace=False), 400)
    step = cc.Cycle.from_arrays([0, 1], [10, 10])
    yield "cvtcycle: run of a single step, us: the call and little else", median_us(lambda: cc.run(car, step, trace=False), 2000)
    if native:
        yield "cvtcycle: the same run without Python, us", float(subprocess.check_output([native]))
    yield "cvtcycle: run with trace and polars frame, us", median_us(lambda: cc.run(car, cycle).trace.to_polars(), 200)
    family = cc.Family(car, cycle, ["road_load.mass_kg"])
    X = numpy.linspace(1000, 1400, 512)[:, None]
    yield "cvtcycle: family on all cores, us a point", median_us(lambda: family(X), 3) / len(X)
    ratio = numpy.linspace(0.6, 2.2, 20_000)
    yield "cvtcycle: losses on all cores, us a point", median_us(lambda: cc.losses(car, belt_ratio=ratio), 5) / len(ratio)


def fastsim():
    try:
        import fastsim as fsim
    except ImportError:
        return
    yield "FASTSim: import, ms", import_ms("fastsim")
    vehicle = fsim.Vehicle.from_resource("2012_Ford_Fusion.yaml")
    vehicle.set_save_interval(1)
    cycle = fsim.Cycle.from_resource("udds.csv")

    def drive():
        sim = fsim.SimDrive(vehicle, cycle)
        sim.run()
        return sim.to_dataframe()

    steps = len(cycle.to_dict()["time_seconds"])
    yield f"FASTSim: run and polars frame of UDDS ({steps} steps), us", median_us(drive, 40)


def fair():
    import cvtcycle as cc

    car, cycle = cc.Car("rover_216_cvt"), cc.Cycle("udds")
    trace = cc.run(car, cycle).trace
    words = f"cvtcycle: run and polars frame of UDDS ({len(trace)} steps, {len(trace.columns)} columns), us"
    yield words, median_us(lambda: cc.run(car, cycle).trace.to_polars(), 200)


def once_us(call, *given):
    """Processor time of a call in all threads: other work on the machine does not count."""
    begun = time.process_time_ns()
    call(*given)
    return (time.process_time_ns() - begun) / 1e3


def quartiles(numbers):
    low, middle, high = statistics.quantiles(numbers, n=4)
    return f"{middle:8.3f}  ({low:.3f} to {high:.3f})"


def ratio(rounds=200):
    """Time a step of UDDS. One run of each program after the other, so that both have the same machine; ratios of neighbours."""
    import cvtcycle as cc
    import fastsim as fsim
    import numpy

    cycle, theirs = cc.Cycle("udds"), fsim.Cycle.from_resource("udds.csv")
    steps = {"cvtcycle": len(cc.run("rover_216_cvt", cycle).trace), "FASTSim": len(theirs.to_dict()["time_seconds"])}
    cars = {name: cc.Car(name) for name in ("rover_216_cvt", "rover_216_5mt")}
    vehicles = {name: fsim.Vehicle.from_resource(f"2026_Chrysler_Pacifica_Select{name}.yaml") for name in ("", "_thrml")}
    for vehicle in vehicles.values():
        vehicle.set_save_interval(None)
    families = {name: cc.Family(car, cycle, ["road_load.mass_kg"], threads=1) for name, car in cars.items()}
    masses_kg = numpy.linspace(950, 1400, 64)[:, None]
    times = {}

    def took(name, count, call, *given):
        times.setdefault(name, []).append(once_us(call, *given) / count)

    for _ in range(rounds):
        for name, vehicle in vehicles.items():
            sim = fsim.SimDrive(vehicle, theirs)
            took("FASTSim with its thermal model" if name else "FASTSim without temperatures", steps["FASTSim"], sim.run)
        for name, car in cars.items():
            took(f"cvtcycle {name}", steps["cvtcycle"], lambda: cc.run(car, cycle, trace=False))
            took(f"cvtcycle {name}, 64 cars on one thread", steps["cvtcycle"] * len(masses_kg), families[name], masses_kg)
    print(f"processor time, us a step of UDDS, {rounds} rounds: median (quartiles)")
    for name, numbers in times.items():
        print(f"{name:60} {quartiles(numbers)}")
    print("time of FASTSim over that of cvtcycle, each round by itself: median (quartiles)")
    for theirs in ("FASTSim with its thermal model", "FASTSim without temperatures"):
        for name in [name for name in times if name.startswith("cvtcycle")]:
            print(f"{theirs} / {name:55} {quartiles([a / b for a, b in zip(times[theirs], times[name])])}")


if __name__ == "__main__":
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--native")
    arguments.add_argument("--ratio", action="store_true")
    arguments.add_argument("--keep-environment", action="store_true")
    given = arguments.parse_args()
    if not given.keep_environment:
        for variable in BACKTRACE:
            os.environ.pop(variable, None)
    for name, value in environment():
        print(f"{name}: {value}")
    if given.ratio:
        ratio()
    else:
        for rows in cvtcycle(given.native), fair(), fastsim():
            for name, number in rows:
                print(f"{name:75} {number:10.1f}", flush=True)
