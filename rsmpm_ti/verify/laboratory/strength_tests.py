"""The plainest tests of a laboratory, by the scene that ships: strength of intact rock, without and with a jacket.

An intact specimen between smooth platens is strained uniformly, so that Mohr-Coulomb's line is what the load must show
at the first failure: sigma_1 = UCS + N_phi p, UCS = 2 c cos(phi)/(1 - sin(phi)), N_phi = tan^2(45 + phi/2) (Jaeger,
Cook & Zimmerman 2007, sec. 4.5). With sigma_zz = -p - nu q out of the plane (case `triaxial`) it lies between the
others. Nothing is replaced but the rock, the pressure and, to find out what they do, cells and functions.
"""

import math
from dataclasses import replace

from rsmpm_ti import load_scene, simulate
from rsmpm_ti.cases.case import Case, Outcome, Row, relative
from rsmpm_ti.method.shape import Gimp, Linear, QuadraticBSpline
from rsmpm_ti.method.transfer import Apic, PicFlip
from rsmpm_ti.rock.criteria import MohrCoulomb
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.spec.scene import Scene


def rock_of(*, density: float, E: float, nu: float, cohesion: float, phi: float, tension: float) -> Rock:
    criterion = MohrCoulomb(cohesion=cohesion, friction_angle=phi, tensile_strength=tension)
    return Rock(density=density, elasticity=Hooke(E=E, nu=nu), criterion=criterion)


ROCKS = {
    "mudstone": rock_of(density=2200.0, E=2e9, nu=0.3, cohesion=1.4434e6, phi=30.0, tension=0.4e6),
    "paper": rock_of(density=2600.0, E=17e9, nu=0.14, cohesion=5.95e6, phi=40.0, tension=2e6),
    "granite": rock_of(density=2650.0, E=55e9, nu=0.22, cohesion=27.55e6, phi=52.0, tension=9e6),
    "quartzite": rock_of(density=2650.0, E=80e9, nu=0.25, cohesion=47.28e6, phi=55.0, tension=15e6),
}
"""From 5 to 300 MPa."""

MESHES = {  # by name: dx [m], shape functions, transfer
    "dx 2 mm": (2e-3, QuadraticBSpline(), PicFlip()),
    "dx 1 mm": (1e-3, QuadraticBSpline(), PicFlip()),
    "dx 0.5 mm": (0.5e-3, QuadraticBSpline(), PicFlip()),
    "GIMP": (2e-3, Gimp(), PicFlip()),
    "linear": (2e-3, Linear(), PicFlip()),
    "APIC": (2e-3, QuadraticBSpline(), Apic()),
    "GIMP, APIC": (2e-3, Gimp(), Apic()),
    "linear, APIC": (2e-3, Linear(), Apic()),
}

PRESSURES = (0.0, 10e6, 20e6, 40e6)
"""Of the jacket [Pa]."""


def strength(rock: Rock, pressure: float = 0.0) -> float:
    """Axial stress at failure by Mohr-Coulomb, compression positive [Pa]."""
    phi = math.radians(rock.criterion.friction_angle)
    ucs = 2.0 * rock.criterion.cohesion * math.cos(phi) / (1.0 - math.sin(phi))
    return ucs + math.tan(math.radians(45.0) + 0.5 * phi) ** 2 * pressure


def specimen(rock: Rock, *, mesh: str = "dx 2 mm", pressure: float = 0.0) -> Scene:
    """The scene `intact`, of another rock, to 1.1 times the strain at which it fails."""
    dx, shape, transfer = MESHES[mesh]
    elasticity = rock.elasticity
    strain = 1.1 * (strength(rock, pressure) - pressure) * (1.0 - elasticity.nu**2) / elasticity.E
    scene = load_scene("intact", dx=dx, strain_end=strain)
    cfl = min(scene.schedule.cfl, 0.5 * (shape.affine_cfl if transfer.affine else shape.stable_cfl))
    return replace(
        scene, rock=rock, shape=shape, transfer=transfer, loading=replace(scene.loading, confinement=pressure),
        schedule=replace(scene.schedule, cfl=cfl),
    )  # fmt: skip


def _row(name: str, scene: Scene, expected: float, tolerance: float, why: str) -> Row:
    summary = simulate(scene).summary
    found = summary["first_failure_stress_Pa"]
    if any("no strength" in sentence for sentence in summary["warnings"]):
        why = f"{why}; the run says that it is no strength"
        found = None
    return relative(f"{name} [Pa]", expected, math.nan if found is None else found, tolerance, why)


SWINGS = "inertia of the test as it ships (time_scale 10), and a load over the width that it had at the start"


def ucs(full: bool) -> Outcome:
    """Every rock, every mesh. quick: a granite."""
    wanted = [("granite", "dx 2 mm")]
    if full:
        wanted = [(rock, mesh) for rock in ("paper", "granite", "quartzite") for mesh in MESHES]
        wanted += [("mudstone", "dx 2 mm")]
    rows = [
        _row(f"{rock}, {mesh}", specimen(ROCKS[rock], mesh=mesh), strength(ROCKS[rock]), 0.01, SWINGS)
        for rock, mesh in wanted
    ]
    return Outcome(tuple(rows), _draw(rows))


def jacketed(full: bool) -> Outcome:
    """Strength under pressure. quick: one."""
    wanted = [("paper", p) for p in (PRESSURES if full else PRESSURES[1:2])]
    wanted += [("granite", p) for p in PRESSURES[1:]] * full
    rows = [
        _row(f"{rock}, p = {1e-6 * p:g} MPa", specimen(ROCKS[rock], pressure=p), strength(ROCKS[rock], p), 0.02, SWINGS)
        for rock, p in wanted
    ]
    return Outcome(tuple(rows), _draw(rows))


def _draw(rows: list[Row]):
    def draw(figure):
        axes = figure.subplots()
        for k, row in enumerate(rows):
            axes.barh(k, 100.0 * row.error, color="tab:blue" if row.passed else "tab:red")
            axes.plot([-100.0 * row.tolerance, 100.0 * row.tolerance], [k, k], "k|", markersize=12)
        axes.set_yticks(range(len(rows)), [row.quantity for row in rows])
        axes.set(xlabel="first failure against Mohr-Coulomb [%]", title="intact rock between smooth platens")
        axes.axvline(0.0, color="k", linewidth=0.8)

    return draw


CASES = (
    Case("lab_ucs", "uniaxial strength of intact rock from 5 to 300 MPa, by the scene that ships", ucs),
    Case("lab_triaxial", "strength of intact rock in a jacket, by the scene that ships", jacketed),
)
