"""Manufactured solutions for Hooke's law with the Jaumann rate: a motion, its exact stress, the body force it needs.

In each, x = X + u(X, t) is prescribed, the stress follows from the law along the path of a particle, and the body
force is what momentum then lacks: b = a - div(sigma)/rho [m/s^2]. Places X [n, 2] are initial positions [m]; stress
is Cauchy, [n, 3, 3], tension positive. Ideas: Wallstedt & Guilkey (2008), J. Comput. Phys. 227:9628 (axis-aligned);
Kamojjala et al. (2015), Engineering with Computers 31:193 (vortex). Their solids are neo-Hookean; this one is not.
"""

import math
from dataclasses import dataclass

import numpy as np
import taichi as ti

from rsmpm_ti.rock.elasticity import Hooke


def _packed(xx, yy, zz, xy) -> np.ndarray:
    """[n, 3, 3] from in-plane components and zz."""
    o = np.zeros_like(xx)
    return np.stack([xx, xy, o, xy, yy, o, o, o, zz], axis=1).reshape(-1, 3, 3)


@ti.data_oriented
@dataclass(frozen=True, kw_only=True)
class AxisAligned:
    """x = X + A sin(pi X) sin(w t), y = Y + A sin(pi Y) sin(w t) on the unit square, plane strain.

    There is no spin, so that the strain is logarithmic: sigma_xx = lambda ln J + 2 mu ln F_xx, sigma_yy likewise,
    sigma_zz = lambda ln J, with F_xx = 1 + A pi cos(pi X) sin(w t).
    amplitude A [m], angular_frequency w [rad/s], density [kg/m^3] of the start.
    """

    amplitude: float
    angular_frequency: float
    elasticity: Hooke
    density: float

    def displacement(self, X: np.ndarray, t: float) -> np.ndarray:
        return self.amplitude * np.sin(math.pi * X) * math.sin(self.angular_frequency * t)

    def velocity(self, X: np.ndarray, t: float) -> np.ndarray:
        w = self.angular_frequency
        return self.amplitude * w * np.sin(math.pi * X) * math.cos(w * t)

    def stress(self, X: np.ndarray, t: float) -> np.ndarray:
        lam, mu = self.elasticity.lam, self.elasticity.mu
        stretch = 1.0 + self.amplitude * math.pi * np.cos(math.pi * X) * math.sin(self.angular_frequency * t)
        xx, yy = np.log(stretch).T
        zz = lam * (xx + yy)
        return _packed(zz + 2.0 * mu * xx, zz + 2.0 * mu * yy, zz, 0.0 * zz)

    @ti.func
    def acceleration(self, X, t):
        """b_x = -A w^2 sin(pi X) sin(w t) - (J/rho0) (lambda + 2 mu) F_xx,X / F_xx^2, b_y likewise."""
        A, w = ti.static(self.amplitude, self.angular_frequency)
        stiffness = ti.static(self.elasticity.p_wave_modulus / self.density)
        wave = A * ti.sin(w * t) * ti.sin(math.pi * X)
        stretch = 1.0 + math.pi * A * ti.sin(w * t) * ti.cos(math.pi * X)
        J = stretch[0] * stretch[1]
        return -(w**2) * wave + J * stiffness * math.pi**2 * wave / stretch**2


@ti.data_oriented
@dataclass(frozen=True, kw_only=True)
class Vortex:
    """Every circle turns by its own angle alpha(R, t) = A sin(w t) (1 - 32 (R - 1)^2 + 256 (R - 1)^4), 3/4 < R < 5/4.

    Isochoric; both edges stand still and carry no traction. With g = R dalpha/dR, in the basis of the turned radius,
    sigma_rt = mu sin(g), sigma_tt = -sigma_rr = mu (1 - cos(g)), sigma_zz = 0: simple shear by g under the Jaumann
    rate, Dienes (1979), Acta Mech. 32:217. Beyond g = pi/2 (A = 0.22) the law softens.
    amplitude A [rad, and m, since it is the largest displacement at R = 1], angular_frequency w [rad/s].
    """

    amplitude: float
    angular_frequency: float
    elasticity: Hooke
    density: float

    def displacement(self, X: np.ndarray, t: float) -> np.ndarray:
        return self._turned(X, self._angle(X, math.sin(self.angular_frequency * t))) - X

    def velocity(self, X: np.ndarray, t: float) -> np.ndarray:
        w = self.angular_frequency
        x, rate = X + self.displacement(X, t), self._angle(X, w * math.cos(w * t))
        return rate[:, None] * np.stack([-x[:, 1], x[:, 0]], axis=1)

    def stress(self, X: np.ndarray, t: float) -> np.ndarray:
        mu, s = self.elasticity.mu, np.linalg.norm(X, axis=1) - 1.0
        factor = self.amplitude * math.sin(self.angular_frequency * t)
        g = factor * (1.0 + s) * (-64.0 * s + 1024.0 * s**3)
        tt, rt = mu * (1.0 - np.cos(g)), mu * np.sin(g)
        c, d = ((X + self.displacement(X, t)) / (1.0 + s)[:, None]).T  # cos and sin of the turned radius
        cos_2, sin_2 = c * c - d * d, 2.0 * c * d
        xx = -tt * cos_2 - rt * sin_2
        return _packed(xx, -xx, 0.0 * xx, -tt * sin_2 + rt * cos_2)

    def _angle(self, X: np.ndarray, factor: float) -> np.ndarray:
        s = np.linalg.norm(X, axis=1) - 1.0
        return self.amplitude * factor * (1.0 - 32.0 * s**2 + 256.0 * s**4)

    def _turned(self, X: np.ndarray, angle: np.ndarray) -> np.ndarray:
        c, s = np.cos(angle), np.sin(angle)
        return np.stack([c * X[:, 0] - s * X[:, 1], s * X[:, 0] + c * X[:, 1]], axis=1)

    @ti.func
    def acceleration(self, X, t):
        """b_r = -R alpha_t^2 - [d sigma_rr/dR + (sigma_rr - sigma_tt)/R]/rho,
        b_t = R alpha_tt - [d sigma_rt/dR + 2 sigma_rt/R]/rho, along the turned radius and across it; r = R."""
        A, w, stiffness = ti.static(self.amplitude, self.angular_frequency, self.elasticity.mu / self.density)
        R = X.norm()
        s = R - 1.0
        shape = A * (1.0 - 32.0 * s**2 + 256.0 * s**4)
        slope, curvature = A * (-64.0 * s + 1024.0 * s**3), A * (-64.0 + 3072.0 * s**2)
        now = ti.sin(w * t)
        rate = shape * w * ti.cos(w * t)
        g, dg = R * slope * now, (slope + R * curvature) * now
        b_r = -R * rate**2 + stiffness * (ti.sin(g) * dg + 2.0 * (1.0 - ti.cos(g)) / R)
        b_t = -R * shape * w**2 * now - stiffness * (ti.cos(g) * dg + 2.0 * ti.sin(g) / R)
        c, d = ti.cos(shape * now), ti.sin(shape * now)
        e_r = ti.Vector([c * X[0] - d * X[1], d * X[0] + c * X[1]]) / R
        return b_r * e_r + b_t * ti.Vector([-e_r[1], e_r[0]])
