"""Scenes at the ends of what is accepted really run: a few steps each, to finite numbers or to a clear end."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hostile import check_runnable, put

from rsmpm_ti import load_scene, simulate
from rsmpm_ti.errors import UnstableRun
from rsmpm_ti.rock.after_failure import Clipped
from rsmpm_ti.rock.heterogeneity import Weibull
from rsmpm_ti.spec.boundaries import Platen
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.loading_start import AtRest
from rsmpm_ti.spec.regions import Box
from rsmpm_ti.spec.scene import Body, Schedule

STEPS = 5
LONE = load_scene("cube", dx=5e-3, flaw_width=15e-3)
LONE = replace(LONE, bodies=(replace(LONE.bodies[0], region=Box(lower=(0.0, 0.0), upper=(0.05, 0.1))),))
LONE = replace(LONE, schedule=Schedule(t_end=1.0), loading=replace(LONE.loading, start=AtRest()))
HOOKE, CRITERION, BODY = ["rock", "elasticity"], ["rock", "criterion"], ["bodies", 0]


def moved(scale: float, shift: float):
    """The scene with all lengths scaled, then moved."""

    def position(corner):
        return tuple(scale * x + shift for x in corner)

    domain = LONE.domain
    platens = (
        Platen(axis=1, side="lower", position=shift, speed=1e-3),
        Platen(axis=1, side="upper", position=scale * 0.1 + shift, speed=-1e-3),
    )
    region = Box(lower=position((0.0, 0.0)), upper=position((0.05, 0.1)))
    return replace(
        LONE,
        domain=Domain(lower=position(domain.lower), upper=position(domain.upper), dx=scale * domain.dx),
        bodies=(Body(region=region),),
        loading=replace(LONE.loading, boundaries=platens, width=scale * 0.05),
        schedule=Schedule(t_end=scale),
    )


def of_rock(rock):
    """The scene of another rock, for as long as a wave needs for a few of its cells."""
    transit = LONE.domain.dx / rock.wave_speed(LONE.loading.time_scale)
    slow = tuple(replace(platen, speed=0.0) for platen in LONE.loading.boundaries)
    loading = replace(LONE.loading, boundaries=slow)
    return replace(LONE, rock=rock, loading=loading, schedule=Schedule(t_end=STEPS * transit))


EXTREMES = {
    "softest": lambda: of_rock(put(LONE.rock, ["elasticity", "E"], 1e-12)),
    "stiffest": lambda: of_rock(put(LONE.rock, ["elasticity", "E"], 1e18)),
    "lightest": lambda: of_rock(put(LONE.rock, ["density"], 1e-12)),
    "auxetic": lambda: put(LONE, [*HOOKE, "nu"], -0.999999),
    "incompressible": lambda: put(LONE, [*HOOKE, "nu"], 0.499999),
    "weakest": lambda: put(LONE, [*CRITERION, "tensile_strength"], 1e-12),
    "roughest": lambda: put(put(LONE, [*CRITERION, "tensile_strength"], 1.0), [*CRITERION, "friction_angle"], 89.0),
    "clipped": lambda: put(LONE, ["rock", "after_failure"], Clipped(tension_limit=1e18, compression_limit=1e18)),
    "viscous": lambda: put(LONE, ["rock", "viscosity", "c1"], 1e3),
    "uneven": lambda: put(LONE, ["rock", "heterogeneity"], Weibull(shape=0.5, reference_volume=1e-5)),
    "crowded": lambda: put(LONE, [*BODY, "seeding", "particles_per_axis"], 8),
    "shortest step": lambda: put(LONE, ["schedule"], Schedule(t_end=1e-9, cfl=1e-6)),
    "heaviest": lambda: put(LONE, ["loading", "time_scale"], 1000.0),
    "pressed": lambda: put(LONE, ["loading", "confinement"], 7e8),
    "stuck": lambda: put(LONE, ["loading", "boundaries", 0, "friction"], 1e3),
    "fastest": lambda: put(LONE, [*BODY, "velocity"], (0.39 * LONE.domain.dx / LONE.dt, 0.0)),
    "spinning": lambda: put(LONE, [*BODY, "spin"], 0.39 * LONE.domain.dx / LONE.dt / math.hypot(0.025, 0.05)),
    "tiny": lambda: moved(1e-6, 0.0),
    "huge": lambda: moved(1e8, 0.0),
    "far away": lambda: moved(1.0, 4e6),
}


@pytest.mark.validation
@pytest.mark.parametrize("name", EXTREMES)
def test_accepted_extreme_runs(name):
    scene = EXTREMES[name]()
    scene = replace(scene, schedule=replace(scene.schedule, t_end=STEPS * scene.dt))
    check_runnable(scene)
    try:
        result = simulate(scene)
    except UnstableRun as error:
        assert "step" in str(error)  # an outcome with a reason, as a run of such rock may have
        return
    assert result.summary["steps"] == STEPS and not result.stopped
    for values in (
        result.snapshot.x,
        result.snapshot.velocity,
        result.snapshot.sigma,
        result.history["energy_kinetic_J"],
    ):
        assert np.isfinite(values).all()
