"""Laws of directional cracks: stress by hand for every one of them, what they refuse, and the weights of the mean."""

import dataclasses
import inspect
import json
import math
import re
import typing
from dataclasses import replace

import numpy as np
import pytest

from rsmpm_ti.errors import SceneError
from rsmpm_ti.method.shape import Gimp, Linear, QuadraticBSpline
from rsmpm_ti.rock import smeared_crack as directional
from rsmpm_ti.rock import softening
from rsmpm_ti.rock.after_failure import Clipped, CompressionOnly, Void
from rsmpm_ti.rock.criteria import MohrCoulomb, Unbreakable
from rsmpm_ti.rock.nonlocal_mean import Local, Nonlocal
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.rock.smeared_crack import Directional
from rsmpm_ti.rock.softening import Brittle, ExponentialSoftening, LinearSoftening
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.regions import Box
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule
from rsmpm_ti.spec.scene_json import from_plain, to_plain
from rsmpm_ti.verify.strength.crack_forms import (
    BAND,
    COHESION,
    G_F_I,
    LAM,
    MU,
    SHARES,
    SIN_R,
    TAN_R,
    TENSILE,
    E,
    M,
    across,
    crushed,
)
from rsmpm_ti.verify.strength.crack_paths import LAWS, PRESSURE, STEP, label, legs, rock, softening_name
from rsmpm_ti.verify.strength.material_point import follow, gradients, simple_shear, turned_by

every_law = pytest.mark.parametrize("law", LAWS, ids=label)
NAN, INF = float("nan"), float("inf")


def defined_in(module) -> set[str]:
    return {k for k, c in inspect.getmembers(module, dataclasses.is_dataclass) if c.__module__ == module.__name__}


def test_every_law_of_a_crack_has_its_closed_form():
    assert defined_in(softening) == set(SHARES), "give the fraction of strength of a new softening law in SHARES"
    assert defined_in(directional) == {"Directional"}
    fields = {field.name for field in dataclasses.fields(Directional)}
    dilates = {"dilation_angle", "dilation_slip"}  # see test_broken_rock.py
    assert fields - dilates == {"residual_friction_angle", "rotating", "softening"}, "LAWS leaves a field at one value"
    assert {(law.rotating, softening_name(law)) for law in LAWS} == {(r, s) for r in (False, True) for s in SHARES}
    assert set(typing.get_args(typing.get_type_hints(Directional)["softening"])) == {type(x.softening) for x in LAWS}


def test_law_without_direction_gives_a_pressure():
    """What `test_failed_cell` looks for: nothing else is missing from its formulas or from ours."""
    kinds = typing.get_args(typing.get_type_hints(Rock)["after_failure"])
    assert {kind for kind in kinds if not kind.oriented} == {k for k in kinds if hasattr(k, "pressure")}
    assert {kind for kind in kinds if kind.oriented} == {Directional}


# one particle per path and one kernel per law: all that a test needs to know of a law is taken from one launch
OPENED = legs((0.0, 0.6e-3, 0.0), (0.0, 0.1e-3, 0.0), (0.0, 0.9e-3, 0.0), (0.0, -1e-3, 0.0), step=4 * STEP)
PULLED = legs((0.0, 6e-4, 0.0), (4.5e-4, 6e-4, 0.0), step=4 * STEP)
SHEARED = legs((0.0, 1.3e-3, 0.0), (0.0, -PRESSURE / M, 0.0), (0.0, -PRESSURE / M, 4e-4), step=4 * STEP)
CRUSHED = legs((0.26e-3, -1.6e-3, 0.0), (5.26e-3, -6.6e-3, 0.0), (5.26e-3, -8.6e-3, 0.0), step=4 * STEP)
NOISE = np.random.default_rng(7).normal(size=(8, 12, 3)) * 1e-17
RESTED = legs((0.0, 0.4e-3, 0.0), (0.0, 0.0, 0.0), step=4 * STEP)


@pytest.fixture(scope="module")
def responses(taichi_f64):
    found = {}

    def of(law):
        if label(law) not in found:
            shaken = [np.concatenate([RESTED, noise, legs((0.0, 0.8e-3, 0.0), step=4 * STEP)]) for noise in NOISE]
            paths = [OPENED, PULLED, SHEARED, CRUSHED, *shaken]
            G = [gradients(path) for path in paths]
            if not law.rotating:
                G[2] = simple_shear(SHEARED)
            G.append(turned_by(G[1], np.full(len(PULLED), np.pi / 6.0)))
            longest = max(map(len, G))
            padded = np.stack([np.concatenate([g, np.zeros((longest - len(g), 2, 2))]) for g in G])
            found[label(law)] = follow(rock(law), BAND, padded)
        return found[label(law)]

    return of


@every_law
def test_opening_crack_softens_closes_along_the_secant_and_then_carries_compression(responses, law):
    strain = OPENED[1:, 1]
    sigma = responses(law).sigma[0, : len(strain)]
    axial, opening = across(M * strain, softening_name(law))
    # traction lags one step, and cannot be further off than the load of that step
    assert np.abs(sigma[:, 1] - axial).max() < M * 4 * STEP
    assert np.abs(sigma[:, 0] - LAM * (strain - opening)).max() < M * 4 * STEP
    assert np.abs(sigma[:, 2] - sigma[:, 0]).max() < 1e-6 and np.abs(sigma[:, 3]).max() < 1e-3  # round-off, in Pa
    closed = strain < 0.0
    np.testing.assert_allclose(sigma[closed, 1], M * strain[closed], rtol=1e-9, atol=M * 1e-15)


@every_law
def test_rock_along_a_crack_keeps_its_tensile_strength(responses, law):
    """Also where round-off makes the crack slip, as it does in axes that are turned by 30 degrees."""
    steps = len(PULLED) - 1
    history = responses(law)
    assert history.sigma[1, :steps, 0].max() == pytest.approx(TENSILE, rel=M * 4 * STEP / TENSILE)
    least = np.linalg.eigvalsh(history.sigma[-1, :steps][:, [0, 3, 3, 1]].reshape(-1, 2, 2))
    straight = np.sort(history.sigma[1, :steps, :2], axis=1)
    np.testing.assert_allclose(least, straight, rtol=0.0, atol=1e-8 * TENSILE)  # round-off of 300 increments of M x eps


@every_law
def test_shear_on_a_closed_crack_is_limited_by_friction_unless_the_crack_turns(responses, law):
    shear = 2.0 * SHEARED[1:, 2]
    tau = responses(law).sigma[2, : len(shear), 3]
    if law.rotating:
        # the crack turns to the axis of compression, and rock as good as new is pulled: elastic until that cracks
        assert tau[shear < 0.55e-3] == pytest.approx(MU * shear[shear < 0.55e-3], abs=1e-3)
        assert tau.max() > 1.4 * PRESSURE * TAN_R
        return
    fraction = float(
        SHARES[softening_name(law)](across(M * SHEARED[1:, 1], softening_name(law))[1].max(), TENSILE, G_F_I)
    )
    c, f = fraction * COHESION, fraction * TENSILE
    limit = math.sqrt((c + PRESSURE * TAN_R) ** 2 - (c - f * TAN_R) ** 2)
    # linear softening and none have lost all, so the limit is friction; the tail's share is of the step before: 1 %
    expected = np.minimum(MU * shear, limit if fraction > 0.0 else PRESSURE * TAN_R)
    np.testing.assert_allclose(tau, expected, rtol=0.0, atol=0.01 * limit if fraction > 0.0 else 1e-3)


@every_law
def test_crushed_rock_keeps_its_mean_stress_and_residual_friction_on_every_plane(responses, law):
    sigma = responses(law).sigma[3, : len(CRUSHED) - 1]
    name = softening_name(law)
    expected, first = crushed(CRUSHED[1:], name)
    np.testing.assert_allclose(sigma, expected, rtol=0.0, atol=M * 4 * STEP)  # cohesion lags one step
    np.testing.assert_allclose(sigma[:, :2].sum(axis=1), expected[:, :2].sum(axis=1), rtol=1e-9)
    assert (sigma[first:, :3] <= 0.0).all()
    if name != "ExponentialSoftening":  # nothing is left of cohesion
        least, most = sigma[-200:, :3].min(axis=1), sigma[-200:, :3].max(axis=1)
        np.testing.assert_allclose(least, (1.0 + SIN_R) / (1.0 - SIN_R) * most, rtol=1e-9)


@every_law
def test_crack_that_closes_on_nothing_but_round_off_does_not_forget_its_direction(responses, law):
    history = responses(law)
    for path in range(4, 4 + len(NOISE)):
        again = history.sigma[path, len(RESTED) + NOISE.shape[1] - 1 :, 1].max()
        at_most = across(M * RESTED[:, 1], softening_name(law))[0][len(legs((0.0, 0.4e-3, 0.0), step=4 * STEP)) - 1]
        assert again <= at_most + M * 4 * STEP


@every_law
def test_no_step_gives_energy_back(responses, law):
    lost = np.diff(responses(law).lost, axis=1)
    assert lost.min() > -0.5 * M * (4 * STEP) ** 2  # a step that closes a crack half way: half of its load x strain


CRITERION = MohrCoulomb(cohesion=5.95e6, friction_angle=40.0, tensile_strength=2e6)


def scene(dx: float = 1e-3, shape=None, dim: int = 2, **parts) -> Scene:
    block = Box(lower=(0.0,) * dim, upper=(20 * dx,) * dim)
    return Scene(
        title="block",
        domain=Domain(lower=(0.0,) * dim, upper=(20 * dx,) * dim, dx=dx),
        bodies=(Body(region=block),),
        rock=replace(rock(Directional()), **parts),
        loading=Loading(),
        schedule=Schedule(t_end=1e-5),
        shape=shape or QuadraticBSpline(),
    )


def refusal(build) -> str:
    with pytest.raises(SceneError) as refused:
        build()
    assert "\n" not in str(refused.value)
    return str(refused.value)


@pytest.mark.parametrize("shape", [Linear(), Gimp(), QuadraticBSpline()], ids=lambda s: type(s).__name__)
@pytest.mark.parametrize("kind", [LinearSoftening, ExponentialSoftening])
@pytest.mark.parametrize("name", ["G_f_I", "G_f_II"])
def test_band_that_would_snap_back_is_refused_with_a_dx_that_would_do(shape, kind, name):
    """Snap-back: f^2 h/(2 G) (linear) or f^2 h/G (exponential) of at least E (tension) or mu (shear)."""
    strength, modulus = (TENSILE, E) if name == "G_f_I" else (COHESION, MU)
    energies = {"G_f_I": 1e3, "G_f_II": 1e3, name: 2.0}
    law = Directional(softening=kind(**energies))
    twice = 2.0 if kind is LinearSoftening else 1.0
    largest = twice * 2.0 * modulus / strength**2 / shape.crack_band
    message = refusal(lambda: scene(dx=3.0 * largest, shape=shape, after_failure=law))
    assert message.startswith(f"after_failure.softening.{name} = 2.0 is refused: it must be large enough")
    named = float(re.search(r"a dx below (\S+) m", message)[1])
    assert named == pytest.approx(largest, rel=1e-3)  # printed with four digits
    assert f"softening.{name}" in refusal(lambda: scene(dx=1.01 * largest, shape=shape, after_failure=law))
    assert scene(dx=0.99 * largest, shape=shape, after_failure=law).rock.after_failure is law


@pytest.mark.parametrize("law", [Directional(), Directional(rotating=True)], ids=label)
def test_directional_crack_in_3d_is_refused(law):
    message = refusal(lambda: scene(dim=3, after_failure=law))
    assert "rock.after_failure" in message and "isotropic in 3D" in message and "CompressionOnly" in message
    assert scene(dim=3, after_failure=CompressionOnly()).dim == 3


@pytest.mark.parametrize("law", [CompressionOnly(), Void(), Clipped(tension_limit=0.0, compression_limit=1e6)])
def test_mean_stress_with_a_law_of_the_paper_is_refused(law):
    message = refusal(lambda: scene(after_failure=law, nonlocal_mean=Nonlocal(length=2e-3)))
    assert message.startswith("rock.nonlocal_mean = Nonlocal(") and "Local" in message and "Directional" in message
    assert scene(after_failure=law, nonlocal_mean=Local()).rock.after_failure is law


@pytest.mark.parametrize("shape", [Linear(), Gimp(), QuadraticBSpline()], ids=lambda s: type(s).__name__)
def test_mean_over_less_than_two_cells_is_refused_with_a_dx_and_a_length_that_would_do(shape):
    short = 1.8e-3
    message = refusal(lambda: scene(dx=1e-3, shape=shape, nonlocal_mean=Nonlocal(length=short)))
    assert message.startswith("rock.nonlocal_mean.length = 0.0018 is refused: it must be at least 0.002 m, two cells")
    dx = float(re.search(r"dx of at most (\S+) m", message)[1])
    assert dx == pytest.approx(0.9e-3, rel=1e-6)
    assert scene(dx=dx, shape=shape, nonlocal_mean=Nonlocal(length=short)).rock.nonlocal_mean.acts
    assert scene(dx=1e-3, shape=shape, nonlocal_mean=Nonlocal(length=2e-3)).rock.nonlocal_mean.acts


@pytest.mark.parametrize(
    "field, build",
    [
        *[
            (f"softening.{name}", lambda k=k, name=name, v=v: k(**{"G_f_I": 1.0, "G_f_II": 1.0, name: v}))
            for k in (LinearSoftening, ExponentialSoftening)
            for name in ("G_f_I", "G_f_II")
            for v in (0.0, -1.0, NAN, INF)
        ],
        *[
            ("after_failure.residual_friction_angle", lambda v=v: Directional(residual_friction_angle=v))
            for v in (-1.0, 90.0, NAN)
        ],
        *[("nonlocal_mean.length", lambda v=v: Nonlocal(length=v)) for v in (0.0, -1e-3, NAN, INF)],
        *[("nonlocal_mean.exclusion", lambda v=v: Nonlocal(length=1e-3, exclusion=v)) for v in (-0.1, 101.0, NAN)],
    ],
)
def test_impossible_crack_is_refused_by_field(field, build):
    assert re.match(rf"{re.escape(field)} = \S+ is refused: it must be \S", refusal(build))


def test_rock_that_cannot_break_may_have_any_energy_of_cracking():
    law = Directional(softening=LinearSoftening(G_f_I=1e-6, G_f_II=1e-6))
    assert scene(after_failure=law, criterion=Unbreakable()).rock.after_failure is law


SHAPES = [Linear(), Gimp(), Gimp(half_width=0.5), QuadraticBSpline()]


@pytest.mark.parametrize("shape", SHAPES, ids=str)
def test_variance_of_a_shape_is_the_second_moment_of_its_profile(shape):
    edges = np.linspace(-2.0, 2.0, 400_001)
    middle = 0.5 * (edges[1:] + edges[:-1])
    weight = shape.profile(middle) * 1e-5
    assert weight.sum() == pytest.approx(1.0, rel=1e-9)
    assert (middle**2 * weight).sum() == pytest.approx(shape.variance, rel=1e-8)  # midpoint rule: h^2/24 = 4e-12


@pytest.mark.parametrize("shape", SHAPES, ids=str)
@pytest.mark.parametrize("cells", [2.0, 2.3, 3.0, 8.0])
def test_taps_have_the_variance_that_is_left_to_them(shape, cells):
    """length^2 = variance of the taps + that of spreading to nodes and of reading back, for any length and cell."""
    dx = 0.5e-3
    length = dx * cells
    filter_weights = np.array(Nonlocal(length=length).filter_weights(dx, shape.variance))
    position = np.arange(len(filter_weights)) - len(filter_weights) // 2
    assert (
        len(filter_weights) % 2 == 1
        and (filter_weights > -1e-12).all()
        and (filter_weights == filter_weights[::-1]).all()
    )
    assert filter_weights.sum() == pytest.approx(1.0, abs=1e-12)
    # a Gaussian that is cut at 3.5 deviations has lost 0.6 % of its variance
    assert dx**2 * ((position**2 * filter_weights).sum() + 2.0 * shape.variance) == pytest.approx(length**2, rel=0.01)


@pytest.mark.parametrize(
    "soft", [Brittle(), *(k(G_f_I=3.0, G_f_II=30.0) for k in (LinearSoftening, ExponentialSoftening))]
)
def test_rock_with_directional_cracks_and_mean_stress_survives_json(soft):
    law = Directional(residual_friction_angle=25.0, rotating=True, softening=soft)
    one = scene(after_failure=law, nonlocal_mean=Nonlocal(length=2.5e-3, exclusion=3.0))
    assert from_plain(json.loads(json.dumps(to_plain(one), allow_nan=False))) == one
