"""FMUs under a master: FMPy. Every FMU of a folder is validated, driven, saved, restored and fed with nonsense.

Truth: `cvtcycle run` for the fuel of a whole car, `cvtcycle losses` for operating points, both of the program that wrote the FMUs.
"""

import csv
import json
import os
import shutil
import subprocess
import sys
from ctypes import byref, c_void_p
from pathlib import Path

import numpy as np
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import (
    FMU2Slave,
    fmi2CallbackAllocateMemoryTYPE,
    fmi2CallbackFreeMemoryTYPE,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
)
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu

CVTCYCLE = os.environ["CVTCYCLE"]
AMBIENT_DEGC = -10.0
SPEED = "v_VEH_PNT_in_mps"
FUEL = "m_fuel_ENG_PNT_out_kg"


class Slave:
    """One instance, the same for both versions of the standard."""

    def __init__(self, description, folder, **changed):
        self.description = description
        self.references = {v.name: v for v in description.modelVariables}
        self.messages = []
        self.is_2 = description.fmiVersion == "2.0"
        token = description.guid if self.is_2 else description.instantiationToken
        arguments = dict(
            guid=token,
            unzipDirectory=folder,
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName="slave",
        )
        arguments.update(changed)
        if self.is_2:
            self.fmu = FMU2Slave(**arguments)
            self.logger = fmi2CallbackLoggerTYPE(lambda *a: self.messages.append((a[2], a[4].decode())))
            callbacks = fmi2CallbackFunctions()
            callbacks.logger = self.logger
            callbacks.allocateMemory = fmi2CallbackAllocateMemoryTYPE()
            callbacks.freeMemory = fmi2CallbackFreeMemoryTYPE()
            self.fmu.instantiate(callbacks=callbacks)
        else:
            self.fmu = FMU3Slave(**arguments)
            self.fmu.instantiate(logMessage=lambda e, status, c, text: self.messages.append((status, text.decode())))

    def start(self, time_s=0.0, **values):
        if self.is_2:
            self.fmu.setupExperiment(startTime=time_s)
            self.fmu.enterInitializationMode()
        else:
            self.fmu.enterInitializationMode(startTime=time_s)
        self.set(**values)
        self.fmu.exitInitializationMode()
        return self

    def set(self, **values):
        for name, value in values.items():
            variable = self.references[name]
            whole = variable.type in ("Integer", "Int32")
            setter = {
                (True, True): "setInteger",
                (True, False): "setReal",
                (False, True): "setInt32",
                (False, False): "setFloat64",
            }[self.is_2, whole]
            getattr(self.fmu, setter)([variable.valueReference], [value])

    def real(self, reference):
        return (self.fmu.getReal if self.is_2 else self.fmu.getFloat64)([reference])[0]

    def get(self, name):
        return self.real(self.references[name].valueReference)

    def outputs(self):
        real = [v for v in self.references.values() if v.causality == "output" and v.type in ("Real", "Float64")]
        return [self.real(v.valueReference) for v in real]

    def step(self, time_s, step_s):
        self.fmu.doStep(currentCommunicationPoint=time_s, communicationStepSize=step_s)

    def save(self):
        return self.fmu.getFMUstate() if self.is_2 else self.fmu.getFMUState()

    def restore(self, state):
        self.fmu.setFMUstate(state) if self.is_2 else self.fmu.setFMUState(state)

    def to_bytes(self, state):
        return self.fmu.serializeFMUstate(state) if self.is_2 else self.fmu.serializeFMUState(state)

    def from_bytes(self, data):
        return self.fmu.deSerializeFMUstate(data) if self.is_2 else self.fmu.deserializeFMUState(data)

    def free_state(self, state):
        (self.fmu.fmi2FreeFMUstate if self.is_2 else self.fmu.fmi3FreeFMUState)(self.fmu.component, byref(state))

    def refused(self, what, call):
        """Checks that the call has status error, and the logger a message with `what`."""
        self.messages.clear()
        try:
            call()
        except FMICallException as error:
            assert error.status == 3, (what, error)
        else:
            raise AssertionError(f"{what}: not refused")
        found = self.messages and self.messages[-1][0] == 3 and what in self.messages[-1][1]
        assert found, (what, self.messages)


def cycle_rows(file):
    with open(file, newline="") as source:
        rows = list(csv.DictReader(source))
    return [(float(row["time_s"]), float(row["speed_km_h"]) / 3.6) for row in rows]


def run_fuel(car, cycle):
    command = [CVTCYCLE, "run", "--vehicle", car, "--cycle", str(cycle), "--ambient", str(AMBIENT_DEGC)]
    done = subprocess.run([*command, "--baseline", "none", "--json"], capture_output=True, text=True, check=True)
    return json.loads(done.stdout)["runs"][0]["fuel_kg"]


def drive(slave, rows, end=None):
    for (time_s, _), (next_s, speed) in list(zip(rows, rows[1:]))[:end]:
        slave.set(**{SPEED: speed})
        slave.step(time_s, next_s - time_s)
    return slave


def start_car(description, folder):
    return Slave(description, folder).start(T_AMB_PNT_in_K=AMBIENT_DEGC + 273.15)


def check_car(description, folder, car, cycle):
    rows = cycle_rows(cycle)
    want = run_fuel(car, cycle)
    whole = drive(start_car(description, folder), rows)
    got = whole.get(FUEL)
    assert abs(got / want - 1.0) < 1e-9, (car, got, want)
    end = whole.outputs()
    assert np.isfinite(end).all(), end

    # Two alternating instances, one of them a step behind and with another ambient, do not affect each other.
    one, two = start_car(description, folder), Slave(description, folder).start(T_AMB_PNT_in_K=308.15)
    for k, ((time_s, _), (next_s, speed)) in enumerate(zip(rows, rows[1:])):
        one.set(**{SPEED: speed})
        two.set(**{SPEED: 0.5 * speed})
        one.step(time_s, next_s - time_s)
        two.step(time_s, next_s - time_s)
        if k == 400:
            state = one.save()
            data = one.to_bytes(state)
    assert one.outputs() == end
    assert two.get(FUEL) < 0.9 * got

    # Back to the middle and on again with the same bits, from the state and from its bytes in a new instance.
    for other, back in ((one, state), (start_car(description, folder), None)):
        other.restore(back or other.from_bytes(data))
        for (time_s, _), (next_s, speed) in list(zip(rows, rows[1:]))[401:]:
            other.set(**{SPEED: speed})
            other.step(time_s, next_s - time_s)
        assert other.outputs() == end
    one.free_state(state)

    # Longer communication steps are divided. A warm start burns less.
    assert drive(start_car(description, folder), rows[::20]).get(FUEL) > 0.5 * want
    warm = Slave(description, folder).start(T_AMB_PNT_in_K=AMBIENT_DEGC + 273.15, T_start_VEH_PNT_K=353.15)
    assert drive(warm, rows).get(FUEL) < want
    return got, want


def check_master(file, rows, got):
    """FMPy's own loop sets the speed at the beginning of a step, so its trace lags by one step."""
    late = np.array([(t, v) for (t, _), (_, v) in zip(rows, rows[1:])] , dtype=[("time", float), (SPEED, float)])
    result = simulate_fmu(
        file,
        stop_time=rows[-1][0],
        output_interval=1.0,
        step_size=1.0,
        input=late,
        start_values={"T_AMB_PNT_in_K": AMBIENT_DEGC + 273.15},
        output=[FUEL, "ToutOil"],
    )
    assert abs(result[FUEL][-1] / got - 1.0) < 1e-9, (result[FUEL][-1], got)


def check_losses(description, folder, car):
    slave = Slave(description, folder).start()
    is_cvt = "ratio_VAR_in" in slave.references
    ratio = ["--ratio", "0.8"] if is_cvt else ["--gear", "3"]
    slave.set(**({"ratio_VAR_in": 0.8} if is_cvt else {"gear_AT_PNT_in": 3}))
    slave.set(w_FW_PNT_in_radps=2500 * np.pi / 30, trq_FW_PNT_in_Nm=60.0, T_oil_AT_PNT_in_K=303.15)
    slave.step(0.0, 1.0)
    command = [CVTCYCLE, "losses", "--vehicle", car, *ratio, "--temp", "30", "--input-torque", "60", "--json"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    point = json.loads(done.stdout)["points"][0]
    for name, column in (
        ("trq_loss_AT_PNT_Nm", "total_loss_nm"),
        ("trq_DS_PNT_out_Nm", "output_torque_nm"),
        ("eta_AT", "efficiency"),
    ):
        got, want = slave.get(name), point[column]
        assert abs(got - want) <= 1e-9 * abs(want), (car, name, got, want)
    heat = slave.get("Qf_HYD_PNT_W") + slave.get("Qf_GB_PNT_W")
    assert abs(heat - slave.get("P_loss_AT_PNT_W")) < 1e-9 * heat
    slave.set(w_FW_PNT_in_radps=0.0)
    assert slave.get("P_loss_AT_PNT_W") == 0.0
    # A state restores a step, whatever the inputs in between.
    state = slave.save()
    slave.set(trq_FW_PNT_in_Nm=-20.0, w_FW_PNT_in_radps=300.0)
    assert slave.get("P_loss_AT_PNT_W") > 0.0
    slave.restore(slave.from_bytes(slave.to_bytes(state)))
    assert slave.get("P_loss_AT_PNT_W") == 0.0


def launch(slave, steps, first=0, wheel=0.0, torque=0.0):
    """Pulls away with 70 Nm in low and shifts up, in a car of 1100 kg on wheels of 0.28 m. Returns wheel speed and torque."""
    inertia, step_s = 1100 * 0.28**2, 0.02
    for k in range(first, first + steps):
        wheel = max(0.0, wheel + step_s * (torque - 60.0) / inertia)
        ratio = slave.references["ratio_VAR_in"]
        asked = float(ratio.start) if k < 300 else 0.8
        slave.set(trq_FW_PNT_in_Nm=70.0, w_DS_PNT_in_radps=wheel, ratio_VAR_in=asked, T_oil_AT_PNT_in_K=320.0)
        slave.step(k * step_s, step_s)
        torque = slave.get("trq_DS_PNT_out_Nm")
        engine = slave.get("trq_FW_PNT_out_Nm") * slave.get("w_ENG_PNT_radps")
        wheels = torque * slave.get("w_DS_PNT_radps")
        heat = slave.get("Qf_HYD_PNT_W") + slave.get("Qf_GB_PNT_W")
        rest = engine - wheels - heat - slave.get("P_kin_AT_PNT_W") - slave.get("P_el_AT_PNT_W")
        assert abs(rest) < 1e-9 * (abs(engine) + abs(wheels) + heat), (k, rest)
    return wheel, torque


def check_cvt(description, folder):
    """A launch balances power and reaches its speed; another instance started from the bytes of a state in the middle ends equally."""
    slave = Slave(description, folder).start()
    at = launch(slave, 200)
    data = slave.to_bytes(slave.save())
    speed = launch(slave, 500, 200, *at)[0] * 0.28
    assert 8.0 < speed < 40.0, speed
    assert abs(slave.get("ratio_VAR") - 0.8) < 1e-9, slave.get("ratio_VAR")
    end = slave.outputs()
    assert np.isfinite(end).all(), end
    other = Slave(description, folder).start()
    other.restore(other.from_bytes(data))
    launch(other, 500, 200, *at)
    assert other.outputs() == end
    return f"pulls away to {speed:.1f} m/s in 14 s"


def check_nonsense(description, folder, kind):
    slave = Slave(description, folder).start()
    name = SPEED if kind == "car" else "trq_FW_PNT_in_Nm"
    before = slave.outputs()
    for value in (float("nan"), float("inf"), -1e9):
        slave.refused("out of range", lambda value=value: slave.set(**{name: value}))
    output = next(v.name for v in slave.references.values() if v.causality == "output")
    slave.refused("computed", lambda: slave.set(**{output: 1.0}))
    slave.refused("value reference 9999", lambda: slave.real(9999))
    for time_s, step_s, what in (
        (0.0, -1.0, "out of range"),
        (0.0, 0.0, "out of range"),
        (0.0, float("nan"), "out of range"),
        (0.0, 1e9, "out of range"),
        (float("nan"), 1.0, "begins at"),
        (5.0, 1.0, "begins at"),
    ):
        slave.refused(what, lambda t=time_s, h=step_s: slave.step(t, h))
    whole = next((v for v in slave.references.values() if v.type in ("Integer", "Int32")), None)
    if whole is not None:
        slave.refused("no real number", lambda: slave.real(whole.valueReference))
    data = slave.to_bytes(slave.save())
    for wrong in (data[:-1], data[:9], b"", b"x" * len(data), data[:-8] + b"\xff" * 8, data + data):
        if len(wrong) > 0:
            slave.refused("", lambda wrong=wrong: slave.from_bytes(wrong))
    slave.refused("missing", lambda: slave.restore(c_void_p()))
    assert slave.outputs() == before
    slave.step(0.0, 1.0)
    # Refused without a crash: the description of another FMU, missing resources.
    for changed in ({"guid": "{0}"}, {"unzipDirectory": missing(folder)}):
        try:
            Slave(description, folder, **changed)
        except Exception as error:
            assert "nstantiate" in str(error), error
        else:
            raise AssertionError(f"{changed}: instantiated")


def missing(folder):
    """Copies the resources without the vehicle file."""
    copy = f"{folder}_missing"
    shutil.rmtree(copy, ignore_errors=True)
    shutil.copytree(folder, copy)
    shutil.rmtree(f"{copy}/resources/vehicle")
    return copy


def main(fmus):
    own = os.environ["OWN"]
    cycles = Path(__file__).parents[3] / "cycles"
    plain = fmus / "plain.csv"
    with open(cycles / "ece15_eudc.csv", newline="") as source:
        table = [row[:2] for row in csv.reader(source)]
    plain.write_text("".join(",".join(row) + "\n" for row in table))
    files = sorted(fmus.glob("*.fmu"))
    for file in files:
        findings = validate_fmu(str(file))
        assert not findings, (file.name, findings)
        name, kind, fmi = file.stem.rsplit("_", 2)
        car = f"{own}/car.toml" if name == "car" else name
        description = read_model_description(str(file))
        folder = extract(str(file), str(fmus / file.stem))
        # Without prescribed gears, which FMUs do not have: a manual box shifts by its shift speeds.
        cycle = cycles / "ece15_eudc_auto.csv" if name != "rover_216_5mt" else plain
        words = ""
        if kind == "car":
            got, want = check_car(description, folder, car, cycle)
            check_master(str(file), cycle_rows(cycle), got)
            words = f"{got:.12f} kg, cvtcycle run {want:.12f} kg"
        elif kind == "cvt":
            words = check_cvt(description, folder)
        else:
            check_losses(description, folder, car)
        check_nonsense(description, folder, kind)
        print(f"{file.name}: {file.stat().st_size / 1e6:.2f} MB, {len(description.modelVariables)} variables, no findings {words}")
    assert files


main(Path(sys.argv[1]))
