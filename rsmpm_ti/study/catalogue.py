"""Every study by name."""

from rsmpm_ti.study import flaw_angle, fracture_energy, grid_independence, shear_band
from rsmpm_ti.study.runs import Study

MODULES = (flaw_angle, fracture_energy, grid_independence, shear_band)

STUDIES: dict[str, Study] = {study.name: study for module in MODULES for study in module.STUDIES}
