"""Random strain paths for one particle, and the laws of broken rock that are taken along them."""

import numpy as np

from rsmpm_ti.rock.smeared_crack import Directional
from rsmpm_ti.rock.softening import Brittle, LinearSoftening
from rsmpm_ti.verify.strength import crack_paths
from rsmpm_ti.verify.strength.crack_forms import RESIDUAL

LAWS = (
    *crack_paths.LAWS,
    Directional(softening=LinearSoftening(**crack_paths.ENERGIES), dilation_angle=20.0, dilation_slip=1e-3),
    Directional(softening=Brittle(), dilation_angle=RESIDUAL, dilation_slip=1.0),
)
LABELS = [f"{crack_paths.label(law)}, psi {law.dilation_angle:g}" for law in LAWS]


def random_legs(paths: int, legs: int, size: float, seed: int) -> np.ndarray:
    """Velocity gradients times the time of their leg, [paths, legs, 2, 2]: from a hundredth of `size` to all of it."""
    rng = np.random.default_rng(seed)
    return rng.normal(size=(paths, legs, 2, 2)) * size * 10.0 ** rng.uniform(-2.0, 0.0, size=(paths, legs, 1, 1))


def refined(legs: np.ndarray, parts: int) -> np.ndarray:
    """Displacement gradients of every leg in equal parts, [paths, legs x parts, 2, 2]: exp(L/parts) - 1."""
    part, term, total = legs / parts, np.broadcast_to(np.eye(2), legs.shape), np.zeros(legs.shape)
    for k in range(1, 14):
        term = term @ part / k
        total = total + term
    return np.repeat(total, parts, axis=1)
