"""What a run reports of its cracks, fragments and acoustic events: tables and numbers, also where nothing is there."""

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from broken_bands import SPACING, failures, history, lattice, scattered, snapshot, strip

from rsmpm_ti.analysis.fracture import measure_fracture
from rsmpm_ti.output.fracture_tables import write_fracture
from rsmpm_ti.records.files import write_csv, write_json
from rsmpm_ti.rock.criteria import MohrCoulomb
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.regions import Box, Difference, Slit
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule

FLAW = Slit(centre=(10e-3, 20e-3), length=8e-3, width=2e-3, angle=45.0)
ROCK = Rock(
    density=2600.0,
    elasticity=Hooke(E=17e9, nu=0.14),
    criterion=MohrCoulomb(cohesion=5.95e6, friction_angle=40.0, tensile_strength=2e6),
)


def scene(dim: int = 2, time_scale: float = 1.0) -> Scene:
    upper = (20e-3, 40e-3, 5e-3)[:dim]
    whole = Box(lower=(0.0,) * dim, upper=upper)
    return Scene(
        title="made up",
        domain=Domain(lower=(0.0,) * dim, upper=upper, dx=2.0 * SPACING),
        bodies=(Body(region=Difference(whole=whole, removed=(FLAW,)) if dim == 2 else whole),),
        rock=ROCK,
        loading=Loading(time_scale=time_scale),
        schedule=Schedule(t_end=1e-3),
    )


def broken_plate():
    """Failures and last state of a plate with a wing from each end of its flaw; the upper one cuts to the edge."""
    x = scattered(lattice((0.0, 0.0), (20e-3, 40e-3)))
    tips = [np.array(FLAW.centre) + sign * 4e-3 * FLAW.direction for sign in (1.0, -1.0)]
    wings = [strip(90.0, 14e-3, 3.0, start=tips[0]), strip(-90.0, 8e-3, 3.0, start=tips[1], seed=4)]
    time = np.concatenate([1e-3 * (k + 1) + 2e-6 * np.arange(len(wing)) for k, wing in enumerate(wings)])
    x = np.concatenate([x[~FLAW.contains(x)], *wings])
    ids = np.arange(len(x) - len(time), len(x))
    mode = np.zeros(len(x), dtype=np.int8)
    mode[ids] = 1
    for wing in wings:  # rock that the wings took the place of
        mode[(np.abs(x - wing.mean(axis=0)) <= 0.5 * np.ptp(wing, axis=0)).all(axis=1)] = 1
    return failures(x[ids], time=time, ids=ids), snapshot(x, mode)


def tables(out: Path) -> dict[str, list[dict[str, str]]]:
    found = {}
    for name in ("cracks", "fragments", "acoustic"):
        with open(out / f"{name}.csv", newline="") as file:
            reader = csv.DictReader(file)
            found[name] = list(reader)
            assert reader.fieldnames
    return found


def test_summary_and_tables_say_the_same(tmp_path):
    events, last = broken_plate()
    fracture = measure_fracture(scene(), history(), events, last)
    write_fracture(tmp_path.joinpath, fracture, history())
    numbers, found = fracture.numbers(), tables(tmp_path)
    cracks = found["cracks"]
    assert numbers["cracks"] == len(cracks) == 2
    assert numbers["crack_length_m"] == pytest.approx(sum(float(row["length_m"]) for row in cracks), rel=1e-9)
    assert numbers["crack_length_m"] == pytest.approx(22e-3, abs=4.0 * SPACING)
    assert [row["flaw_tip"] for row in cracks] == ["0+", "0-"] == [entry["tip"] for entry in numbers["initiation"]]
    assert [float(row["initiation_stress_Pa"]) for row in cracks] == pytest.approx([1e6, 2e6])
    assert [float(row["leaving_angle_deg"]) for row in cracks] == pytest.approx([45.0, 45.0], abs=3.0)
    assert numbers["initiation"][0]["angle_deg"] == pytest.approx(float(cracks[0]["leaving_angle_deg"]), rel=1e-9)
    assert numbers["fragments"] == len(found["fragments"])
    assert numbers["acoustic_events"] == len(found["acoustic"])
    assert [int(row["cumulative"]) for row in found["acoustic"]] == list(range(1, len(found["acoustic"]) + 1))
    energy = sum(float(row["energy_J"]) for row in found["acoustic"])
    assert energy == pytest.approx(events.released.sum(), rel=1e-9)
    stress = [float(row["nominal_stress_Pa"]) for row in found["acoustic"]]
    assert stress == sorted(stress) and stress[0] == pytest.approx(1e6)
    assert len(fracture.lines) == 2


def test_columns_carry_their_units(tmp_path):
    events, last = broken_plate()
    write_fracture(tmp_path.joinpath, measure_fracture(scene(), history(), events, last), history())
    bare = {
        "crack", "fragment", "particles", "failures", "tension_failures", "shear_failures", "cumulative", "magnitude",
        "initiation_mode", "initiation_strain", "flaw_tip", "tortuosity",
    }  # fmt: skip
    units = ("_m", "_m_s", "_s", "_Pa", "_J", "_kg", "_deg", "_share", "_over_rayleigh")
    for rows in tables(tmp_path).values():
        for name in rows[0]:
            assert name in bare or name.endswith(units), name


def test_mass_scaling_slows_waves_so_tip_speed_is_judged_by_the_scaled_rock():
    events, last = broken_plate()
    plain, scaled = (measure_fracture(scene(time_scale=k), history(), events, last) for k in (1.0, 8.0))
    assert scaled.rayleigh_speed == pytest.approx(plain.rayleigh_speed / 8.0)
    assert plain.rayleigh_speed == pytest.approx(1524.8, abs=0.05)
    assert scaled.fragments.total_mass == plain.fragments.total_mass  # a fragment weighs what the rock does
    # failures 2 us apart: a shear wave crosses 2.5 spacings in 0.37 us, in the scaled rock in 2.95 us
    assert len(plain.acoustic) == len(events)
    assert len(scaled.acoustic) < 0.5 * len(events)


@pytest.mark.parametrize("dim", [2, 3])
def test_run_without_failures_writes_headers_and_one_fragment(tmp_path, dim):
    x = lattice((0.0, 0.0), (5e-3, 5e-3))
    x = x if dim == 2 else np.concatenate([np.column_stack([x, np.full(len(x), z)]) for z in (0.0, SPACING)])
    fracture = measure_fracture(scene(dim), history(), failures(np.zeros((0, dim))), snapshot(x))
    write_fracture(tmp_path.joinpath, fracture, history())
    found = tables(tmp_path)
    assert found["cracks"] == found["acoustic"] == [] and len(found["fragments"]) == 1
    numbers = fracture.numbers()
    assert (numbers["cracks"], numbers["fragments"], numbers["b_value"]) == (0, 1, None)
    assert numbers["crack_length_m"] == (0.0 if dim == 2 else None)
    assert len(numbers["initiation"]) == (2 if dim == 2 else 0)
    write_json(tmp_path / "summary.json", numbers)  # refuses what is not finite


def test_solid_has_cracks_without_paths(tmp_path):
    flat = strip(0.0, 4e-3, 3.0, start=(0.0, 2e-3))
    x = np.concatenate([np.column_stack([flat, np.full(len(flat), z)]) for z in (0.0, SPACING)])
    events = failures(x)
    fracture = measure_fracture(scene(3), history(), events, snapshot(x, np.ones(len(x))))
    write_fracture(tmp_path.joinpath, fracture, history())
    (row,) = tables(tmp_path)["cracks"]
    assert row["length_m"] == row["aperture_mean_m"] == row["leaving_angle_deg"] == ""
    assert float(row["initiation_z_m"]) in (0.0, SPACING) and float(row["growth_m"]) > 3e-3
    assert fracture.lines == [] and fracture.numbers()["crack_length_m"] is None


def test_without_platens_nothing_has_a_stress(tmp_path):
    events, last = broken_plate()
    unloaded = history()
    for name in ("stress_top_Pa", "stress_bottom_Pa", "axial_strain"):
        unloaded[name] = np.nan
    for table in (unloaded, unloaded[:0]):
        fracture = measure_fracture(scene(), table, events, last)
        write_fracture(tmp_path.joinpath, fracture, table)
        found = tables(tmp_path)
        assert {row["initiation_stress_Pa"] for row in found["cracks"]} == {""}
        assert {row["nominal_stress_Pa"] for row in found["acoustic"]} == {""}
        write_json(tmp_path / "summary.json", fracture.numbers())
        assert json.loads((tmp_path / "summary.json").read_text())["initiation"][0]["stress_Pa"] is None


def test_unstable_run_is_measured_all_the_same(tmp_path):
    """Its last state holds particles that are not finite, failed ones among them."""
    events, last = broken_plate()
    x, u, v = last.x.copy(), last.displacement.copy(), last.velocity.copy()
    for sick in (x, u, v):
        sick[::7] = np.nan
    fracture = measure_fracture(scene(), history(), events, replace(last, x=x, displacement=u, velocity=v))
    write_fracture(tmp_path.joinpath, fracture, history())
    assert len(tables(tmp_path)["cracks"]) == 2
    write_json(tmp_path / "summary.json", fracture.numbers())


def test_table_leaves_what_is_not_known_empty(tmp_path):
    rows = [(1, 0.1, "a", None), (np.int64(2), np.float64("nan"), "", np.inf)]
    write_csv(tmp_path / "t.csv", ("n", "v_m", "name", "w"), rows)
    assert (tmp_path / "t.csv").read_text().split() == ["n,v_m,name,w", "1,0.1,a,", "2,,,"]
