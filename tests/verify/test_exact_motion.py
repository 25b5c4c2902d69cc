"""Manufactured solutions against their own definition: velocity, the Jaumann law along a path, momentum."""

import numpy as np
import pytest
import taichi as ti
from exact import lame
from harness import name_of, on_rows, vector

from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.verify.elastic.exact_motion import AxisAligned, Vortex

E, NU, RHO, OMEGA = 1e6, 0.3, 1000.0, 150.0
LAMBDA, MU = lame(E, NU)
MATERIAL = dict(angular_frequency=OMEGA, elasticity=Hooke(E=E, nu=NU), density=RHO)
MOTIONS = [AxisAligned(amplitude=0.05, **MATERIAL), Vortex(amplitude=0.05, **MATERIAL)]
T = 0.8 / OMEGA
"""A time when displacement, velocity and acceleration are all of their full order."""

each_motion = pytest.mark.parametrize("motion", MOTIONS, ids=name_of)


def positions(motion, count: int = 40) -> np.ndarray:
    """Random initial positions inside the body, [count, 2]."""
    rng = np.random.default_rng(3)
    if isinstance(motion, AxisAligned):
        return rng.uniform(0.05, 0.95, (count, 2))
    R, angle = rng.uniform(0.78, 1.22, count), rng.uniform(0.0, 2.0 * np.pi, count)
    return np.stack([R * np.cos(angle), R * np.sin(angle)], axis=1)


def slopes(function, X: np.ndarray, step: float = 1e-3) -> np.ndarray:
    """d function / dX by central differences of fourth order; the derivative is the last axis."""
    columns = []
    for e in step * np.eye(2):
        near, far = function(X + e) - function(X - e), function(X + 2.0 * e) - function(X - 2.0 * e)
        columns.append((8.0 * near - far) / (12.0 * step))
    return np.stack(columns, axis=-1)


def gradient(motion, X: np.ndarray, t: float) -> np.ndarray:
    """F = dx/dX, [n, 2, 2]."""
    return np.eye(2) + slopes(lambda X: motion.displacement(X, t), X)


def stress_rate(motion, X: np.ndarray, sigma: np.ndarray, t: float) -> np.ndarray:
    """W sigma - sigma W + lambda tr(D) 1 + 2 mu D, the Jaumann law in 3D with D and W of the motion's velocity."""
    L = np.zeros((len(X), 3, 3))
    L[:, :2, :2] = slopes(lambda X: motion.velocity(X, t), X) @ np.linalg.inv(gradient(motion, X, t))
    D, W = 0.5 * (L + L.transpose(0, 2, 1)), 0.5 * (L - L.transpose(0, 2, 1))
    volumetric = LAMBDA * np.trace(D, axis1=1, axis2=2)[:, None, None] * np.eye(3)
    return W @ sigma - sigma @ W + volumetric + 2.0 * MU * D


@each_motion
def test_velocity_is_the_rate_of_displacement(motion):
    X, dt = positions(motion), 1e-4 * T
    rate = (motion.displacement(X, T + dt) - motion.displacement(X, T - dt)) / (2.0 * dt)
    np.testing.assert_allclose(motion.velocity(X, T), rate, atol=1e-7 * np.abs(rate).max())


@each_motion
def test_stress_follows_the_law_along_a_path(motion):
    """Runge-Kutta integration of the law from the stress-free start."""
    X, steps = positions(motion, 10), 20
    sigma, dt = np.zeros((len(X), 3, 3)), T / steps
    for k in range(steps):
        t = k * dt
        k1 = stress_rate(motion, X, sigma, t)
        k2 = stress_rate(motion, X, sigma + 0.5 * dt * k1, t + 0.5 * dt)
        k3 = stress_rate(motion, X, sigma + 0.5 * dt * k2, t + 0.5 * dt)
        k4 = stress_rate(motion, X, sigma + dt * k3, t + dt)
        sigma = sigma + dt / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    exact = motion.stress(X, T)
    np.testing.assert_allclose(sigma, exact, rtol=0.0, atol=1e-6 * np.abs(exact).max())


@pytest.mark.usefixtures("taichi_f64")
@each_motion
def test_force_field_is_what_momentum_lacks(motion):
    """b = a - J div(sigma)/rho_0 by finite differences of displacement and stress, against the kernel's function."""
    X, dt = positions(motion), 1e-3 * T
    x = [motion.displacement(X, T + k * dt) for k in (-1, 0, 1)]
    inertia = (x[0] - 2.0 * x[1] + x[2]) / dt**2
    F = gradient(motion, X, T)
    by_X = slopes(lambda X: motion.stress(X, T)[:, :2, :2], X)
    divergence = np.einsum("nabC,nCb->na", by_X, np.linalg.inv(F))
    elastic = np.linalg.det(F)[:, None] * divergence / RHO

    @ti.func
    def acceleration(a: ti.template(), p):
        return motion.acceleration(vector(a, p, 0, 2), a[p, 2])

    b = on_rows(acceleration, np.column_stack([X, np.full(len(X), T)]), 2)
    assert min(np.abs(inertia).max(), np.abs(elastic).max()) > 0.1 * np.abs(b).max(), "both terms must count"
    np.testing.assert_allclose(b, inertia - elastic, rtol=0.0, atol=1e-5 * np.abs(elastic).max())


@each_motion
def test_boundaries_need_nothing_but_walls_or_nothing_at_all(motion):
    """Walls hold the square's sides and bear no shear; the annulus's edges bear no traction and stand still."""
    s = np.linspace(0.0, 1.0, 11)
    if isinstance(motion, AxisAligned):
        for side in (0.0, 1.0):
            X = np.stack([np.full(11, side), s], axis=1)
            assert np.abs(motion.displacement(X, T)[:, 0]).max() < 1e-15
            assert np.abs(motion.stress(X, T)[:, 0, 1]).max() == 0.0
        return
    angle = 2.0 * np.pi * s
    normal = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    for R in (0.75, 1.25):
        traction = np.einsum("nab,nb->na", motion.stress(R * normal, T)[:, :2, :2], normal)
        assert np.abs(traction).max() < 1e-12 * MU
        assert np.abs(motion.displacement(R * normal, T)).max() < 1e-15
