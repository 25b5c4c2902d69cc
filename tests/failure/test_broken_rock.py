"""What must hold of broken rock whatever the path: it makes no energy, bears nothing across what is open, and slides.

Paths are random legs of constant velocity gradient, stretching, shearing and turning at once, taken through the stress
update and failure check of a run.
"""

from dataclasses import fields, replace

import numpy as np
import pytest
from material_paths import LABELS, LAWS, random_legs, refined

from rsmpm_ti.verify.strength.crack_forms import BAND, LAM, MU, SIN_R, TENSILE, M
from rsmpm_ti.verify.strength.crack_paths import legs, rock, three_principals
from rsmpm_ti.verify.strength.material_point import History, follow, gradients, simple_shear, turned_by

BULK = LAM + 2.0 / 3.0 * MU
SIZES = (1e-3, 1e-2, 0.3)
"""Of a leg's strain and turn."""

COARSE, FINE = 40, 160
"""Steps of a leg."""

every_law = pytest.mark.parametrize("law", LAWS, ids=LABELS)

OPENED = gradients(legs((0.0, 0.1, 0.0), step=1e-3))
ALONG = simple_shear(legs((0.0, 0.0, 0.5), step=1e-3))
REST = np.zeros((10, 2, 2))  # strength lags a step
HALF_TURN = turned_by(np.zeros((1000, 2, 2)), np.linspace(0.0, np.pi, 1001))
CRACKED = gradients(legs((0.0, 1e-3, 0.0), (-4e-4, 1e-3, 0.0), step=4e-6))
CRUSHED = gradients(legs((0.26e-3, -1.6e-3, 0.0), (5.26e-3, -6.6e-3, 0.0), (5.26e-3, -12.0e-3, 0.0), step=8e-6))
SLID = simple_shear(legs((0.0, 0.0, 0.1), step=5e-5))


def all_at_once(law, paths: dict[str, np.ndarray], plate: bool = False) -> dict[str, History]:
    """Each of `paths` [paths, steps, 2, 2] in one launch, since every launch is compiled anew; or that of a plate."""
    of = rock(law)
    of = replace(of, elasticity=replace(of.elasticity, plane_stress=plate))
    longest = max(G.shape[1] for G in paths.values())
    padded = [np.pad(G, ((0, 0), (0, longest - G.shape[1]), (0, 0), (0, 0))) for G in paths.values()]
    found, start, parts = follow(of, BAND, np.concatenate(padded)), 0, {}
    for name, G in paths.items():
        rows = {field.name: getattr(found, field.name)[start : start + len(G), : G.shape[1]] for field in fields(found)}
        parts[name] = History(**rows)
        start += len(G)
    return parts


def energy_paths(paths: int, seed: int) -> dict[str, np.ndarray]:
    """Random legs of every size in coarse and in fine steps."""
    made_of = {size: random_legs(paths, 12, size, seed) for size in SIZES}
    return {f"{size} in {n}": refined(made_of[size], n) for size in SIZES for n in (COARSE, FINE)}


def check_energy(found: dict[str, History], G: dict[str, np.ndarray], rotating: bool) -> None:
    """No path makes energy but by the error of its steps, which is of second order and vanishes with them."""
    # trial and returned stress differ by at most the load of a step, M |d eps|, and D errs by half of it x d eps; twice
    # that where a rotating crack turns by up to 45 degrees in a step, from one principal direction to the other
    most = 1.0 if rotating else 0.5
    for size in SIZES:
        falls = []
        for n in (COARSE, FINE):
            lost, step = found[f"{size} in {n}"].lost, np.linalg.norm(G[f"{size} in {n}"], axis=(-2, -1)).max()
            falls.append((np.maximum.accumulate(lost, axis=1) - lost).max(axis=1))
            assert falls[-1].max() < most * M * step**2
        assert falls[1].sum() < falls[0].sum() / (0.5 * FINE / COARSE)


@pytest.fixture(scope="module")
def history(taichi_f64):
    """What a law did along all paths of this file."""
    paths = energy_paths(40, 1)
    paths["open, sheared, turned"] = np.concatenate([OPENED, ALONG, HALF_TURN])[None]
    paths["slid"] = np.concatenate([CRUSHED, SLID])[None]
    paths["cracked, turned"] = np.concatenate([CRACKED, REST, HALF_TURN])[None]
    paths["crushed, turned"] = np.concatenate([CRUSHED, REST, HALF_TURN])[None]
    found = {}

    def of(law):
        if law not in found:
            found[law] = all_at_once(law, paths)
            check_energy(found[law], paths, law.rotating)
        return found[law]

    return of


def randomly(found: dict[str, History]) -> list[History]:
    return [found[f"{size} in {COARSE}"] for size in SIZES]


@every_law
def test_no_random_path_makes_energy(history, law):
    modes = np.concatenate([one.mode[:, -1] for one in randomly(history(law))])  # the fixture checks energy
    assert min(np.bincount(modes, minlength=3)[1:]) >= 10


@pytest.mark.parametrize("law", LAWS[:2], ids=LABELS[:2])
def test_no_random_path_of_a_plate_makes_energy(taichi_f64, law):
    paths = energy_paths(40, 2)
    found = all_at_once(law, paths, plate=True)
    check_energy(found, paths, law.rotating)
    for one in randomly(found):
        assert np.abs(one.sigma[..., 2]).max() < 1e-6  # round-off of MPa
        pores = (one.mode == 2) & (one.opening[..., 0] > 0.0)
        assert one.sigma[pores, :2].sum(axis=-1).min(initial=0.0) > -1e-6


@pytest.mark.validation
@every_law
def test_ten_thousand_random_paths_make_no_energy(taichi_f64, law):
    for seed in range(10):
        paths = energy_paths(334, 100 + seed)  # of three sizes
        check_energy(all_at_once(law, paths), paths, law.rotating)


@every_law
def test_nothing_presses_across_what_is_open(history, law):
    open_pores = 0
    for one in randomly(history(law)):
        pores = (one.mode == 2) & (one.opening[..., 0] > 0.0)
        open_pores += pores.sum()
        assert one.sigma[pores, :3].mean(axis=-1).min(initial=0.0) > -1e-6  # round-off of sums of MPa, in Pa
        n, s = np.moveaxis(one.normal, -1, 0), np.moveaxis(one.sigma, -1, 0)
        across = n[0] ** 2 * s[0] + n[1] ** 2 * s[1] + 2.0 * n[0] * n[1] * s[3]
        cracks = (one.mode == 1) & (one.opening[..., 0] > 1e-9)
        # four sweeps over the two cracks leave (lam/M)^8 = 5e-7 of what one takes from the other
        assert across[cracks].min(initial=0.0) > -((LAM / M) ** 8) * M * one.opening[cracks].max(initial=0.0)
    assert open_pores > 1000


@every_law
def test_only_solid_carries_stress(history, law):
    for one in randomly(history(law)):
        solid = np.exp(one.sigma[..., :3].sum(axis=-1) / (3.0 * BULK))  # the rate form's volume under a stress
        broken = (one.mode != 0) & (np.abs(np.log(solid)) < 0.2)
        np.testing.assert_allclose(one.carrying[broken], solid[broken], rtol=1e-6)  # 0.2^5/720
        assert one.carrying.min() > 0.0


@pytest.mark.parametrize("law", [law for law in LAWS if not law.rotating], ids=str)
def test_open_crack_that_is_sheared_and_turned_bears_nothing(history, law):
    """Opened by a tenth, sheared along five times that, turned by half a turn: nothing across it and no shear.

    A rotating crack would turn with the shear, and the rock be pressed at right angles to it.
    """
    one = history(law)["open, sheared, turned"]
    assert np.abs(one.sigma[0, len(OPENED) :]).max() < 1e-6 * TENSILE
    assert one.opening[0, -1].max() > 0.09


@every_law
def test_crushed_rock_slides_with_residual_friction(history, law):
    """Pressed until it fails, then simple shear of 20 % at constant volume: Mohr-Coulomb of what is left, and the axes
    settle at 45 degrees to the shear, so that tau over the normal stress is sin(phi_r)."""
    one = history(law)["slid"]
    xx, yy, _, xy = one.sigma[0, -1]
    low, _, high = np.sort(three_principals(one.sigma[0, -1:])[0])
    assert low / high == pytest.approx((1.0 + SIN_R) / (1.0 - SIN_R), rel=1e-6)
    if law.dilation_angle == 0.0:  # else the walls press more and more, and the axes follow late
        assert xy / -yy == pytest.approx(SIN_R, rel=0.01)  # off by the elastic shear over the plastic one
        assert xx == pytest.approx(yy, rel=0.01)


@every_law
@pytest.mark.parametrize("name, start, mode", [("cracked", CRACKED, 1), ("crushed", CRUSHED, 2)])
def test_turn_of_broken_rock_changes_no_invariant(history, law, name, start, mode):
    """By 180 degrees in 1000 steps: rock with an open crack under stress along it, and crushed rock under pressure."""
    one = history(law)[f"{name}, turned"]
    assert one.mode[0, -1] == mode
    ends = [len(start) + len(REST) - 1, -501, -1]
    before, quarter, after = (np.sort(three_principals(one.sigma[0, [k]])[0]) for k in ends)
    for turned in (quarter, after):
        np.testing.assert_allclose(turned, before, rtol=0.0, atol=1e-6 * np.abs(before).max())
    normal = one.normal[0, ends]
    if mode == 1:
        assert abs(normal[0] @ normal[1]) < 1e-6 and abs(abs(normal[0] @ normal[2]) - 1.0) < 1e-6
