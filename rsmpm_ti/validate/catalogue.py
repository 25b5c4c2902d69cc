"""Every case of validation by name."""

from rsmpm_ti.validate.dynamics import crack_speed, kalthoff, scabs, spall
from rsmpm_ti.validate.experiment import Experiment
from rsmpm_ti.validate.strength import westerly

MODULES = (westerly, spall, scabs, kalthoff, crack_speed)

CASES: dict[str, Experiment] = {case.name: case for module in MODULES for case in module.CASES}
