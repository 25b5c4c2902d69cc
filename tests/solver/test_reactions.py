"""reactions.csv: forces of each boundary, by Newton's and Coulomb's laws, and how far it has gone."""

from dataclasses import replace

import numpy as np
import pytest

from rsmpm_ti import (
    Affine,
    Body,
    Box,
    Column,
    Domain,
    Fixed,
    Hooke,
    Linear,
    Loading,
    NoViscosity,
    Output,
    Platen,
    Rock,
    Scene,
    Schedule,
    Unbreakable,
    Wall,
    simulate,
)

DENSITY, DX, SIDE, FRICTION = 2600.0, 2e-3, 12e-3, 0.3
LOW, HIGH = (Platen(axis=1, side=s, position=p, speed=v) for s, p, v in (("lower", 0.0, 0.05), ("upper", SIDE, -0.05)))


def block(*boundaries, steps: int = 200, velocity=None, **loading) -> Scene:
    loading = Loading(boundaries=boundaries, width=SIDE, **loading)
    scene = Scene(
        title="block",
        domain=Domain(lower=(-SIDE, 0.0), upper=(3.0 * SIDE, SIDE), dx=DX),
        bodies=(Body(region=Box(lower=(0.0, 0.0), upper=(SIDE, SIDE)), velocity=velocity),),
        rock=Rock(
            density=DENSITY, elasticity=Hooke(E=17e9, nu=0.2), criterion=Unbreakable(), viscosity=NoViscosity()
        ),
        loading=loading,
        schedule=Schedule(t_end=1e-6, rows=20),
        shape=Linear(),
        output=Output(frames=0, movie=False, vtu=0),
    )  # fmt: skip
    return replace(scene, schedule=replace(scene.schedule, t_end=steps * scene.dt))


MOMENTUM = tuple(
    Column(
        name=f"momentum_{d}", unit="kg m/s", about="of all particles", value=lambda view, d=d: view.survey.momentum[d]
    )
    for d in range(2)
)


def test_forces_of_all_boundaries_are_what_changes_the_momentum():
    """Newton's second law, row by row, on two walls, a clamp and a body force: exact but for round-off."""
    names = ("b0_wall_y_lower", "b1_fixed_x_lower", "b2_wall_y_upper")
    walls = (Wall(axis=1, side=side, position=at) for side, at in (("lower", 0.0), ("upper", SIDE)))
    floor, ceiling = walls
    pull = (3e4, -5e4)
    result = simulate(
        block(floor, Fixed(axis=0, side="lower", position=0.0), ceiling, body_force=pull), threads=1, columns=MOMENTUM
    )
    rows, history = result.reactions, result.history
    assert rows["time_s"].tolist() == history["time_s"].tolist()
    for d, axis in enumerate("xy"):
        weight = DENSITY * SIDE**2 * pull[d]
        change = np.diff(history[f"momentum_{d}"], prepend=0.0) / np.diff(history["time_s"], prepend=0.0)
        total = sum(rows[f"{name}_force_{axis}_N"] for name in names)
        assert total + weight == pytest.approx(change, rel=1e-9, abs=1e-9 * abs(weight))
    assert np.array_equal(rows["b2_wall_y_upper_normal_N"], -rows["b2_wall_y_upper_force_y_N"])
    assert np.array_equal(rows["b1_fixed_x_lower_normal_N"], rows["b1_fixed_x_lower_force_x_N"])
    assert np.array_equal(rows["b1_fixed_x_lower_tangential_N"], np.abs(rows["b1_fixed_x_lower_force_y_N"]))
    assert np.abs(rows["b0_wall_y_lower_tangential_N"]).max() == 0.0, "walls are smooth"
    assert rows["b1_fixed_x_lower_tangential_N"].max() > 1.0


def test_friction_of_a_block_that_slides_is_that_of_coulomb():
    """Pressed on a rough platen by its weight and thrown along it: tangential force over normal force is friction."""
    floor = Platen(axis=1, side="lower", position=0.0, friction=FRICTION)
    result = simulate(block(floor, steps=100, velocity=(30.0, 0.0), body_force=(0.0, -1e6)), threads=1)
    normal, friction = (result.reactions[f"b0_platen_y_lower_{part}_N"] for part in ("normal", "tangential"))
    assert normal.min() > 0.0 and friction == pytest.approx(FRICTION * normal, rel=1e-9)
    assert np.array_equal(result.reactions["b0_platen_y_lower_force_x_N"], -friction), "it holds the block back"


def test_displacement_is_that_of_the_platens_and_their_forces_are_those_of_the_load_cell():
    result = simulate(block(LOW, HIGH, start=Affine()), threads=1)
    rows, history = result.reactions, result.history
    assert rows["b0_platen_y_lower_displacement_m"] == pytest.approx(0.05 * rows["time_s"], rel=1e-12)
    assert rows["b1_platen_y_upper_displacement_m"] == pytest.approx(-0.05 * rows["time_s"], rel=1e-12)
    assert np.array_equal(rows["b0_platen_y_lower_normal_N"], history["force_bottom_N"])
    assert np.array_equal(rows["b1_platen_y_upper_normal_N"], history["force_top_N"])


def test_file_holds_the_rows_and_is_not_there_without_boundaries(tmp_path):
    result = simulate(block(LOW, HIGH, start=Affine(), steps=20), out=tmp_path, threads=1)
    header, *lines = (tmp_path / "reactions.csv").read_text().split()
    assert tuple(header.split(",")) == result.reactions.dtype.names
    read = np.array([line.split(",") for line in lines], dtype=float)
    assert read == pytest.approx(np.array(result.reactions.tolist()), rel=1e-9)
    free = simulate(block(steps=20, velocity=(1.0, 0.0)), out=tmp_path, threads=1, overwrite=True)
    assert free.reactions is None and not (tmp_path / "reactions.csv").exists()
