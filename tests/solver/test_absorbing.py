"""Boundaries that waves leave by, against plane waves, and a blast against waves of one radial coordinate."""

from dataclasses import replace

import numpy as np
import pytest
from exact import lame, p_wave_speed

from rsmpm_ti import (
    Absorbing,
    Apic,
    Body,
    Box,
    Difference,
    Disc,
    Domain,
    HolePressure,
    Hooke,
    InSitu,
    Lattice,
    Linear,
    Loading,
    NoViscosity,
    Output,
    Rock,
    Scene,
    SceneError,
    Schedule,
    Unbreakable,
    Wall,
    simulate,
)

E, NU, DENSITY, P = 17e9, 0.14, 2600.0, 1e6
ROCK = Rock(density=DENSITY, elasticity=Hooke(E=E, nu=NU), criterion=Unbreakable(), viscosity=NoViscosity())
SPEED = p_wave_speed(E, NU, DENSITY)
DX, LENGTH, WIDTH, RISE = 1e-3, 60e-3, 4e-3, 12e-6
PART = np.linspace(0.0, 1.0, 25)[1:]


def bar(*ends, **parts) -> Scene:
    """Between smooth walls, with a pulse p sin^2 of RISE at one end."""
    sides = tuple(Wall(axis=1, side=side, position=at) for side, at in (("lower", 0.0), ("upper", WIDTH)))
    pulse = HolePressure(
        region=Box(lower=(-5.0 * DX, 0.0), upper=(0.0, WIDTH)),
        times=tuple(RISE * PART),
        pressures=tuple(P * np.sin(np.pi * PART) ** 2),
    )
    return Scene(
        title="bar",
        domain=Domain(lower=(-10.0 * DX, 0.0), upper=(LENGTH, WIDTH), dx=DX),
        bodies=(Body(region=Box(lower=(0.0, 0.0), upper=(LENGTH, WIDTH))),),
        rock=ROCK,
        loading=Loading(boundaries=(*sides, *ends), holes=(pulse,)),
        schedule=Schedule(t_end=60e-6, cfl=0.25),
        output=Output(frames=0, movie=False, vtu=0),
        **parts,
    )


END = Absorbing(axis=0, side="upper", position=LENGTH)
ENERGY = P**2 / (DENSITY * SPEED) * WIDTH * RISE * 3.0 / 8.0
"""Of a plane wave, int p v dt with v = p/(rho c) [J/m]."""


@pytest.mark.parametrize("parts", [{}, {"transfer": Apic()}, {"shape": Linear()}], ids=repr)
@pytest.mark.thorough("{'transfer': Apic()}")
def test_plane_wave_brings_its_energy_and_leaves_with_it(parts):
    """A dashpot of the wave's own impedance takes all of it; a grid of 30 cells to the wave leaves 1e-3."""
    history = simulate(bar(END, **parts), threads=1).history
    there = history["energy_kinetic_J"] + history["energy_elastic_J"]
    before = np.searchsorted(history["time_s"], 1.2 * RISE)
    assert history["work_J"][before] == pytest.approx(ENERGY, rel=0.01)
    assert there[-1] < 2e-3 * ENERGY and history["energy_dissipated_J"][-1] == pytest.approx(ENERGY, rel=0.01)
    assert np.abs(there + history["energy_dissipated_J"] - history["work_J"]).max() < 0.005 * ENERGY


def test_without_it_the_wave_comes_back():
    history = simulate(bar(), threads=1).history
    there = history["energy_kinetic_J"] + history["energy_elastic_J"]
    assert there[-1] > 0.97 * ENERGY


@pytest.mark.parametrize(
    "loads",
    [{"settle": True}, {"body_force": (0.0, -9.81)}, {"initial_stress": InSitu(axis=1, overburden=1e6, K0=1.0)}],
)
def test_beside_loads_at_rest_it_is_refused(loads):
    scene = bar(END)
    with pytest.raises(SceneError, match="carries no load at rest"):
        replace(scene, loading=replace(scene.loading, **loads))


RADIUS, EDGE, END_TIME = 10e-3, 60e-3, 20e-6


def cavity(dx: float) -> Scene:
    """A quarter of a block with a hole, until the wave has come near its sides."""
    hole = Disc(centre=(0.0, 0.0), radius=RADIUS)
    block = Difference(whole=Box(lower=(0.0, 0.0), upper=(EDGE, EDGE)), removed=(hole,))
    mirrors = tuple(Wall(axis=axis, side="lower", position=0.0) for axis in (0, 1))
    sides = tuple(Absorbing(axis=axis, side="upper", position=EDGE) for axis in (0, 1))
    pulse = HolePressure(region=hole, times=tuple(RISE * PART), pressures=tuple(P * np.sin(np.pi * PART) ** 2))
    return Scene(
        title="cavity",
        domain=Domain(lower=(0.0, 0.0), upper=(EDGE, EDGE), dx=dx),
        bodies=(Body(region=block, seeding=Lattice(fitted=True)),),
        rock=ROCK,
        loading=Loading(boundaries=(*mirrors, *sides), holes=(pulse,)),
        schedule=Schedule(t_end=END_TIME),
        output=Output(frames=0, movie=False, vtu=0),
    )


def radial(end: float, cells: int = 2000) -> tuple[np.ndarray, np.ndarray]:
    """Radii [m] and radial displacement [m] at a time [s] of a pulse on the wall of a cavity in an endless plate.

    rho u'' = d s_rr/dr + (s_rr - s_tt)/r in plane strain, by central differences, staggered: u at nodes, strain between
    them. Nothing here knows the package.
    """
    lam, mu = lame(E, NU)
    r = np.linspace(RADIUS, RADIUS + 1.5 * SPEED * end, cells + 1)
    h, middle = r[1] - r[0], 0.5 * (r[1:] + r[:-1])
    steps = int(np.ceil(end / (0.5 * h / SPEED)))
    dt = end / steps
    u, v = np.zeros_like(r), np.zeros_like(r)
    for n in range(steps):
        e_r, e_t = np.diff(u) / h, 0.5 * (u[1:] + u[:-1]) / middle
        s_r, s_t = (lam + 2.0 * mu) * e_r + lam * e_t, (lam + 2.0 * mu) * e_t + lam * e_r
        force = np.zeros_like(r)  # per radian
        force[:-1] += middle * s_r - 0.5 * h * s_t
        force[1:] -= middle * s_r + 0.5 * h * s_t
        force[0] += RADIUS * np.interp(n * dt, (0.0, *(RISE * PART)), (0.0, *(P * np.sin(np.pi * PART) ** 2)))
        mass = DENSITY * r * h * np.r_[0.5, np.ones(cells - 1), 0.5]
        v += dt * force / mass
        v[-1] = 0.0
        u += dt * v
    return r, u


def off(dx: float) -> tuple[float, float, float]:
    """Of displacements against the largest: root mean square and largest error; and what is ahead of the front."""
    snapshot = simulate(cavity(dx), threads=1).snapshot
    x = snapshot.x - snapshot.displacement
    r = np.hypot(*x.T)
    u = np.sum(snapshot.displacement * x, axis=1) / r
    expected = np.interp(r, *radial(snapshot.time))
    error, most = np.abs(u - expected), expected.max()
    ahead = r > RADIUS + SPEED * snapshot.time + 2.0 * DX
    return float(np.sqrt(np.mean(error**2)) / most), float(error.max() / most), float(np.abs(u[ahead]).max() / most)


@pytest.mark.thorough
def test_wave_of_a_cavity_is_that_of_one_radial_coordinate():
    """Second order: the grid delays short waves by (k dx)^2. It arrives when the P wave does."""
    (coarse, _, _), (fine, most, ahead) = off(2.0 * DX), off(DX)
    assert fine < 0.015 and most < 0.04 and fine < 0.35 * coarse
    assert ahead < 0.005
