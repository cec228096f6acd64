"""Ten lines to the first picture."""
import cvtcycle as cc

car = cc.Car("rover_216_cvt", set={"transmission.cvt.pump.displacement_cc_rev": 7})
run = cc.run(car, "ece15_eudc", ambient_degc=-10, baselines=["rover_216_5mt"])
print(f"{run.fuel_l_per_100km:.2f} L/100 km")
print(f"{run.summary['comparison'][0]['fuel_percent']:.1f} % more than the car with a manual box")
print(f"belt at most {max(run.trace['belt_spray_degc']):.1f} {run.trace.units['belt_spray_degc']}")
run.plot("losses").save("losses.svg")
run.report("cold.html", force=True)
