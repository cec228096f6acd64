"""Times of the Python package, and of FASTSim 3 on the same machine.

    pip install numpy polars fastsim==3.1.0 target/wheels/cvtcycle-*.whl
    python benches/python.py [--native target/release/examples/native_run]
    python benches/python.py --ratio        both programs in turn on UDDS, time a step; `benches/against_fastsim` installs all of it

Each time is the median of many calls; with --ratio it is the minimum. `native_run` drives the same run without Python and prints its own median.
"""

import argparse
import statistics
import subprocess
import sys
import time


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
    begun = time.perf_counter_ns()
    call(*given)
    return (time.perf_counter_ns() - begun) / 1e3


def ratio(rounds=60):
    """Time a step of UDDS, one run of each program after the other, so that both have the same machine."""
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
        times[name] = min(times.get(name, float("inf")), once_us(call, *given) / count)

    for _ in range(rounds):
        for name, car in cars.items():
            took(f"cvtcycle {name}", steps["cvtcycle"], lambda: cc.run(car, cycle, trace=False))
            took(f"cvtcycle {name}, 64 cars on one thread", steps["cvtcycle"] * len(masses_kg), families[name], masses_kg)
        for name, vehicle in vehicles.items():
            sim = fsim.SimDrive(vehicle, theirs)
            took("FASTSim with its thermal model" if name else "FASTSim without temperatures", steps["FASTSim"], sim.run)
    yield from ((f"{name}, us a step", number) for name, number in times.items())
    thermal = times["FASTSim with its thermal model"]
    for name in [name for name in times if name.startswith("cvtcycle")]:
        yield f"FASTSim with its thermal model / {name}", thermal / times[name]


if __name__ == "__main__":
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--native")
    arguments.add_argument("--ratio", action="store_true")
    given = arguments.parse_args()
    for rows in (ratio(),) if given.ratio else (cvtcycle(given.native), fair(), fastsim()):
        for name, number in rows:
            print(f"{name:75} {number:10.1f}", flush=True)
