"""The return to Mohr-Coulomb against a solver that knows no plane, edge or order: all six slips at once."""

import itertools

import numpy as np
import pytest
import taichi as ti
from harness import on_rows, vector

from rsmpm_ti.rock.broken.principal_return import mohr_coulomb_return

MU, LAM = 7.46e9, 2.9e9
PAIRS = tuple(itertools.permutations(range(3), 2))


def by_complementarity(s, sin_phi, sin_psi, c_cos, sweeps=4000):
    """(stress, slip) [n, 3], [n]: slips g_ij >= 0 of every ordered pair, either 0 or with the pair on the envelope.

    Slip of a pair strains it by (1 + sin psi)/2 and -(1 - sin psi)/2 (Koiter 1953); projected Gauss-Seidel.
    """
    found, slips = s.copy(), np.zeros((len(s), 6))
    flows = []
    for i, j in PAIRS:
        strain = np.zeros(3)
        strain[i], strain[j] = 0.5 * (1.0 + sin_psi), -0.5 * (1.0 - sin_psi)
        flows.append(2.0 * MU * strain + LAM * strain.sum())
    for _ in range(sweeps):
        most = 0.0
        for k, (i, j) in enumerate(PAIRS):
            excess = 0.5 * (found[:, i] - found[:, j]) + 0.5 * (found[:, i] + found[:, j]) * sin_phi - c_cos
            own = 0.5 * (flows[k][i] - flows[k][j]) + 0.5 * (flows[k][i] + flows[k][j]) * sin_phi
            change = np.maximum(excess / own, -slips[:, k])
            slips[:, k] += change
            found -= change[:, None] * flows[k]
            most = max(most, np.abs(change).max() * MU)
        if most < 1e-4:  # Pa
            break
    return found, slips.sum(axis=1)


@pytest.mark.parametrize("phi, psi", [(40.0, 0.0), (40.0, 20.0), (30.0, 30.0), (5.0, 0.0), (60.0, 10.0), (0.0, 0.0)])
@pytest.mark.parametrize("cohesion", [0.0, 6e6])
def test_return_is_that_of_all_slips_at_once(taichi_f64, phi, psi, cohesion):
    @ti.func
    def returned(a: ti.template(), p):
        s, slip = mohr_coulomb_return(vector(a, p, 0, 3), a[p, 3], a[p, 4], a[p, 5], LAM, MU)
        return ti.Vector([s[0], s[1], s[2], slip])

    sin_phi, sin_psi = np.sin(np.radians([phi, psi]))
    c_cos = cohesion * np.sqrt(1.0 - sin_phi**2)
    rng = np.random.default_rng(5)
    s = -np.sort(-rng.normal(size=(400, 3)) * 20e6, axis=1)
    s[:20, 1] = s[:20, 0]  # on both edges already, and pressed from all sides
    s[20:40, 1] = s[20:40, 2]
    apex = c_cos / sin_phi if sin_phi > 0.0 else 5e6
    s += (np.minimum(rng.uniform(-60e6, 5e6, 400), apex) - s.mean(axis=1))[:, None]
    rows = np.column_stack([s, np.tile([sin_phi, sin_psi, c_cos], (400, 1))])
    found = on_rows(returned, rows, 4, ti.f64)
    expected, slip = by_complementarity(s, sin_phi, sin_psi, c_cos)
    np.testing.assert_allclose(found[:, :3], expected, rtol=0.0, atol=1.0)  # sweeps stop at 1e-4 Pa each
    edge = expected[:, 0] - expected[:, 2] > 1.0  # at the tip slips are not unique
    np.testing.assert_allclose(found[edge, 3], slip[edge], rtol=1e-6, atol=1.0 / MU)
