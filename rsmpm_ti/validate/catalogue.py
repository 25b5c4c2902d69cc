"""Every case of validation by name."""

from rsmpm_ti.validate.dynamics import crack_speed, kalthoff, scabs, spall
from rsmpm_ti.validate.examples import flawed, mode_two, paper
from rsmpm_ti.validate.experiment import Experiment
from rsmpm_ti.validate.fracture import cantilever, edge_notch, gregoire
from rsmpm_ti.validate.strength import carrara, sigma_2, westerly, zigong

MODULES = (
    gregoire, flawed, mode_two, westerly, zigong, carrara, sigma_2, edge_notch, cantilever, spall, scabs, kalthoff,
    crack_speed, paper,
)  # fmt: skip
"""The longest, a beam on fine cells, first: it would be left to run alone at the end."""

CASES: dict[str, Experiment] = {case.name: case for module in MODULES for case in module.CASES}
