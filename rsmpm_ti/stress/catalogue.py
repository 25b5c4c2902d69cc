"""Every hard case by name."""

from rsmpm_ti.stress import crossing, elastic, failing, impact, invariance, labels, motion, restart, steps
from rsmpm_ti.verify.case import Case

MODULES = (crossing, steps, elastic, motion, labels, failing, impact, invariance, restart)

CASES: dict[str, Case] = {case.name: case for module in MODULES for case in module.CASES}
"""In the order of their numbers."""
