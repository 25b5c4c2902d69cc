"""Every verification case by name."""

from rsmpm_ti.verify import cell, disc, envelope, first_failure, hole, slit_field, specimen
from rsmpm_ti.verify.case import Case

MODULES = (specimen, envelope, cell, disc, hole, slit_field, first_failure)

CASES: dict[str, Case] = {case.name: case for module in MODULES for case in module.CASES}
