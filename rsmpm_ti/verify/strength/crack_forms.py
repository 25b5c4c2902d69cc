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
    """(stress [steps, 4], step of failure) of rock that fails in shear under strains (xx, yy, 0) with yy < xx.

    The mean in-plane stress stays elastic; half the difference is at most c cos(phi) - mean sin(phi) with what slip has
    left of c, and phi between residual and full by the same share; sigma_zz is brought back within the envelope.
    """
    mean, half = (LAM + MU) * (strain[:, 0] + strain[:, 1]), MU * (strain[:, 0] - strain[:, 1])
    first = int(np.argmax(half + mean * SIN >= COHESION * np.sqrt(1.0 - SIN**2)))
    failed = np.arange(len(strain)) >= first

    def envelope(slip):
        fraction = SHARES[name](np.maximum(slip, 1e-12), COHESION, G_F_II)  # failed: something has slipped
        sin = SIN_R + (SIN - SIN_R) * fraction
        return sin, fraction * COHESION * np.sqrt(1.0 - sin**2)

    def excess(slip):
        sin, c_cos = envelope(slip)
        return half - MU * slip - np.maximum(c_cos - mean * sin, 0.0)

    slip = np.where(failed & (excess(0.0 * half) > 0.0), root(excess, 0.0 * half, np.maximum(half / MU, 0.0)), 0.0)
    slip = np.maximum.accumulate(slip)
    radius = half - MU * slip
    sin, c_cos = envelope(slip)
    flow, strength = (1.0 + sin) / (1.0 - sin), 2.0 * c_cos / (1.0 - sin)
    zz, now = np.zeros(len(strain)), 0.0
    for k, step in enumerate(np.diff(strain[:, 0] + strain[:, 1], prepend=0.0)):
        now += LAM * step
        if failed[k]:
            low, high = mean[k] - radius[k], mean[k] + radius[k]
            now = np.clip(now, flow[k] * high - strength[k], (low + strength[k]) / flow[k])
        zz[k] = now
    return np.stack([mean + radius, mean - radius, zz, 0.0 * zz], axis=1), first
