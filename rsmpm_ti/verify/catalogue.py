"""Every verification case by name."""

from rsmpm_ti.verify import (
    bodies,
    cell,
    cracked_cell,
    disc,
    envelope,
    first_failure,
    hole,
    manufactured,
    relaxation,
    slit_field,
    specimen,
    triaxial,
    waves,
    weibull,
)
from rsmpm_ti.verify.case import Case

MODULES = (
    waves, bodies, relaxation, manufactured, specimen, triaxial, envelope, cell, cracked_cell, disc, hole, slit_field,
    first_failure, weibull,
)  # fmt: skip

CASES: dict[str, Case] = {case.name: case for module in MODULES for case in module.CASES}
