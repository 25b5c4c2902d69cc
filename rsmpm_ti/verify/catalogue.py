"""Every verification case by name."""

from rsmpm_ti.cases.case import Case
from rsmpm_ti.verify.elastic import (
    bodies,
    disc,
    energy,
    hole,
    manufactured,
    open_slit,
    relaxation,
    slit_field,
    specimen,
    waves,
)
from rsmpm_ti.verify.interfaces import inclusion, layers
from rsmpm_ti.verify.laboratory import bending, friction, platens, residual, strength_tests
from rsmpm_ti.verify.strength import cracked_cell, envelope, failed_cell, first_failure, triaxial, weibull

MODULES = (
    waves, bodies, relaxation, energy, manufactured, specimen, triaxial, envelope, failed_cell, cracked_cell, disc,
    hole, slit_field, open_slit, first_failure, weibull, strength_tests, residual, platens, friction,
    bending, layers, inclusion,
)  # fmt: skip

CASES: dict[str, Case] = {case.name: case for module in MODULES for case in module.CASES}
