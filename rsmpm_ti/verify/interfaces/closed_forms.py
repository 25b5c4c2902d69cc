"""Elastic fields of two rocks that are bonded, in plane strain: docs/references.md, section "Several rocks"."""

from dataclasses import dataclass

import numpy as np

from rsmpm_ti.rock.elasticity import Hooke


def across_layers(rocks: tuple[Hooke, ...], fractions: tuple[float, ...]) -> float:
    """Stress over strain across layers, sides held [Pa]: C of Backus (1962), J. Geophys. Res. 67:4427, eq. 13."""
    return 1.0 / sum(f / (rock.lam + 2.0 * rock.mu) for rock, f in zip(rocks, fractions, strict=True))


def along_layers(rocks: tuple[Hooke, ...], fractions: tuple[float, ...]) -> float:
    """The same along layers [Pa]: A of Backus (1962), eq. 13."""
    pairs = [(f, rock.lam, rock.lam + 2.0 * rock.mu, rock.mu) for rock, f in zip(rocks, fractions, strict=True)]
    plates = sum(f * 4.0 * mu * (lam + mu) / wave for f, lam, wave, mu in pairs)
    return plates + across_layers(rocks, fractions) * sum(f * lam / wave for f, lam, wave, _ in pairs) ** 2


def along_free_layers(rocks: tuple[Hooke, ...], fractions: tuple[float, ...]) -> float:
    """Stress over strain along layers whose sides are free [Pa]: the mean of E/(1 - nu^2)."""
    return sum(f * rock.E / (1.0 - rock.nu**2) for rock, f in zip(rocks, fractions, strict=True))


@dataclass(frozen=True, kw_only=True)
class RoundInclusion:
    """A disc of another rock in an infinite body that a stress s pulls along y. Goodier (1933), J. Appl. Mech. 1:39.

    Its own stress is uniform. With kappa = 3 - 4 nu, and i the inclusion, m the rock around it,

        s_xx + s_yy = s mu_i (1 + kappa_m)/(2 mu_i + mu_m (kappa_i - 1)),
        s_yy - s_xx = s mu_i (1 + kappa_m)/(mu_m + mu_i kappa_m).

    Around it phi = G z + A/z and psi = H z + B/z + C/z^3 of Muskhelishvili (1953), sec. 41, whose tractions on the
    circle are those of the inclusion.
    """

    inside: Hooke
    around: Hooke
    radius: float

    @property
    def _sums(self) -> tuple[float, float]:
        """s_xx + s_yy and s_yy - s_xx of the inclusion, over s."""
        mu_i, mu_m = self.inside.mu, self.around.mu
        kappa_i, kappa_m = (3.0 - 4.0 * rock.nu for rock in (self.inside, self.around))
        both = mu_i * (1.0 + kappa_m)
        return both / (2.0 * mu_i + mu_m * (kappa_i - 1.0)), both / (mu_m + mu_i * kappa_m)

    @property
    def stress(self) -> tuple[float, float]:
        """s_xx and s_yy of the inclusion, over s."""
        mean, difference = self._sums
        return 0.5 * (mean - difference), 0.5 * (mean + difference)

    def stress_around(self, x: np.ndarray) -> np.ndarray:
        """Stress [n, 2, 2] over s at x [n, 2] outside the inclusion, whose centre is the origin."""
        z, mean, difference = x[:, 0] + 1j * x[:, 1], *self._sums
        G, H = 0.25, 0.5
        A = (0.5 * difference - H) * self.radius**2
        B, C = 2.0 * (0.25 * mean - G) * self.radius**2, A * self.radius**2
        first, second = G - A / z**2, 2.0 * A / z**3
        psi = H - B / z**2 - 3.0 * C / z**4
        total, turned = 4.0 * first.real, 2.0 * (np.conj(z) * second + psi)
        sigma = np.empty((len(x), 2, 2))
        sigma[:, 0, 0], sigma[:, 1, 1] = 0.5 * (total - turned.real), 0.5 * (total + turned.real)
        sigma[:, 0, 1] = sigma[:, 1, 0] = 0.5 * turned.imag
        return sigma
