"""The tests that there are."""

from rsmpm_ti.lab.bending import BEND, SCB
from rsmpm_ti.lab.compression import TRIAXIAL, UCS
from rsmpm_ti.lab.shear import SHEAR
from rsmpm_ti.lab.tension import BRAZILIAN, TENSION

TESTS = {test.name: test for test in (UCS, BRAZILIAN, TENSION, TRIAXIAL, SHEAR, BEND, SCB)}
