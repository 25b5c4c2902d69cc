"""Every study by name."""

from rsmpm_ti.study import grid_independence
from rsmpm_ti.study.runs import Study

MODULES = (grid_independence,)

STUDIES: dict[str, Study] = {study.name: study for module in MODULES for study in module.STUDIES}
