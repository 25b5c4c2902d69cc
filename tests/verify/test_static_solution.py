"""The static solutions that the case `first_failure` holds a run against, solved again: docs/references.md, section 15.

Linear elasticity on the particles of a scene with its linear functions, as one system of linear equations. Nothing of
it is the solver's: no step, no motion, no failure check.
"""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse import coo_array, diags_array, kron
from scipy.sparse.linalg import spsolve

from rsmpm_ti import Lattice, Linear, load_scene
from rsmpm_ti.spec.regions import slits_of
from rsmpm_ti.verify.strength.first_failure import MODULUS_RATIO, STATIC, WIDTH


def static_solution(name: str, **keywords) -> tuple[float, float, np.ndarray]:
    """(nominal stress at first tension [Pa], modulus over E', its place along and across the flaw [mm])."""
    scene = load_scene(name, **keywords)
    scene = replace(scene, shape=Linear(), bodies=(replace(scene.bodies[0], seeding=Lattice()),))
    rock, dx, origin = scene.rock, scene.domain.dx, np.array(scene.domain.lower)
    (seeds,) = scene.particles()
    shape = tuple(np.round((np.array(scene.domain.upper) - origin) / dx).astype(int) + 1)
    strain = gradients((seeds.x - origin) / dx, shape, dx)
    lam, mu = rock.elasticity.lam, rock.elasticity.mu
    hooke = np.array([[lam + 2.0 * mu, lam, 0.0], [lam, lam + 2.0 * mu, 0.0], [0.0, 0.0, mu]])  # plane strain
    stiffness = (strain.T @ kron(diags_array(seeds.volume), hooke) @ strain).tocsr()

    lower, upper = scene.loading.platens
    row = np.indices(shape)[1].ravel()
    top = np.flatnonzero(row == round((upper.position - origin[1]) / dx))
    bottom = np.flatnonzero(row == round((lower.position - origin[1]) / dx))
    used = stiffness.diagonal() > 1e-9 * stiffness.diagonal().max()
    given = np.zeros(len(used))
    given[2 * top + 1] = -1e-6  # m; the problem is linear
    held = np.zeros(len(used), dtype=bool)
    held[2 * top + 1] = held[2 * bottom + 1] = True
    touching = [node for node in bottom if used[2 * node]]
    held[2 * touching[len(touching) // 2]] = True  # one node may not slide, or the body would
    free, known = used & ~held, used & held
    u = given.copy()
    u[free] = spsolve(stiffness[free][:, free].tocsc(), -(stiffness[free][:, known] @ given[known]))

    nominal = -(stiffness @ u)[2 * top + 1].sum() / scene.loading.width
    xx, yy, xy = ((strain @ u).reshape(-1, 3) @ hooke).T
    sigma_1 = 0.5 * (xx + yy) + np.hypot(0.5 * (xx - yy), xy)
    most = sigma_1.argmax()
    (slit,) = slits_of(scene.bodies[0].region)
    modulus = nominal * scene.loading.height / 1e-6 / rock.elasticity.uniaxial_modulus(2)
    position = 1e3 * np.abs(slit.frame(seeds.x[most : most + 1])[0])
    return rock.criterion.tensile_strength * nominal / sigma_1[most], modulus, position


def gradients(xi: np.ndarray, shape: tuple[int, int], dx: float) -> coo_array:
    """Strain (xx, yy, 2 xy) of every particle per displacement of every node, linear functions."""
    base = np.floor(xi).astype(int)
    r, p = xi - base, np.arange(len(xi))
    rows, columns, values = [], [], []
    for i, j in itertools.product((0, 1), repeat=2):
        node = np.ravel_multi_index((base[:, 0] + i, base[:, 1] + j), shape)
        w = [r[:, d] if k else 1.0 - r[:, d] for d, k in enumerate((i, j))]
        slope = (2 * i - 1) * w[1] / dx, (2 * j - 1) * w[0] / dx
        for component, axis, g in ((0, 0, slope[0]), (1, 1, slope[1]), (2, 0, slope[1]), (2, 1, slope[0])):
            rows.append(3 * p + component)
            columns.append(2 * node + axis)
            values.append(g)
    entries = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
    return coo_array(entries, shape=(3 * len(xi), 2 * math.prod(shape))).tocsr()


def test_static_solution_of_the_slit_cube():
    stress, modulus, position = static_solution("cube", flaw_width=WIDTH["cube"])
    assert stress == pytest.approx(STATIC["cube"][0], rel=1e-3)  # three digits were kept
    assert position == pytest.approx(STATIC["cube"][1], abs=5e-3)
    assert modulus == pytest.approx(MODULUS_RATIO, abs=5e-5)


def test_static_solution_of_the_slit_disc():
    stress, _, position = static_solution("disc", flaw_width=WIDTH["disc"])
    assert stress == pytest.approx(STATIC["disc"][0], rel=1e-3)
    assert position == pytest.approx(STATIC["disc"][1], abs=1e-2)
