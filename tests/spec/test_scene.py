"""What a scene refuses, in words that name field, value and allowed range."""

import math
import re
from dataclasses import replace

import pytest
from small_scene import BLOCK, DX, INF, NAN, SPEED, body, make, platens, refusal

from rsmpm_ti import load_scene
from rsmpm_ti.method.shape import Gimp, Linear, QuadraticBSpline
from rsmpm_ti.method.transfer import PicFlip
from rsmpm_ti.rock.after_failure import Clipped
from rsmpm_ti.rock.criteria import Unbreakable
from rsmpm_ti.rock.viscosity import BulkViscosity
from rsmpm_ti.spec.boundaries import Fixed, Wall
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.loading_start import Affine, Press, Ramp
from rsmpm_ti.spec.regions import Box, Difference, Disc, Slit, Union
from rsmpm_ti.spec.scene import Loading, Output, Schedule
from rsmpm_ti.spec.seeding import Lattice

BY_FIELD = [
    *[("domain.dx", lambda v=v: make(domain_dx=v)) for v in (0.0, -DX, NAN, INF)],
    ("domain.upper", lambda: make(domain_upper=(0.055, -0.1))),
    ("domain.upper", lambda: make(domain_upper=(0.055, INF))),
    ("domain.upper", lambda: make(domain_upper=(0.055, 0.1, 0.1))),
    ("domain.lower", lambda: Domain(lower=(0.0,), upper=(1.0,), dx=0.1)),
    ("domain.upper", lambda: Domain(lower=(0.0, 0.0), upper=(0.01, 1.0), dx=0.1)),
    ("domain.grid", lambda: make(domain_grid="adaptive")),
    *[("loading.time_scale", lambda v=v: make(loading_time_scale=v)) for v in (0.5, 0.0, -1.0, 1e4, NAN)],
    *[("loading.width", lambda v=v: make(loading_width=v)) for v in (0.0, -1.0, NAN)],
    ("loading.body_force", lambda: make(loading_body_force=(0.0, 0.0, -9.81))),
    *[("loading.body_force", lambda v=v: Loading(body_force=(0.0, v))) for v in (NAN, INF)],
    *[("body.velocity", lambda v=v: body(velocity=(v, 0.0))) for v in (NAN, -INF)],
    *[("body.spin", lambda v=v: body(spin=v)) for v in (NAN, INF)],
    *[(f"viscosity.{k}", lambda k=k, v=v: BulkViscosity(**{k: v})) for k in ("c1", "c2") for v in (NAN, INF, -1.0)],
    *[
        (f"after_failure.{k}", lambda k=k, v=v: Clipped(**{"tension_limit": 1.0, "compression_limit": 1.0, k: v}))
        for k in ("tension_limit", "compression_limit")
        for v in (NAN, INF)
    ],
    *[("box.lower", lambda v=v: Box(lower=(v, 0.0), upper=(1.0, 1.0))) for v in (NAN, -INF, -1e10)],
    *[("box.upper", lambda v=v: Box(lower=(0.0, 0.0), upper=(v, 1.0))) for v in (NAN, INF, 0.0)],
    *[("disc.centre", lambda v=v: Disc(centre=v, radius=1.0)) for v in ((NAN, 0.0), (0.0, INF), (0.0,), ())],
    *[("disc.radius", lambda v=v: Disc(centre=(0.0, 0.0), radius=v)) for v in (NAN, INF, 1e300)],
    *[("slit.centre", lambda v=v: Slit(centre=(v, 0.0), length=1.0, width=0.1, angle=0.0)) for v in (NAN, INF)],
    ("union.parts", lambda: Union(parts=())),
    ("union.parts", lambda: Union(parts=(Disc(centre=(0.0,) * 2, radius=1.0), Disc(centre=(0.0,) * 3, radius=1.0)))),
    ("difference.removed", lambda: Difference(whole=BLOCK, removed=(Disc(centre=(0.0,) * 3, radius=1.0),))),
    ("domain.dx", lambda: make(domain_dx=1e-9)),
    ("domain.dx", lambda: make(domain_lower=(-1e8, 0.0))),
    *[("domain.lower", lambda v=v: make(domain_lower=(v, 0.0))) for v in (NAN, -INF, -1e10)],
    ("domain.dx", lambda: make(domain_dx=2e-6, bodies=body(seeding=Lattice(particles_per_axis=8)))),
    ("schedule.strain_end", lambda: make(schedule_strain_end=5e-324)),
    ("schedule.t_end", lambda: make(schedule={"t_end": 1e300})),
    ("schedule.cfl", lambda: make(schedule_cfl=5e-324)),
    ("rock.density", lambda: replace(make().rock, density=5e-324)),
    *[("schedule.strain_end", lambda v=v: make(schedule_strain_end=v)) for v in (0.0, 0.5, -0.7, NAN)],
    ("schedule.strain_end", lambda: make(schedule_strain_end=-1e-3)),  # the platens compress
    ("schedule.strain_end", lambda: make(loading_boundaries=platens(speed=2.5e-3))),  # both move alike: no straining
    *[("schedule.t_end", lambda v=v: Schedule(t_end=v)) for v in (0.0, -1.0, NAN, INF)],
    *[("schedule.dt", lambda v=v: make(schedule_dt=v)) for v in (-1e-8, 0.0, NAN)],
    *[("schedule.cfl", lambda v=v: make(schedule_cfl=v)) for v in (0.0, -0.5, NAN, INF, 1.38, 10.0)],
    ("schedule.cfl", lambda: make(shape=QuadraticBSpline(), schedule_cfl=1.71)),
    ("schedule.cfl", lambda: make(shape=Gimp(), schedule_cfl=1.71)),
    ("schedule.cfl", lambda: make(shape=Gimp(), order="usl", schedule_cfl=0.61)),
    ("schedule.dt", lambda: make(schedule_dt=1.4 * DX / SPEED)),
    *[("schedule.rows", lambda v=v: make(schedule_rows=v)) for v in (0, -1, 1.5, 10**7, True)],
    *[("start.time", lambda v=v: Ramp(time=v)) for v in (0.0, -1e-3, NAN)],
    ("start.time", lambda: make(loading_start=Ramp(time=4.9 * 0.1 / SPEED))),
    ("start.time", lambda: make(loading_start=Press(time=4.9 * 0.1 / SPEED), schedule={"t_end": 1e-3})),
    ("start.time", lambda: Press(time=-1.0)),
    ("loading.force_field", lambda: Loading(force_field=9.81)),
    ("scene.order", lambda: make(order="leapfrog")),
    ("shape.half_width", lambda: make(shape=Gimp(half_width=0.5))),
    ("shape.half_width", lambda: Gimp(half_width=0.0)),
    ("shape.half_width", lambda: Gimp(half_width=0.51)),
    ("transfer.flip", lambda: PicFlip(flip=1.01)),
    ("transfer.flip", lambda: PicFlip(flip=NAN)),
    ("bodies[0].velocity", lambda: make(bodies=body(velocity=(1.0, 0.0, 0.0)))),
    ("boundaries[1].position", lambda: make(loading_boundaries=platens(position=0.1001))),
    ("boundaries[1].axis", lambda: make(loading_boundaries=platens(axis=2))),
    ("platen.axis", lambda: platens(axis=3)),
    ("platen.side", lambda: platens(side="top")),
    ("platen.position", lambda: platens(position=NAN)),
    ("platen.speed", lambda: platens(speed=INF)),
    ("platen.friction", lambda: platens(friction=-0.1)),
    *[("platen.span", lambda v=v: platens(span=v)) for v in ((0.03, 0.02), (0.0, INF), (NAN, 1.0), (0.1,))],
    ("platen.axis", lambda: platens(axis=True)),
    ("boundaries[1].position", lambda: make(loading_boundaries=platens(position=0.0))),  # no height is left
    ("wall.axis", lambda: Wall(axis=-1, side="lower", position=0.0)),
    ("fixed.side", lambda: Fixed(axis=0, side="left", position=0.0)),
    *[("output.frames", lambda v=v: Output(frames=v)) for v in (-1, 1.5, 10_001)],
    ("output.vtu", lambda: Output(vtu=-1)),
    ("output.painter", lambda: Output(painter="opengl")),
    *[("output.stress_limit", lambda v=v: Output(stress_limit=v)) for v in (0.0, NAN)],
]


@pytest.mark.parametrize("field, build", BY_FIELD, ids=[f"{k}-{field}" for k, (field, _) in enumerate(BY_FIELD)])
def test_refusal_names_field_value_and_range(field, build):
    assert re.match(rf"{re.escape(field)} = \S.* is refused: it must be \S", refusal(build))


def test_example_itself_is_accepted():
    assert make().dim == 2 and len(make().particles()[0].x) == 80_000


@pytest.mark.parametrize("dt", [1.91e-5, 1.9103e-5])
def test_paper_time_step_is_refused_with_the_reason(dt):
    message = refusal(lambda: make(schedule_dt=dt))
    assert message.startswith(f"schedule.dt = {dt:g} s is refused")
    assert "the paper prints this value" in message
    assert "100 times dx/c_p = 1.9103e-07 s" in message
    at_most = float(re.search(r"use at most (\S+) s", message)[1])
    assert make(schedule_dt=0.999 * at_most).dt == pytest.approx(0.999 * at_most)


@pytest.mark.parametrize("shape", [Linear(), Gimp(), QuadraticBSpline()], ids=lambda s: type(s).__name__)
def test_cfl_that_the_refusal_advises_is_accepted(shape):
    cfl = float(re.search(r"use cfl <= (\S+) with shape", refusal(lambda: make(shape=shape, schedule_cfl=5.0)))[1])
    assert make(shape=shape, schedule_cfl=cfl - 0.005).dt == pytest.approx((cfl - 0.005) * DX / SPEED, rel=1e-9)


def test_usl_with_linear_functions_is_refused_with_alternatives():
    message = refusal(lambda: make(order="usl"))
    assert "scene.order = 'usl' with Linear" in message and "'musl'" in message


def test_platen_off_the_grid_is_refused_with_the_nearest_plane():
    message = refusal(lambda: make(loading_boundaries=platens(position=0.1002)))
    nearest = float(re.search(r"the nearest is (\S+) m", message)[1])
    assert nearest == pytest.approx(0.1, abs=1e-12)


@pytest.mark.parametrize("move", [(-0.006, 0.0), (0.0051, 0.0), (0.0, -1e-4), (0.0, 1e-4)])
def test_body_outside_the_domain_is_refused_with_both_boxes(move):
    region = Box(lower=(0.0 + move[0], move[1]), upper=(0.05 + move[0], 0.1 + move[1]))
    message = refusal(lambda: make(bodies=body(region=region)))
    assert "bodies[0].region" in message and "outside the domain" in message and "-0.005" in message


def test_region_of_another_dimension_is_refused():
    message = refusal(lambda: make(bodies=body(region=Box(lower=(0.0,) * 3, upper=(0.01,) * 3))))
    assert "bodies[0].region has 3 dimensions, domain has 2" in message


def test_scene_without_material_is_refused():
    assert "scene.bodies = () is refused" in refusal(lambda: make(bodies=()))
    tiny = make(bodies=body(region=Disc(centre=(0.025, 0.05), radius=1e-5)))
    assert "bodies[0].region holds no particle" in refusal(tiny.particles)


def test_glued_slit_is_refused_when_particles_are_made():
    flaw = Slit(centre=(0.025, 0.05), length=0.015, width=0.5e-3, angle=45.0)
    region = Difference(whole=make().bodies[0].region, removed=(flaw,))
    assert "slit.width" in refusal(make(bodies=body(region=region)).particles)


@pytest.mark.parametrize(
    "build, words",
    [
        (lambda: make(schedule={}), "exactly one of strain_end"),
        (lambda: Schedule(strain_end=1e-3, t_end=1.0), "exactly one of strain_end"),
        (lambda: make(loading_boundaries=()), "two platens that face each other"),
        (lambda: make(loading_boundaries=platens(side="lower")), "two platens that face each other"),
        (lambda: make(schedule={"t_end": 1e-4}, loading={"start": Affine()}), "two platens that face each other"),
        (lambda: make(loading_start=Press(time=1e-3)), "give t_end, hold included"),
        (lambda: make(loading_width=None), "loading.width is missing"),
    ],
)
def test_loading_that_says_too_little_or_too_much_is_refused(build, words):
    assert words in refusal(build)


@pytest.mark.parametrize("name, value", [("stress", "20 MPa"), ("force", "1 MN/m")])
def test_a_platen_with_a_speed_is_given_a_load_by_what_its_refusal_says(name, value):
    load = {f"loading.boundaries.1.{name}": value}
    said = refusal(lambda: load_scene("intact", settings=load))
    assert f"platen.speed = -0.0025 is refused: it must be 0 beside a {name}" in said
    assert "set speed = 0" in said and "strain_end = none and t_end" in said
    still = {"loading.boundaries.1.speed": "0"}
    assert "give t_end, and set strain_end = none" in refusal(lambda: load_scene("intact", settings=load | still))
    scene = load_scene("intact", settings=load | still | {"strain_end": "none", "t_end": "1 ms"})
    assert scene.loading.boundaries[1].held
    both = {"loading.boundaries.1.stress": "20 MPa", "loading.boundaries.1.force": "20 N/m"}
    assert "set one of them to none" in refusal(lambda: load_scene("intact", settings=both | still))


def test_derived_numbers():
    scene = make(loading_time_scale=4.0)
    assert scene.wave_speed == pytest.approx(SPEED / 4.0, rel=1e-12)
    assert scene.density == pytest.approx(2600.0 * 16.0)
    assert scene.dt == pytest.approx(0.5 * DX * 4.0 / SPEED, rel=1e-12)
    assert scene.loading.strain_rate == pytest.approx(5e-3 / 0.1)
    assert scene.t_end == pytest.approx(1e-3 / 0.05)
    assert scene.steps == math.ceil(scene.t_end / scene.dt)
    # a smooth-step ramp of length T covers half of what full speed would: the end comes T/2 later
    ramp = make(loading_start=Ramp(time=1e-3))
    assert ramp.t_end == pytest.approx(1e-3 / 0.05 + 0.5e-3)
    assert isinstance(scene.elastic().rock.criterion, Unbreakable)
