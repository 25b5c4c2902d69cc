"""Every verification case by name."""

from rsmpm_ti.verify import specimen
from rsmpm_ti.verify.case import Case

CASES: dict[str, Case] = {case.name: case for module in (specimen,) for case in module.CASES}
