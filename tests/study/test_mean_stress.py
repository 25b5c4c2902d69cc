"""Finite elements of the flaw as it is: what is kept is what a coarser solve finds, and agrees with closed forms."""

import pytest

from rsmpm_ti.rock.presets import lab_rock
from rsmpm_ti.study import flaw_cracks, mean_stress
from rsmpm_ti.study.mean_stress import ANGLES, HALF, LENGTH, MESH, TENSILE, WIDTH


def test_what_is_kept_is_of_the_flaw_and_rock_that_the_runs_have():
    rock = lab_rock()
    assert (WIDTH, LENGTH, TENSILE) == (
        flaw_cracks.WIDTH,
        rock.nonlocal_mean.length,
        rock.criterion.tensile_strength,
    )
    kept = mean_stress.kept()
    assert kept.keys() == HALF.keys() and all(tuple(cracks) == ANGLES for cracks in kept.values())


def test_flaw_across_the_load_cracks_from_its_middle_along_the_load():
    for specimen, angle in (("cube", 0.0), ("disc", 90.0)):
        crack = mean_stress.kept()[specimen][angle]
        assert crack["along"] < 1e-6 and crack["first"] == pytest.approx(90.0, abs=0.1)


def test_mean_of_the_stress_cracks_a_flaw_later_than_its_largest():
    """A rounded slot across the load bears at most S in tension in the middle of its face, whatever its length.

    Inglis (1913): -S on the face of an ellipse. So strength is reached at no less than TENSILE.
    """
    assert mean_stress.kept()["cube"][0.0]["stress"] > TENSILE


@pytest.mark.validation
@pytest.mark.parametrize("specimen, angle", [("cube", 45.0), ("disc", 30.0)])
def test_a_coarser_mesh_finds_the_same(specimen, angle):
    """Halving the mesh and the pixels changed loads by 0.4 % and angles by half a degree: doubling it, thrice that."""
    pytest.importorskip("gmsh")
    pytest.importorskip("skfem")
    crack, kept = (
        mean_stress.first_crack(specimen=specimen, angle=angle, mesh=MESH.scaled(2.0)),
        mean_stress.kept()[specimen][angle],
    )
    assert crack["stress"] == pytest.approx(kept["stress"], rel=0.01)
    assert crack["first"] == pytest.approx(kept["first"], abs=1.5)
