"""Pressure on the wall of a hole, against Lame's thick ring, and the work that it does."""

from dataclasses import replace

import numpy as np
import pytest

from rsmpm_ti import (
    Apic,
    Body,
    Box,
    Difference,
    Disc,
    Domain,
    Gimp,
    HolePressure,
    Hooke,
    Jittered,
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
    load_scene,
    simulate,
)
from rsmpm_ti.cases.static_state import set_up
from rsmpm_ti.mpm.holes.press import press
from rsmpm_ti.mpm.nodes import clear_nodes
from rsmpm_ti.mpm.stepper import LOAD, scatter_all
from rsmpm_ti.run.warnings import walls_moved
from rsmpm_ti.solver.readout import take_snapshot
from rsmpm_ti.spec.scene_json import from_plain, to_plain

E, NU, DENSITY, INNER, OUTER, P = 17e9, 0.14, 2600.0, 10e-3, 30e-3, 10e6
ROCK = Rock(density=DENSITY, elasticity=Hooke(E=E, nu=NU), criterion=Unbreakable(), viscosity=NoViscosity())
HOLE = Disc(centre=(0.0, 0.0), radius=INNER)
FITTED = Lattice(fitted=True)


def ring(dx: float, *, whole: bool = False, seeding=FITTED, turn: float = 0.0, steps: int = 1, **changes) -> Scene:
    """A quarter of a ring between two mirror planes, or all of it, with the pressure P on its hole."""
    parts = {name: changes.pop(name) for name in ("shape", "order", "transfer") if name in changes}
    loading = {"holes": (HolePressure(region=HOLE, times=(0.0,), pressures=(P,)),), "settle": True} | changes
    region = Difference(whole=Disc(centre=(0.0, 0.0), radius=OUTER), removed=(HOLE,))
    walls, lower = (), 2 * (-OUTER - 4.0 * dx,)
    if not whole:
        everywhere = Box(lower=(-1.0, -1.0), upper=(1.0, 1.0))
        outside = Difference(whole=everywhere, removed=(region,))
        region = Difference(whole=Box(lower=(0.0, 0.0), upper=(OUTER, OUTER)), removed=(outside,))
        walls, lower = tuple(Wall(axis=axis, side="lower", position=0.0) for axis in (0, 1)), (0.0, 0.0)
    scene = Scene(
        title="ring",
        domain=Domain(lower=lower, upper=2 * (OUTER + 4.0 * dx,), dx=dx, turn=turn),
        bodies=(Body(region=region, seeding=seeding),),
        rock=ROCK,
        loading=Loading(boundaries=walls, **loading),
        schedule=Schedule(t_end=1.0),
        output=Output(frames=0, movie=False, vtu=0),
        **parts,
    )
    return replace(scene, schedule=replace(scene.schedule, t_end=steps * scene.dt))


def lame(r: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Radial and hoop stress [Pa] and radial displacement [m] of a ring in plane strain; Jaeger et al. (2007), 8.62."""
    c = P * INNER**2 / (OUTER**2 - INNER**2)
    return (
        c * (1.0 - OUTER**2 / r**2),
        c * (1.0 + OUTER**2 / r**2),
        (1.0 + NU) / E * c * ((1.0 - 2.0 * NU) * r + OUTER**2 / r),
    )


def errors(scene: Scene) -> dict[str, float]:
    """Of the settled ring, against Lame: root mean squares over P or the wall's displacement, and means at the wall."""
    snapshot = simulate(scene, threads=1).snapshot
    x = snapshot.x - snapshot.displacement
    r = np.hypot(*x.T)
    radial, sigma = x / r[:, None], snapshot.sigma[:, :2, :2]
    across = np.stack([-radial[:, 1], radial[:, 0]], axis=1)
    s_rr, s_tt = (np.einsum("pi,pij,pj->p", n, sigma, n) for n in (radial, across))
    u = np.sum(snapshot.displacement * radial, axis=1)
    (e_rr, e_tt, e_u), wall = lame(r), r < INNER + scene.domain.dx
    return {
        "radial": float(np.sqrt(np.mean((s_rr - e_rr) ** 2)) / P),
        "hoop": float(np.sqrt(np.mean((s_tt - e_tt) ** 2)) / P),
        "moved": float(np.sqrt(np.mean((u - e_u) ** 2)) / e_u.max()),
        "wall_hoop": float(s_tt[wall].mean() / e_tt[wall].mean() - 1.0),
        "wall_moved": float(u[wall].mean() / e_u[wall].mean() - 1.0),
    }


def test_pressed_ring_is_that_of_lame_the_better_the_finer():
    """Second order in the displacement but for the seeding of curved edges; stress of particles of a cut cell is first
    order, and settled to 1e-4."""
    coarse, fine = errors(ring(2e-3)), errors(ring(1e-3))
    assert fine["moved"] < 0.4 * coarse["moved"] and fine["moved"] < 0.004
    assert abs(fine["wall_moved"]) < 0.01 and abs(fine["wall_hoop"]) < 0.03
    assert fine["radial"] < 0.8 * coarse["radial"] and fine["hoop"] < coarse["hoop"] and fine["hoop"] < 0.015


@pytest.mark.thorough
@pytest.mark.parametrize(
    "changes",
    [{"order": "usl"}, {"shape": Linear()}, {"shape": Gimp()}, {"transfer": Apic()}, {"time_scale": 5.0},
     {"seeding": Jittered(fitted=True)}, {"seeding": Lattice()}, {"whole": True}],
    ids=repr,
)  # fmt: skip
def test_whatever_the_method_the_wall_moves_by_as_much(changes):
    """Within what five cells over the radius resolve; stairs of whole sub-cells make the hole a third of one larger."""
    assert abs(errors(ring(2e-3, **changes))["wall_moved"]) < 0.05


PULSE = HolePressure(region=HOLE, times=(1e-5, 2e-5, 4e-5), pressures=(P, P, 0.3 * P))


def pulsed(order: str = "musl", **changes) -> Scene:
    scene = ring(1.5e-3, holes=(PULSE,), settle=False, order=order, **changes)
    return replace(scene, schedule=Schedule(t_end=6e-5, cfl=0.3))


@pytest.mark.parametrize("order", ["musl", "usf", "usl"])
def test_its_work_is_what_the_ring_has(order):
    """Of waves as long as the ring is thick; first order in the step, that a lumped mass and the mapping back take."""
    history = simulate(pulsed(order), threads=1).history
    energy = history["energy_kinetic_J"] + history["energy_elastic_J"] + history["energy_dissipated_J"]
    assert np.abs(energy - history["work_J"]).max() < 0.005 * history["work_J"].max()
    assert 0.2 * history["work_J"].max() < history["work_J"][-1] < 0.9 * history["work_J"].max()  # some comes back


@pytest.mark.parametrize("changes", [{}, {"turn": 20.0}, {"seeding": Jittered(fitted=True)}], ids=repr)
def test_pressure_in_a_hole_pushes_nothing_away(changes):
    """Forces of a closed wall sum to nothing, but for the part of a wall's force below which nodes are left out."""
    result = simulate(pulsed(whole=True, **changes), threads=1)
    momentum = np.abs((result.snapshot.volume[:, None] * result.snapshot.velocity).sum(axis=0))
    there = (result.snapshot.volume * np.linalg.norm(result.snapshot.velocity, axis=1)).sum()
    assert momentum.max() < 1e-3 * there


@pytest.fixture
def pressed(taichi_f64):
    return set_up(replace(ring(2e-3), loading=replace(ring(2e-3).loading, holes=(PULSE, PULSE))))


@pytest.mark.parametrize("time", [0.0, 4e-6, 1e-5, 1.5e-5, 3e-5, 4e-5, 1.0])
def test_pressure_follows_its_table(pressed, time):
    press(pressed.sim, time)
    expected = np.interp(time, (0.0, *PULSE.times), (0.0, *PULSE.pressures))
    assert PULSE.pressure(time) == pytest.approx(expected, abs=1e-6)
    assert pressed.sim.walls.load.to_numpy() == pytest.approx(np.full(2, expected), abs=1e-6)


def test_force_on_a_quarter_of_a_wall_is_pressure_times_its_width(pressed):
    """p R along each axis, of a quarter, and the mirror planes take no part in it."""
    clear_nodes(pressed.sim)
    scatter_all(pressed.sim, LOAD, 0.0)
    press(pressed.sim, 1e-5)
    force = pressed.sim.walls.force.to_numpy().sum(axis=0)
    assert force == pytest.approx(2.0 * np.full(2, P * INNER), rel=0.01)


def test_without_a_hole_nothing_is_held(taichi_f64):
    scene = ring(2e-3)
    walls = set_up(replace(scene, loading=replace(scene.loading, holes=()))).sim.walls
    assert walls.holes == 0 and not hasattr(walls, "node")


def test_wall_that_has_moved_too_far_is_said(pressed):
    """By intact rock beside it, and against the grid, which may go with platens."""
    sim, frame = pressed.sim, pressed.sim.grid.state()["grid_frame"]
    start = take_snapshot(sim, 0.0)
    away = start.x + 1.2e-3 * start.x / np.linalg.norm(start.x, axis=1, keepdims=True)
    moved = replace(start, x=away, displacement=away - start.x)
    assert walls_moved(sim.scene, start, frame) == []
    said = walls_moved(sim.scene, moved, frame)
    assert len(said) == 2 and said[1].startswith("the wall of holes[1] has moved by 0.6 cells")
    assert walls_moved(sim.scene, replace(moved, failure_mode=np.ones_like(start.failure_mode)), frame) == []


def test_it_is_recorded_and_read_back():
    assert from_plain(to_plain(pulsed())) == pulsed()


def test_its_pressures_take_units():
    scene = load_scene("blast_hole", quick=True, settings={"loading.holes.0.times": "0s",
                                                           "loading.holes.0.pressures": "2 MPa"})  # fmt: skip
    assert scene.loading.holes[0].pressures == (2e6,) and scene.loading.holes[0].times == (0.0,)


BESIDE = Disc(centre=(0.5, 0.5), radius=INNER)


@pytest.mark.parametrize(
    ("changes", "named"),
    [
        ({"times": (2e-5, 1e-5, 3e-5)}, "hole_pressure.times"),
        ({"times": (1e-5,)}, "hole_pressure.pressures"),
        ({"pressures": (P, -P, 0.0)}, "compression positive"),
        ({"times": (), "pressures": ()}, "hole_pressure.times"),
        ({"times": (-1e-5, 1e-5, 3e-5)}, "hole_pressure.times"),
        ({"region": BESIDE}, "a region in the domain"),
        ({"region": Disc(centre=(0.0, 0.0, 0.0), radius=INNER)}, "3 dimensions"),
        ({"region": Disc(centre=(0.0, 0.0), radius=INNER + 2e-3)}, "without rock"),
        ({"region": Disc(centre=(0.0, 0.0), radius=0.5 * INNER)}, "no wall"),
        ({"region": Disc(centre=(5e-3, 5e-3), radius=1e-7)}, "at least one particle large"),
    ],
)
def test_pressure_that_cannot_be_is_refused_before_anything_compiles(changes, named):
    with pytest.raises(SceneError) as refused:
        scene = ring(2e-3, holes=(replace(PULSE, **changes),))
        scene.particles()
    assert named in str(refused.value) and "\n" not in str(refused.value)
