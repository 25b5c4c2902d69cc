"""Every hard case by name."""

from rsmpm_ti.cases.case import Case
from rsmpm_ti.hardcases import crossing, elastic, failing, impact, invariance, labels, motion, restart, steps

MODULES = (crossing, steps, elastic, motion, labels, failing, impact, invariance, restart)

CASES: dict[str, Case] = {case.name: case for module in MODULES for case in module.CASES}
"""In the order of their numbers."""
