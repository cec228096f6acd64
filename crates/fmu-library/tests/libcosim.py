"""A whole car under a second importer: libcosim of the Open Simulation Platform, which reads FMUs of version 2.0 by a library of its own.

    libcosim.py FMU CYCLE.csv FUEL_KG    the fuel is that of `cvtcycle run` without baselines at -10 degC
"""

import csv
import sys

from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimManipulator import CosimManipulator
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave

SECOND_NS = 1_000_000_000


def main(fmu, cycle, want):
    with open(cycle, newline="") as source:
        rows = [(float(row["time_s"]), float(row["speed_km_h"]) / 3.6) for row in csv.DictReader(source)]
    assert all(later[0] - row[0] == 1.0 for row, later in zip(rows, rows[1:])), "a step of 1 s"
    execution = CosimExecution.from_step_size(SECOND_NS)
    car = execution.add_local_slave(CosimLocalSlave(fmu_path=fmu, instance_name="car"))
    places = {own.name.decode(): own.reference for own in execution.slave_variables(car)}
    observer, manipulator = CosimObserver.create_last_value(), CosimManipulator.create_override()
    assert execution.add_observer(observer) and execution.add_manipulator(manipulator)
    assert execution.real_initial_value(car, places["T_AMB_PNT_in_K"], 263.15)
    for _, speed in rows[1:]:
        assert manipulator.slave_real_values(car, [places["v_VEH_PNT_in_mps"]], [speed])
        assert execution.step(), execution.status()
    got = observer.last_real_values(car, [places["m_fuel_ENG_PNT_out_kg"]])[0]
    assert abs(got / want - 1.0) < 1e-9, (got, want)
    print(f"libcosim: {got:.12f} kg, cvtcycle run {want:.12f} kg")


main(sys.argv[1], sys.argv[2], float(sys.argv[3]))
