"""Three layers of three rocks, whose laws differ in kind, between platens that squeeze across them."""

from rsmpm_ti.rock.criteria import MohrCoulomb, Unbreakable
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.rock.presets import lab_rock
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.rock.viscosity import NoViscosity
from rsmpm_ti.spec.boundaries import Platen
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.loading_start import Ramp
from rsmpm_ti.spec.regions import Box
from rsmpm_ti.spec.scene import Body, Loading, Output, Scene, Schedule

DX, WIDTH = 1e-3, 12e-3
LAB = lab_rock(length=2e-3)
SEAM = Rock(
    density=1900.0,
    elasticity=Hooke(E=6e9, nu=0.2),
    criterion=MohrCoulomb(cohesion=0.6e6, friction_angle=35.0, tensile_strength=0.3e6),
)
HARD = Rock(density=2900.0, elasticity=Hooke(E=40e9, nu=0.25), criterion=Unbreakable(), viscosity=NoViscosity())
LAYERS = (0.0, 10e-3, 16e-3, 24e-3)


def layers(rocks=(None, SEAM, HARD), start=None, **loading) -> Scene:
    """Three layers that platens squeeze across."""
    regions = [Box(lower=(0.0, a), upper=(WIDTH, b)) for a, b in zip(LAYERS[:-1], LAYERS[1:], strict=True)]
    platens = (
        Platen(axis=1, side="lower", position=0.0, speed=5e-3),
        Platen(axis=1, side="upper", position=LAYERS[-1], speed=-5e-3),
    )
    return Scene(
        title="layers",
        domain=Domain(lower=(-4e-3, 0.0), upper=(WIDTH + 4e-3, LAYERS[-1]), dx=DX),
        bodies=tuple(Body(region=region, rock=rock) for region, rock in zip(regions, rocks, strict=True)),
        rock=LAB,
        loading=Loading(boundaries=platens, start=start or Ramp(time=1.2e-3), time_scale=16.0, width=WIDTH, **loading),
        schedule=Schedule(strain_end=6e-4, rows=100),
        output=Output(frames=2, vtu=2, movie=False),
    )
