"""What 'auto' takes for the time scale: against wave and kinetic closed forms, and against a run."""

import json
import math
from dataclasses import replace

import pytest
from exact import p_wave_speed

from rsmpm_ti import load_scene, simulate
from rsmpm_ti.errors import SceneError
from rsmpm_ti.scene import main
from rsmpm_ti.spec.loading_start import AtRest, Press, Ramp
from rsmpm_ti.spec.mass_scaling import estimate, tip_tension
from rsmpm_ti.spec.regions import Slit
from rsmpm_ti.spec.scene import Output
from rsmpm_ti.spec.scene_json import from_plain, to_plain

SPEED = p_wave_speed(17e9, 0.14, 2600.0)
MODULUS, UCS = 17e9 / (1.0 - 0.14**2), 25.520e6  # plane strain; 2 c cos(phi)/(1 - sin(phi))
RATE = 0.05


def auto(name: str, **loading):
    scene = load_scene(name)
    return replace(scene, loading=replace(scene.loading, **{"time_scale": "auto"} | loading))


def test_intact_rock_is_limited_by_how_its_peak_is_read():
    """It breaks off at once, and an eighth of a wave transit of loading is lost."""
    k = 0.01 * UCS / MODULUS * 8.0 * SPEED / (RATE * 0.1)
    assert auto("intact").time_scale == pytest.approx(k, rel=1e-4)  # the digits of UCS


def test_without_that_it_is_limited_by_the_kinetic_energy_of_uniform_strain():
    # mean of v^2: (rate H)^2/12 along the load, and Poisson's fraction of the width across it
    squared = RATE**2 * (0.1**2 + (0.14 / 0.86 * 0.05) ** 2) / 12.0
    k = math.sqrt(0.01 * UCS**2 / MODULUS / (2600.0 * squared))
    found = replace(estimate(auto("intact")), height=0.0)
    assert found.largest(0.01) == pytest.approx(k, rel=1e-4)


def test_density_and_step_go_with_the_scale():
    scene = auto("intact")
    assert scene.density == pytest.approx(2600.0 * scene.time_scale**2)
    assert scene.dt == pytest.approx(0.5 * 0.5e-3 * scene.time_scale / SPEED, rel=1e-4)


def test_a_start_from_rest_is_limited_by_the_first_wave():
    """The jump rho c v of the closing speed, 5 mm/s, with rho c of the scaled rock; and a cell of 0.5 mm more."""
    k = 0.01 * UCS / (2600.0 * SPEED * 5e-3 * 1.005)
    assert auto("intact", start=AtRest()).time_scale == pytest.approx(k, rel=1e-4)
    assert auto("intact", start=AtRest(), quasi_static=0.02).time_scale == pytest.approx(2.0 * k, rel=1e-4)


def test_error_of_a_ramp_is_that_of_an_oscillator():
    """u'' + w^2 (u - ramp) = 0 from rest, solved step by step: what rings after a smooth step of speed."""
    scene = auto("intact", start=Ramp(time=1.3e-3))
    found = replace(estimate(scene), strain=1.0)  # far beyond the ramp, and nothing to how a peak is read
    for k in (3.0, 6.0):
        w, n = math.pi * SPEED / k / 0.1, 40_000
        dt, u, v, y = 1.3e-3 / n, 0.0, 0.0, 0.0
        for i in range(n):
            y += dt * found.start.factor((i + 0.5) * dt)
            v += dt * w**2 * (y - u)
            u += dt * v
        lag = math.hypot((v - 1.0) / w, u - y)  # amplitude about uniform motion, per full speed
        bound = found.error(k) * found.stress / (2600.0 * SPEED * k * 5e-3)  # the same per k rho c V
        assert lag * w <= bound <= 3.0 * lag * w + 0.02  # an envelope: sines at their largest, and a cell's 0.5 %
    assert scene.time_scale <= 1.3e-3 * SPEED / (5.0 * 0.1)  # 5 transits of the scaled rock


def test_tension_at_a_flaw_by_fracture_mechanics():
    flaw = Slit(centre=(0.0, 0.0), length=30e-3, width=1e-3, angle=0.0)
    # mode I: 2 K_I/sqrt(2 pi d), K_I = s sqrt(pi a), for tension across the flaw
    assert tip_tension(flaw, 1, 1.0, 0.0, 1e-3) == pytest.approx(math.sqrt(30.0), rel=1e-6)
    # pressed along its length the end is the crown of a hole, and so is the middle pressed across: 1 (Inglis, Kirsch)
    assert tip_tension(flaw, 0, -1.0, 0.0, 1e-3) == pytest.approx(1.0)
    assert tip_tension(flaw, 1, -1.0, 0.0, 1e-3) == pytest.approx(1.0)
    # pure shear: largest hoop stress 2/sqrt(3) K_II/sqrt(2 pi r) at 70.5 degrees (Erdogan & Sih 1963), and the field's
    # own stress along the flaw is 0
    turned = replace(flaw, angle=45.0)
    assert tip_tension(turned, 1, 1.0, -1.0, 1e-3) == pytest.approx(2.0 / math.sqrt(3.0) * math.sqrt(30.0), rel=1e-4)


def test_flawed_rock_is_limited_by_waves_along_the_flaw():
    scene = auto("cube")
    found = estimate(scene)
    error = 2600.0 * SPEED * scene.time_scale * RATE * 15.5e-3 / found.stress
    assert error == pytest.approx(0.01, rel=1e-6)
    assert 0.5e6 < found.stress < 1.0e6  # finds 1.00 MPa; must not be below by much, nor above
    assert found.strain == pytest.approx(found.stress / MODULUS)


def test_a_disc_is_hondros_inside_and_hertz_between_plates():
    """3 P/(pi R) along the load makes 3 at the crown of a slit along it, P/(pi R) across it opens its tips."""
    scene = load_scene("disc", quick=True, settings={"loading.time_scale": "auto"})
    found = estimate(scene)
    assert found.stress == pytest.approx(2e6 / (math.sqrt(30e-3 / 1e-3) + 3.0), rel=1e-4)
    # 2 P/(pi E') (2 ln(4R/b) - 1) over 2R; b = 10 mm touches within a cell of 1 mm
    assert found.strain == pytest.approx(found.stress / MODULUS * (2.0 * math.log(4.0 * 50.0 / 10.0) - 1.0))


def test_confinement_holds_tension_back_and_raises_the_strength():
    slit = estimate(auto("cube", confinement=2e6)).stress
    assert slit == pytest.approx(2.0 * estimate(auto("cube")).stress)  # the tensile strength is 2 MPa too
    # UCS + 4.599 p in all, p of it there from the start; unless the end of the scene comes first
    squeezed = auto("intact", confinement=2e6)
    assert estimate(squeezed).stress == pytest.approx(1.6e-3 * MODULUS)
    longer = replace(squeezed, schedule=replace(squeezed.schedule, strain_end=2.5e-3))
    assert estimate(longer).stress == pytest.approx(UCS + 3.599 * 2e6, rel=1e-4)


@pytest.mark.parametrize(
    "change, words",
    [
        ({"boundaries": ()}, "two platens"),
        ({"start": Press(time=1e-2)}, "start = Press stops"),
    ],
    ids=["no platens", "press"],
)
def test_auto_is_refused_where_nothing_is_quasi_static(change, words):
    scene = load_scene("intact")
    schedule = replace(scene.schedule, strain_end=None, t_end=1e-3)
    start = {"start": AtRest()}
    with pytest.raises(SceneError, match=f"'auto' is refused.*{words}.*give a number") as refused:
        replace(scene, schedule=schedule, loading=replace(scene.loading, time_scale="auto", **start | change))
    assert "\n" not in str(refused.value)


def test_auto_is_refused_for_a_body_that_flies():
    scene = load_scene("intact")
    with pytest.raises(SceneError, match="platens alone set in motion"):
        bodies = (replace(scene.bodies[0], velocity=(0.0, -1.0)),)
        replace(scene, bodies=bodies, loading=replace(scene.loading, time_scale="auto"))


def test_auto_comes_by_keyword_by_field_and_from_a_record_and_shows_its_number(capsys):
    scene = load_scene("cube", settings={"time_scale": "auto"})
    assert scene.loading.time_scale == "auto"
    assert load_scene("disc", settings={"loading.time_scale": "auto"}).time_scale > 1.0
    again = from_plain(json.loads(json.dumps(to_plain(scene))))
    assert again == scene and again.time_scale == scene.time_scale
    assert main(["cube", "--set", "time_scale=auto", "--check"]) == 0
    shown = capsys.readouterr().out
    assert f"time_scale = {scene.time_scale:g}" in shown and "inertia adds up to 1 %" in shown


@pytest.mark.validation
def test_a_run_has_the_kinetic_share_that_auto_promised(tmp_path):
    scene = load_scene("intact", dx=2e-3, time_scale="auto").elastic()  # no failure: the promise is for the end
    scene = replace(scene, output=Output(frames=0, movie=False, vtu=0))
    result = simulate(scene, out=tmp_path, threads=1)
    # the affine start is exact for intact rock, so what moves is uniform strain alone. The last step may be a whole one
    # beyond the end, 0.3 % of the load, and energy is its square; logarithmic strain adds 0.16 %
    last = result.history[-1]
    assert last["energy_kinetic_J"] / last["energy_elastic_J"] == pytest.approx(0.01, rel=0.02)
    # a tolerance on the load is one on the stiffness of intact rock
    assert result.summary["apparent_modulus_Pa"] == pytest.approx(MODULUS, rel=0.01)
    assert result.summary["time_scale"] == scene.time_scale
    assert result.summary["dt_s"] == pytest.approx(scene.dt)
    assert json.loads((tmp_path / "scene.json").read_text())["time_scale"] == pytest.approx(scene.time_scale)
