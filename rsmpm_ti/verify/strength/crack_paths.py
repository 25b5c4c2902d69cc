"""Strain paths of cracked rock, what every law does along them, and how far that is from its closed form."""

from dataclasses import dataclass

import numpy as np

from rsmpm_ti.rock.criteria import MohrCoulomb
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.rock.smeared_crack import Directional
from rsmpm_ti.rock.softening import Brittle, ExponentialSoftening, LinearSoftening
from rsmpm_ti.rock.viscosity import NoViscosity
from rsmpm_ti.verify.strength import crack_forms as by_hand
from rsmpm_ti.verify.strength.crack_forms import BAND, COHESION, G_F_I, G_F_II, LAM, MU, TENSILE, M
from rsmpm_ti.verify.strength.material_point import follow, gradients, simple_shear, turned_by

STEP = 1e-6
"""Strain of a step; its load M STEP is 0.9 % of the tensile strength."""

PRESSURE = 5e6
"""On the closed crack that is sheared [Pa]."""

ENERGIES = {"G_f_I": G_F_I, "G_f_II": G_F_II}
SOFTENING = (Brittle(), LinearSoftening(**ENERGIES), ExponentialSoftening(**ENERGIES))
LAWS = tuple(
    Directional(softening=softening, rotating=rotating, residual_friction_angle=by_hand.RESIDUAL)
    for rotating in (False, True)
    for softening in SOFTENING
)


def label(law: Directional) -> str:
    """'fixed LinearSoftening' and the like."""
    return f"{'rotating' if law.rotating else 'fixed'} {softening_name(law)}"


def softening_name(law: Directional) -> str:
    return type(law.softening).__name__


def rock(law: Directional) -> Rock:
    criterion = MohrCoulomb(cohesion=COHESION, friction_angle=by_hand.FRICTION, tensile_strength=TENSILE)
    elasticity = Hooke(E=by_hand.E, nu=by_hand.NU)
    return Rock(density=2600.0, elasticity=elasticity, criterion=criterion, after_failure=law, viscosity=NoViscosity())


def legs(*points: tuple[float, float, float], step: float = STEP) -> np.ndarray:
    """Strains (xx, yy, xy) from zero through `points`, [steps + 1, 3], at most `step` apart in each component."""
    parts = [np.zeros((1, 3))]
    for point in points:
        start = parts[-1][-1]
        n = int(np.ceil(np.abs(np.array(point) - start).max() / step))
        parts.append(start + (np.array(point) - start) * np.arange(1, n + 1)[:, None] / n)
    return np.concatenate(parts)


CLOSED = -PRESSURE / M
WIDE = 4.2e-3
PATHS = {
    # opened, unloaded, opened further, closed to nothing and pressed, opened all the way, pressed
    "opened": legs(*((0.0, 1e-3 * e, 0.0) for e in (0.4, 0.1, 0.5, -1.0, 1e3 * WIDE, -2.5))),
    # a second crack at right angles to the first
    "pulled": legs((0.0, 6e-4, 0.0), (4.5e-4, 6e-4, 0.0)),
    # partly opened, closed, sheared to and fro
    "sheared": legs((0.0, 7e-4, 0.0), (0.0, CLOSED, 0.0), (0.0, CLOSED, 5e-3), (0.0, CLOSED, 0.0)),
    "turning": legs((0.0, 7e-4, 0.0), (0.0, CLOSED, 0.0), (0.0, CLOSED, 6e-4), (0.0, CLOSED, 0.0)),
    # free sides until Mohr-Coulomb, sheared until its cohesion is gone, oedometer, a little back
    "crushed": legs((0.26e-3, -1.6e-3, 0.0), (4.26e-3, -5.6e-3, 0.0), (4.26e-3, -9.6e-3, 0.0), (4.26e-3, -9.3e-3, 0.0)),
}
SECOND_CRACK = ("pulled", "turning")
APART = (20e-3, 20e-3, 0.0)
"""Strain at which what was crushed has come apart."""


@dataclass(frozen=True)
class Followed:
    """What one law did, by path: those of PATHS, "PATH, turned" (seen from the turned frame), "spinning", "apart"."""

    law: Directional
    sigma: dict[str, np.ndarray]  # [steps, 4], Pa
    lost: dict[str, np.ndarray]  # [steps], J/m^3
    forms: dict[str, np.ndarray]  # stress by hand, where there is a closed form


def _padded(G: np.ndarray, steps: int) -> np.ndarray:
    """A path that rests at its end."""
    return np.concatenate([G, np.zeros((steps - len(G), 2, 2))])


def followed(law: Directional) -> Followed:
    """Take the law along every path, along the same turned by 30 degrees, apart after crushing, and in a spin."""
    paths = {name: gradients(strain) for name, strain in PATHS.items()}
    paths["sheared"] = simple_shear(PATHS["sheared"])
    turned = {f"{name}, turned": turned_by(G, np.full(len(G) + 1, np.pi / 6.0)) for name, G in paths.items()}
    spin = np.linspace(0.0, 0.5 * np.pi, len(paths["sheared"]) + 1)
    paths["spinning"] = turned_by(paths["sheared"], spin)
    end = PATHS["crushed"][-1] + legs(np.array(APART) - PATHS["crushed"][-1])
    paths["apart"] = np.concatenate([paths["crushed"], gradients(end)])
    paths |= turned
    steps = max(map(len, paths.values()))
    history = follow(rock(law), BAND, np.stack([_padded(G, steps) for G in paths.values()]))
    sigma = {name: history.sigma[k, : len(G)] for k, (name, G) in enumerate(paths.items())}
    for name in turned:
        sigma[name] = seen_turned(sigma[name], np.full(len(sigma[name]), -np.pi / 6.0))
    sigma["spinning"] = seen_turned(sigma["spinning"], -spin[1:])
    lost = {name: history.lost[k, : len(G)] for k, (name, G) in enumerate(paths.items())}
    return Followed(law, sigma, lost, expected(law))


def seen_turned(sigma: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """Q sigma Q^T of stresses [steps, 4], Q by `angles` [steps]."""
    Q = np.moveaxis(np.array([[np.cos(angles), -np.sin(angles)], [np.sin(angles), np.cos(angles)]]), -1, 0)
    full = Q @ sigma[:, [0, 3, 3, 1]].reshape(-1, 2, 2) @ np.swapaxes(Q, 1, 2)
    return np.stack([full[:, 0, 0], full[:, 1, 1], sigma[:, 2], full[:, 0, 1]], axis=1)


def expected(law: Directional) -> dict[str, np.ndarray]:
    """Stress by hand on the paths of which there is a closed form for this law, [steps, 4] each."""
    name = softening_name(law)
    strain = {path: values[1:] for path, values in PATHS.items()}
    axial, opening = by_hand.across(M * strain["opened"][:, 1], name)
    lateral = LAM * (strain["opened"][:, 1] - opening)
    forms = {
        "opened": np.stack([lateral, axial, lateral, 0.0 * axial], axis=1),
        "pulled": by_hand.pulled(strain["pulled"], name),
        "crushed": by_hand.crushed(strain["crushed"], name)[0],
    }
    path = "turning" if law.rotating else "sheared"
    shear = strain[path][:, 2]
    shut = int(np.argmax(shear > 0.0))
    axial, opening = by_hand.across(M * strain[path][:shut, 1], name)
    lateral = LAM * (strain[path][:shut, 1] - opening)
    before = np.stack([lateral, axial, lateral, 0.0 * axial], axis=1)
    if law.rotating:
        after = by_hand.turning(strain[path][shut:], name)
    else:
        fraction = float(by_hand.SHARES[name](opening.max(), TENSILE, G_F_I))
        tau = by_hand.sheared(2.0 * shear[shut:], PRESSURE, fraction, name)
        after = np.tile(before[-1], (len(tau), 1))
        after[:, 3] = tau
    forms[path] = np.concatenate([before, after])
    return forms


def path_errors(one: Followed) -> dict[str, float]:
    """Largest stress error on every path with a closed form, in loads of one step, M STEP.

    A second crack loses strength in the step after its first opening: one step late is right, too, where there is one.
    """
    errors = {}
    for path, form in one.forms.items():
        error = np.abs(one.sigma[path] - form).max(axis=1)
        if path in SECOND_CRACK:
            error[1:] = np.minimum(error[1:], np.abs(one.sigma[path][1:] - form[:-1]).max(axis=1))
        errors[path] = float(error.max() / (M * STEP))
    return errors


def turned_error(one: Followed) -> float:
    """Largest change of stress over tensile strength when a path is turned by 30 degrees, as seen from that frame."""
    return max(float(np.abs(one.sigma[f"{path}, turned"] - one.sigma[path]).max()) for path in PATHS) / TENSILE


def spinning_error(one: Followed) -> tuple[float, float]:
    """(largest difference between stress in a spin of a quarter turn and at rest, what half steps of spin allow) [Pa].

    Hughes & Winget add strain of mid-step to stress turned to the end of the step: the axes of each increment are half
    a step's turn behind, 2 MU |increment| x turn of stress at most.
    """
    steps = len(one.sigma["sheared"])
    travel = np.abs(np.diff(PATHS["sheared"], axis=0)).sum()
    error = float(np.abs(one.sigma["spinning"] - one.sigma["sheared"]).max())
    return error, 2.0 * MU * travel * 0.5 * np.pi / steps


def three_principals(sigma: np.ndarray) -> np.ndarray:
    """All principal stresses of [steps, 4], [steps, 3]."""
    in_plane = np.linalg.eigvalsh(sigma[:, [0, 3, 3, 1]].reshape(-1, 2, 2))
    return np.concatenate([in_plane, sigma[:, 2:3]], axis=1)


def apart_tension(one: Followed) -> float:
    """Largest principal stress of crushed rock that was pulled apart [Pa]."""
    return float(three_principals(one.sigma["apart"][-100:]).max())
