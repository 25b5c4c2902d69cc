"""Every hard case by name."""

from rsmpm_ti.stress import crossing, failing, impact, labels, steps
from rsmpm_ti.verify.case import Case

MODULES = (crossing, steps, labels, impact, failing)

CASES: dict[str, Case] = {case.name: case for module in MODULES for case in module.CASES}
"""In the order of their numbers."""
