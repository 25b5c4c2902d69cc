"""Every case of validation by name."""

from rsmpm_ti.validate.experiment import Experiment
from rsmpm_ti.validate.fracture import edge_notch, gregoire
from rsmpm_ti.validate.strength import westerly

MODULES = (westerly, gregoire, edge_notch)

CASES: dict[str, Experiment] = {case.name: case for module in MODULES for case in module.CASES}
