"""Stress of cracked rock by hand, in NumPy, from total strain: nothing of it is asked of the solver.

Plane strain; strains are (xx, yy, xy), stresses (xx, yy, zz, xy), tension positive. Share laws follow Bazant & Oh
(1983), Mater. Struct. 16:155, with a crack band of width BAND.
"""

from collections.abc import Callable

import numpy as np

E, NU = 17e9, 0.14
MU, LAM = E / (2.0 * (1.0 + NU)), E * NU / ((1.0 + NU) * (1.0 - 2.0 * NU))
M = LAM + 2.0 * MU
TENSILE, COHESION, FRICTION, RESIDUAL = 2e6, 5.95e6, 40.0, 30.0
SIN, SIN_R = np.sin(np.radians([FRICTION, RESIDUAL]))
TAN_R = np.tan(np.radians(RESIDUAL))
BAND, G_F_I, G_F_II = 1e-3, 1.0, 20.0
"""Width of the crack band [m]; energies [J/m^2]. Neither snaps back: f^2 BAND/G_f is at most 0.24 of M, MU."""

SHARES: dict[str, Callable] = {
    "Brittle": lambda strain, strength, energy: np.where(strain > 0.0, 0.0, 1.0),
    "LinearSoftening": lambda strain, strength, energy: np.maximum(
        1.0 - strain * BAND * strength / (2.0 * energy), 0.0
    ),
    "ExponentialSoftening": lambda strain, strength, energy: np.exp(-strain * BAND * strength / energy),
}
"""Fraction of a strength that is left after a crack strain, by the name of the softening law."""


def root(falling: Callable, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Where falling(x) changes sign from + to -, by bisection, element by element."""
    low, high = np.broadcast_arrays(low, high)
    for _ in range(90):
        middle = 0.5 * (low + high)
        positive = falling(middle) > 0.0
        low, high = np.where(positive, middle, low), np.where(positive, high, middle)
    return 0.5 * (low + high)


def across(closed: np.ndarray, name: str) -> tuple[np.ndarray, np.ndarray]:
    """(stress, crack strain) across a crack; `closed` [steps]: what the stress would be without it.

    closed - M e = f(e) while it opens, along the secant f(k)/k below its largest crack strain k, closed below 0.
    """
    most = np.maximum.accumulate(closed)
    strain_max = root(lambda e: most - M * e - TENSILE * SHARES[name](e, TENSILE, G_F_I), 0.0 * most, most / M)
    strain_max = np.where(most >= TENSILE, strain_max, 0.0)
    left = TENSILE * SHARES[name](strain_max, TENSILE, G_F_I)
    with np.errstate(invalid="ignore"):
        secant = np.where(strain_max > 0.0, closed * strain_max / (M * strain_max + left), 0.0)
    crack_strain = np.clip(secant, 0.0, strain_max)
    return closed - M * crack_strain, crack_strain


def pulled(strain: np.ndarray, name: str) -> np.ndarray:
    """Stress [steps, 4] under strains (0, yy, 0), then xx as well: one crack across y, a second across x.

    The first is open whenever the second opens. What they carry depends on each other by Poisson's ratio only.
    """
    xx = yy = np.zeros(len(strain))
    crack_strain = [0.0 * xx, 0.0 * xx]
    for _ in range(40):  # (LAM/M)^2 of the error is left by each turn
        yy, crack_strain[1] = across(M * strain[:, 1] + LAM * (strain[:, 0] - crack_strain[0]), name)
        xx, crack_strain[0] = across(M * strain[:, 0] + LAM * (strain[:, 1] - crack_strain[1]), name)
    zz = LAM * (strain[:, 0] + strain[:, 1] - crack_strain[0] - crack_strain[1])
    return np.stack([xx, yy, zz, 0.0 * xx], axis=1)


def friction_limit(slip: np.ndarray, pressure: float, fraction: float, name: str) -> np.ndarray:
    """Largest shear on a closed crack: tau^2 = (c + p tan phi_r)^2 - (c - f tan phi_r)^2, Carol et al. (1997), eq. 3.

    c and f have lost the larger fraction of what opening (`fraction` is left) and slip have cost them.
    """
    left = np.minimum(fraction, SHARES[name](slip, COHESION, G_F_II))
    c, f = COHESION * left, TENSILE * left
    return np.sqrt((c + pressure * TAN_R) ** 2 - (c - f * TAN_R) ** 2)


def sheared(shear: np.ndarray, pressure: float, fraction: float, name: str) -> np.ndarray:
    """Shear stress [steps] on a fixed closed crack under engineering shear that rises to its largest and comes back."""

    def leg(gamma, tau, slip):
        """From (tau, slip) on, by a further shear gamma >= 0: elastic, or sliding at its limit."""

        def excess(more):
            return tau + MU * (gamma - more) - friction_limit(slip + more, pressure, fraction, name)

        more = np.where(excess(0.0 * gamma) > 0.0, root(excess, 0.0 * gamma, gamma + abs(tau) / MU), 0.0)
        return tau + MU * (gamma - more), slip + more

    turn = int(np.argmax(shear)) + 1
    there, slip = leg(shear[:turn], 0.0, 0.0)
    back, _ = leg(shear[turn - 1] - shear[turn:], -there[-1], slip[-1])
    return np.concatenate([there, -back])


def turning(strain: np.ndarray, name: str) -> np.ndarray:
    """Stress [steps, 4] of rock with a closed crack that turns with the principal axes: the larger principal stress
    opens a new one, at right angles to the old, at the tensile strength."""
    full = strain[:, [0, 2, 2, 1]].reshape(-1, 2, 2)
    value, axes = np.linalg.eigh(full)
    large, crack_strain = across(M * value[:, 1] + LAM * value[:, 0], name)
    small, zz = M * value[:, 0] + LAM * (value[:, 1] - crack_strain), LAM * (value.sum(axis=1) - crack_strain)
    sigma = np.einsum("nia,na,nja->nij", axes, np.stack([small, large], axis=1), axes)
    return np.stack([sigma[:, 0, 0], sigma[:, 1, 1], zz, sigma[:, 0, 1]], axis=1)


def crushed(strain: np.ndarray, name: str) -> tuple[np.ndarray, int]:
    """(stress [steps, 4], step of failure) of rock that fails in shear under strains (xx, yy, 0), pressed most along y.

    Two slips at constant volume, of x and of z against y, each with Coulomb's condition on its two stresses: those of
    what slips touch the envelope, the other is within it. c is what the slip of the step before has left, and phi
    between residual and full by the same share.
    """
    trace = LAM * (strain[:, 0] + strain[:, 1])
    elastic = np.stack([trace + 2.0 * MU * strain[:, 0], trace + 2.0 * MU * strain[:, 1], trace])
    stress, slips, first = elastic.copy(), np.zeros(2), len(strain)
    for k in range(len(strain)):
        x, y, z = elastic[:, k] + MU * np.array([-slips[0], slips.sum(), -slips[1]])
        if k < first:
            if 0.5 * (x - y) + 0.5 * (x + y) * SIN < COHESION * np.sqrt(1.0 - SIN**2):
                continue
            first = k
        fraction = float(SHARES[name](max(slips.sum(), 1e-12), COHESION, G_F_II))
        sin = SIN_R + (SIN - SIN_R) * fraction
        c_cos = fraction * COHESION * np.sqrt(1.0 - sin**2)
        excess = np.array([0.5 * (other - y) + 0.5 * (other + y) * sin - c_cos for other in (x, z)])
        cross = 0.5 * (1.0 - sin)
        both = (excess - cross * excess[::-1]) / (MU * (1.0 - cross**2))
        alone = np.maximum(excess, 0.0) / MU
        if both.min() < 0.0:  # one slips alone, if any
            more = np.where(excess == excess.max(), alone, 0.0)
        else:
            more = both
        slips += more
        stress[:, k] = x - MU * more[0], y + MU * more.sum(), z - MU * more[1]
    return np.stack([*stress, 0.0 * stress[0]], axis=1), first
