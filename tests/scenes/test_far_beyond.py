"""Scenes of a box or disc between platens, in rock of 10 to 300 MPa, far beyond their peak, by the command: forty runs.

`pytest -m validation tests/scenes/test_far_beyond.py`. A run ends with status 0 and says what happened: it went to its
end, or the specimen burst after a peak. Coarse, as the other tests of scenes.
"""

import json
import math

import pytest

from rsmpm_ti.scene import main
from rsmpm_ti.spec.library.places import available
from rsmpm_ti.spec.loader import load_scene

UCS = 25.520e6
"""Of the rock with which scenes ship [Pa]."""

ROCKS = {"mudstone": (10e6, 3e9), "limestone": (60e6, 30e9), "sandstone": (120e6, 25e9), "granite": (190e6, 60e9),
         "quartzite": (300e6, 80e9)}  # fmt: skip
"""Strength and Young's modulus [Pa]; tensile strength and cohesion go with the strength, energies with its square over
the modulus, so that process zones keep their length."""

BEYOND = 4.0
"""Times the strain to which a scene ships, in units of the rock's own strain at failure."""

OTHERS = {
    "notched_beam",
    "semicircular_bend",
    "direct_shear",
    "tunnel",
    "slope",
    "blast_hole",
    "excavation",
    "impact",
    "inclusion",
}

RUNS = [(name, rock, 1 + k) for name in sorted({*available()} - OTHERS) for k, rock in enumerate(ROCKS)]


def settings(name: str, coarse: dict, strength: float, E: float, seed: int) -> list[str]:
    scene = load_scene(name, **coarse)
    s, strain = strength / UCS, BEYOND * scene.schedule.strain_end * (strength / UCS) * 17e9 / E
    rock = scene.rock
    changes = {
        **coarse,
        "rock.elasticity.E": E,
        "rock.criterion.cohesion": s * rock.criterion.cohesion,
        "rock.criterion.tensile_strength": s * rock.criterion.tensile_strength,
        "strain_end": strain,
    }
    softening = getattr(rock.after_failure, "softening", None)
    if softening is not None:
        for energy in ("G_f_I", "G_f_II"):
            field = f"rock.after_failure.softening.{energy}"
            changes[field] = getattr(softening, energy) * s**2 * 17e9 / E
    if scene.loading.confinement:
        changes["loading.confinement"] = s * scene.loading.confinement
    if hasattr(scene.loading.start, "time"):  # as many wave transits as before
        changes["loading.start.time"] = scene.loading.start.time * max(1.0, math.sqrt(17e9 / E))
    if hasattr(scene.bodies[0].seeding, "seed"):
        changes["bodies.0.seeding.seed"] = seed
    return [part for key, value in changes.items() for part in ("--set", f"{key}={value!r}")]


@pytest.mark.validation
@pytest.mark.parametrize(("name", "rock", "seed"), RUNS, ids=lambda value: str(value))
def test_it_ends_with_status_0_and_says_what_happened(name, rock, seed, coarse, tmp_path, capsys):
    chosen = settings(name, coarse(name), *ROCKS[rock], seed)
    status = main([name, *chosen, "--frames", "0", "--set", "output.vtu=0", "--threads", "1", "--out", str(tmp_path)])
    said = capsys.readouterr()
    assert status == 0, said.out + said.err
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert summary["failed_tension"] + summary["failed_shear"] > 0
    assert summary["stopped"] == "" or summary["stopped"].startswith("burst"), summary["stopped"]
    assert summary["peak_stress_Pa"] is not None, "so far beyond, the load has fallen"
