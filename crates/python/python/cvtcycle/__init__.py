"""Drive-cycle losses and fuel of cars with a pushing-belt CVT, cold and warm, from component physics.

>>> import cvtcycle as cc
>>> run = cc.run("rover_216_cvt", "ece15_eudc", ambient_degc=-10)
>>> round(run.fuel_l_per_100km)
8
"""

from __future__ import annotations

from . import _native
from ._car import Car, Cycle
from ._errors import InputError, Problem
from ._family import Family
from ._run import Picture, Run, run
from ._study import StoredStudy, Study
from ._table import Table
from ._tools import belt, calibrate, explain, fleet, losses, names, schema, validate

__version__, __build__ = _native.version()

__all__ = [
    "Car",
    "Cycle",
    "Family",
    "InputError",
    "Picture",
    "Problem",
    "Run",
    "StoredStudy",
    "Study",
    "Table",
    "belt",
    "calibrate",
    "explain",
    "fleet",
    "losses",
    "names",
    "run",
    "schema",
    "validate",
]
