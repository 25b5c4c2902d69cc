"""A slit across the pull: its faces carry nothing, and it opens at least as far as a crack of no width."""

from dataclasses import dataclass, replace

import numpy as np

from rsmpm_ti import load_scene
from rsmpm_ti.cases.case import Case, Outcome, Row, at_least, at_most
from rsmpm_ti.cases.static_state import static_state
from rsmpm_ti.errors import SceneError
from rsmpm_ti.method.shape import Gimp, Linear, QuadraticBSpline
from rsmpm_ti.setups.uniaxial import uniaxial_test
from rsmpm_ti.spec.regions import Slit
from rsmpm_ti.spec.scene import Scene
from rsmpm_ti.verify.elastic.slit_field import PLANE_STRAIN_MODULUS

SIDE, HALF = 80e-3, 10e-3
"""Edge of the square plate and half the length of its slit [m]."""

WIDTHS = (2.0, 2.5, 3.0, 3.5, 4.0)
"""Of the slit [cells], from a width on at which the nodes between its faces have hardly any mass. The narrowest that
the separation check lets pass is pulled."""

OPENS = 1.03
"""Opening of a central crack of a quarter of the width over 4 sigma a/E', what it is in an infinite plate:

Tada, Paris & Irwin (2000), The Stress Analysis of Cracks Handbook, 2.1: -0.071 - 0.535 r + 0.169 r^2 + 0.020 r^3
- 1.071 ln(1 - r)/r = 1.04 at r = 1/4, of a long plate; platens that stay plane hold a square one back by 1 %.
"""


def pulled(dx: float, shape, axis: int) -> Scene:
    """The plate with the narrowest slit that is let pass, pulled along an axis."""
    for cells in WIDTHS:
        flaw = Slit(centre=(0.5 * SIDE, 0.5 * SIDE), length=2.0 * HALF, width=cells * dx, angle=90.0 * (1 - axis))
        scene = uniaxial_test(
            title="Slit across the pull", rock=load_scene("intact").rock, dx=dx, width=SIDE, height=SIDE,
            flaws=(flaw,), speed=-2.5e-3, strain_end=-1e-4,
        )  # fmt: skip
        scene = replace(scene if axis == 1 else along_x(scene), shape=shape)
        try:
            scene.particles()
        except SceneError:
            continue
        return scene
    raise SceneError(f"no slit of up to {WIDTHS[-1]:g} cells is let pass")


def along_x(scene: Scene) -> Scene:
    """A square plate's test along y, about its diagonal; its flaws are turned by who made them."""
    boundaries = tuple(replace(platen, axis=0) for platen in scene.loading.boundaries)
    lower, upper = scene.domain.lower, scene.domain.upper
    domain = replace(scene.domain, lower=lower[::-1], upper=upper[::-1])
    return replace(scene, domain=domain, loading=replace(scene.loading, boundaries=boundaries))


@dataclass(frozen=True)
class _Opened:
    """Where along the slit [m], and how far each face has moved apart there over sigma/E' [m]."""

    name: str
    rows: tuple[Row, ...]
    along: np.ndarray
    opening: np.ndarray


def _opened(dx: float, shape, axis: int) -> _Opened:
    scene = pulled(dx, shape, axis)
    state = static_state(scene)
    x, u = state.snapshot.x - state.snapshot.displacement, state.snapshot.displacement
    (slit,) = scene.bodies[0].region.removed
    along, across = slit.frame(x).T
    pull = -state.nominal
    face = (np.abs(along) < HALF) & (np.abs(across) < 0.5 * slit.width + 0.5 * dx)
    beside = face & (np.abs(along) < 0.5 * HALF)
    columns, which = np.unique(np.round(along[face] / (0.5 * dx) - 0.5), return_inverse=True)
    sides = [
        np.bincount(which[up], u[face][up, axis]) / np.bincount(which[up])
        for up in (x[face, axis] > 0.5 * SIDE, x[face, axis] < 0.5 * SIDE)
    ]
    opening = (sides[0] - sides[1]) * PLANE_STRAIN_MODULUS / pull
    stress = float(np.abs(state.sigma[beside, axis, axis]).max() / pull)
    at = f"{type(shape).__name__}, dx {1e3 * dx:g} mm, pulled along {'xy'[axis]}"
    why = "stress dies off over a crack's length: half a cell inside its face, (dx/2a)^2, less than 1 %; 2 % of waves"
    rows = [at_most(f"{at}: stress of the faces over the nominal", stress, 0.03, why)]
    why = "4 sigma a/E' of a sharp crack, and 3 % as the plate is finite; a slit of some width opens farther"
    middle = opening[np.abs(columns) < 2.0].mean() / (4.0 * HALF)
    rows.append(at_least(f"{at}: opening of the middle over 4 sigma a/E'", float(middle), OPENS, why))
    return _Opened(at, tuple(rows), (columns + 0.5) * 0.5 * dx, opening)


def open_slit(full: bool) -> Outcome:
    """B-splines at 1 mm; in full also along x, at 0.5 mm, and the other functions."""
    spline = QuadraticBSpline()
    runs = [(1e-3, spline, 1), (1e-3, spline, 0), (0.5e-3, spline, 1), (1e-3, Gimp(), 1), (1e-3, Linear(), 1)]
    opened = [_opened(*one) for one in runs[: len(runs) if full else 1]]

    def draw(figure):
        axes = figure.subplots()
        for one in opened:
            axes.plot(1e3 * one.along, 1e3 * one.opening, ".", markersize=4, label=one.name)
        x = np.linspace(-HALF, HALF, 201)
        axes.plot(1e3 * x, 4e3 * np.sqrt(HALF**2 - x**2), "k-", linewidth=0.9, label="sharp crack, infinite plate")
        axes.set(xlabel="along the slit [mm]", ylabel="opening E'/sigma [mm]", title="Slit across the pull")
        axes.legend()

    return Outcome(tuple(row for one in opened for row in one.rows), draw)


CASES = (Case("open_slit", "the narrowest slit that is let pass: stress of its faces and opening", open_slit),)
