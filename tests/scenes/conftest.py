"""The scenes that ship, each run once, coarse, for all tests of it."""

import functools

import pytest

from rsmpm_ti import load_scene, simulate
from rsmpm_ti.results.result import Result

COARSE = {
    "cube": {"dx": 2e-3, "flaw_width": 6e-3, "time_scale": 20.0},
    "disc": {"dx": 2e-3, "flaw_width": 4e-3, "time_scale": 16.0},
    "intact": {"dx": 5e-3},
    "cube_lab": {"dx": 1.25e-3, "length": 2.5e-3, "flaw_width": 3.75e-3, "time_scale": 60.0, "strain_end": 7e-4,
                 "servo": False},
    "disc_lab": {"dx": 1.25e-3, "length": 2.5e-3, "flaw_width": 3.75e-3, "time_scale": 60.0, "strain_end": 2.4e-4},
    "confined": {"dx": 1.25e-3, "length": 2.5e-3, "flaw_width": 3.75e-3, "time_scale": 60.0},
    "two_flaws": {"dx": 1.25e-3, "length": 2.5e-3, "flaw_width": 3.75e-3, "time_scale": 60.0, "strain_end": 7.5e-4},
    "intact_weibull": {"dx": 1.25e-3, "length": 2.5e-3, "time_scale": 80.0, "strain_end": 1.3e-3},
    "notched_beam": {"depth": 32e-3, "notch": 16e-3, "deflection_end": 3.2e-5, "dx": 2e-3, "length": 4e-3,
                     "time_scale": 6.0},
    "semicircular_bend": {"dx": 2e-3, "length": 4e-3, "deflection_end": 1.5e-5},
    "direct_shear": {"dx": 2e-3, "length": 4e-3},
    "tunnel": {"dx": 2e-3, "length": 4e-3, "time_scale": 30.0},
    "inclusion": {"dx": 1.25e-3, "length": 2.5e-3, "time_scale": 30.0, "strain_end": 7.5e-4},
    "excavation": {"dx": 2e-3, "length": 4e-3, "width": 96e-3, "vertical_stress": 16e6, "relaxation": 2e-4},
    "blast_hole": {"dx": 1e-3, "length": 2e-3, "width": 60e-3, "t_end": 25e-6},
    "impact": {"dx": 1e-3, "length": 2e-3},
    "slope": {"dx": 4.0, "length": 8.0, "t_end": 5.0},
}  # fmt: skip
"""Keywords of a run of some 5 s that breaks rock, with cells as large as the scene's flaw and material length allow."""


@pytest.fixture(scope="session")
def coarse_run():
    """name -> Result of the coarse run on one thread."""

    @functools.cache
    def run(name: str) -> Result:
        return simulate(load_scene(name, **COARSE[name]), threads=1)

    return run


@pytest.fixture(scope="session")
def coarse():
    """name -> keywords of the coarse run."""
    return lambda name: dict(COARSE[name])
