"""A whole run from the command line: every file it promises, the recorded scene run again, and how it ends early."""

import csv
import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import imageio.v3 as imageio
import meshio
import numpy as np
import pytest

from rsmpm_ti import load_scene, simulate
from rsmpm_ti.errors import UnstableRun
from rsmpm_ti.records.history_table import HISTORY_COLUMNS
from rsmpm_ti.records.progress import Progress
from rsmpm_ti.records.snapshot import PARTICLES
from rsmpm_ti.records.summary_table import RECORD, SUMMARY
from rsmpm_ti.scene import main

SMALL = ["--set", "dx=0.002", "--set", "flaw_width=0.006", "--set", "time_scale=16", "--frames", "4"]


@pytest.fixture(scope="module")
def run_folder(tmp_path_factory) -> Path:
    out = tmp_path_factory.mktemp("cube")
    assert main(["cube", *SMALL, "--out", str(out), "--threads", "1"]) == 0
    return out


def table(path: Path) -> list[dict[str, str]]:
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def test_every_promised_file_is_written(run_folder):
    names = {str(p.relative_to(run_folder)) for p in run_folder.rglob("*") if p.is_file()}
    for expected in (
        "frames/stress_0000.png", "frames/cracks_0000.png", "frames/stress_0004.png", "cube.mp4", "summary.png",
        "history.csv", "reactions.csv", "frames.csv", "events.csv", "cracks.csv", "fragments.csv", "acoustic.csv",
        "particles_0000.vtu", "particles_0010.vtu", "particles.pvd", "scene.json", "summary.json", "checkpoint.npz",
    ):  # fmt: skip
        assert expected in names
    assert not [n for n in names if ".part" in n]


def test_history_and_events_hold_what_the_summary_says(run_folder):
    summary = json.loads((run_folder / "summary.json").read_text())
    history, events = table(run_folder / "history.csv"), table(run_folder / "events.csv")
    assert tuple(history[0]) == HISTORY_COLUMNS
    assert list(events[0]) == [
        "time_s", "true_time_s", "x_m", "y_m", "mode", "sigma_1_Pa", "sigma_3_Pa", "released_energy_J"
    ]  # fmt: skip
    assert len(events) == summary["failed_tension"] + summary["failed_shear"] > 0
    assert float(history[-1]["failed_tension"]) == summary["failed_tension"]
    assert summary["steps"] * summary["dt_s"] == pytest.approx(2.5e-4 / 0.05, rel=2e-3)  # strain over its rate
    assert float(history[-1]["axial_strain"]) == pytest.approx(2.5e-4, rel=2e-3)  # whole steps only
    stress = [0.5 * (float(r["stress_top_Pa"]) + float(r["stress_bottom_Pa"])) for r in history]
    assert max(stress) == pytest.approx(summary["largest_stress_Pa"], rel=1e-9)
    times = [float(e["time_s"]) for e in events]
    assert times == sorted(times)
    for e in events:
        if e["mode"] == "tension":
            assert float(e["sigma_1_Pa"]) >= 2e6  # recorded at the moment of failure, not after it
    assert all(float(e["released_energy_J"]) > 0.0 for e in events)


def test_cracks_fragments_and_acoustic_events_hold_what_the_summary_says(run_folder):
    summary = json.loads((run_folder / "summary.json").read_text())
    events = table(run_folder / "events.csv")
    cracks, acoustic = table(run_folder / "cracks.csv"), table(run_folder / "acoustic.csv")
    assert summary["cracks"] == len(cracks) >= 2
    assert {"0+", "0-"} <= {row["flaw_tip"] for row in cracks}
    assert sum(int(row["failures"]) for row in acoustic) == len(events)
    released = sum(float(event["released_energy_J"]) for event in events)
    assert sum(float(row["energy_J"]) for row in acoustic) == pytest.approx(released, rel=1e-6)
    # on a lattice both tips may crack at the same time
    place = pytest.approx(summary["first_failure_position_m"])
    (first,) = (entry for entry in summary["initiation"] if entry["position_m"] == place)
    assert first["time_s"] == summary["first_failure_time_s"]
    # one is read between the rows around the failure, the other extrapolated from four rows before it
    assert first["stress_Pa"] == pytest.approx(summary["first_failure_stress_Pa"], rel=0.01)
    # wings are in tension: they open, and by less than the platens have moved
    opened = [float(row["aperture_max_m"]) for row in cracks if row["flaw_tip"]]
    assert all(0.0 < aperture < 2.5e-4 * 0.1 for aperture in opened)
    mass = sum(float(row["mass_kg"]) for row in table(run_folder / "fragments.csv"))
    intact = np.mean(meshio.read(run_folder / "particles_0010.vtu").point_data["failure_mode"] == 0)
    # kg per metre: the specimen without flaw (in stairs of half a 2 mm cell) and failed particles, strained by 2.5e-4
    assert mass == pytest.approx(2600.0 * (0.05 * 0.1 - 0.015 * 0.006) * intact, rel=0.01)


def test_vtu_files_carry_the_promised_fields_and_the_cracks(run_folder):
    mesh = meshio.read(run_folder / "particles_0010.vtu")
    assert set(mesh.point_data) == {
        "id", "displacement", "velocity", "stress", "sigma_1", "sigma_3", "failure_mode", "failure_time", "volume",
        "strength_factor", "margin", "governs", "damage", "aperture_m",
    }  # fmt: skip
    summary = json.loads((run_folder / "summary.json").read_text())
    assert len(mesh.points) == summary["particles"]
    failed = mesh.point_data["failure_mode"] > 0
    assert failed.sum() == summary["failed_tension"] + summary["failed_shear"]
    assert np.isfinite(mesh.point_data["failure_time"][failed]).all()
    assert np.isnan(mesh.point_data["failure_time"][~failed]).all()
    stress = mesh.point_data["stress"].reshape(-1, 3, 3).astype(float)
    assert np.allclose(np.linalg.eigvalsh(stress)[:, 2], mesh.point_data["sigma_1"], atol=1.0)
    assert (
        np.abs(stress[failed] - np.trace(stress[failed], axis1=1, axis2=2)[:, None, None] / 3 * np.eye(3)).max() < 1e-6
    )


def test_vtu_files_say_when_they_are_of_at_which_load_and_what_codes_mean(run_folder):
    history = table(run_folder / "history.csv")
    field = {name: float(value[0]) for name, value in meshio.read(run_folder / "particles_0010.vtu").field_data.items()}
    last = history[-1]
    stress = 0.5 * (float(last["stress_top_Pa"]) + float(last["stress_bottom_Pa"]))
    expected = {name: float(last[name]) for name in ("time_s", "true_time_s", "axial_strain")}
    expected |= {"nominal_stress_Pa": stress, "failure_mode_intact": 0, "failure_mode_tension": 1}
    assert field == pytest.approx(expected | {"failure_mode_shear": 2}, rel=1e-9)
    assert field["true_time_s"] == pytest.approx(field["time_s"] / 16.0, rel=1e-12)
    start = meshio.read(run_folder / "particles_0000.vtu")
    assert "nominal_stress_Pa" not in start.field_data, "before the first row it is not known"
    end = meshio.read(run_folder / "particles_0010.vtu").point_data["id"]
    assert (np.diff(end) > 0).all() and np.isin(end, start.point_data["id"]).all()
    text = (run_folder / "particles_0010.vtu").read_text()
    ElementTree.fromstring(text)
    assert all(f"{column.name} [{column.unit}]" in text for column in PARTICLES.columns)


@pytest.mark.thorough
def test_what_is_not_known_is_no_number(run_folder):
    """No opening by the paper's rule, no margin where nothing breaks: NaN, where there was 0 and 1."""
    data = meshio.read(run_folder / "particles_0010.vtu").point_data
    assert np.isnan(data["aperture_m"]).all() and np.isfinite(data["margin"]).all()
    scene = load_scene("intact", dx=5e-3, settings={"strain_end": None, "t_end": 1e-5}).elastic()
    snapshot = simulate(scene, threads=1).snapshot
    assert np.isnan(snapshot.margin).all() and np.isnan(snapshot.aperture).all()


def test_every_key_of_the_summary_is_declared_with_its_unit(run_folder):
    summary = json.loads((run_folder / "summary.json").read_text())
    assert list(summary) + [f"initiation[].{key}" for key in summary["initiation"][0]] == sorted(
        SUMMARY.names, key=lambda name: (name.startswith("initiation[]"), SUMMARY.names.index(name))
    )
    assert set(json.loads((run_folder / "scene.json").read_text())) == set(RECORD.names)


def test_movie_has_one_picture_per_frame(run_folder):
    frames = len(list((run_folder / "frames").glob("stress_*.png")))
    assert imageio.improps(run_folder / "cube.mp4", plugin="FFMPEG").shape[1] % 2 == 0
    assert sum(1 for _ in imageio.imiter(run_folder / "cube.mp4", plugin="FFMPEG")) == frames


def test_recorded_scene_runs_again_to_the_same_numbers(run_folder, tmp_path):
    assert main([str(run_folder / "scene.json"), "--out", str(tmp_path), "--threads", "1", "--frames", "0"]) == 0
    # one thread and the same scene: the same additions in the same order
    assert (tmp_path / "events.csv").read_text() == (run_folder / "events.csv").read_text()
    assert (tmp_path / "history.csv").read_text() == (run_folder / "history.csv").read_text()


def test_energy_ledger_balances_through_failure(run_folder):
    """kinetic + elastic + dissipated = work + what the start gave, within 2 % of the work.

    docs/references.md, section 16.
    """
    summary = json.loads((run_folder / "summary.json").read_text())
    assert summary["failed_tension"] > 10
    assert summary["energy_balance_error_elastic"] < 0.02
    assert summary["energy_balance_error"] < 0.02


def test_quasi_static_measures_are_small(run_folder):
    summary = json.loads((run_folder / "summary.json").read_text())
    assert summary["platen_imbalance"] < 0.01


@pytest.mark.thorough
def test_unstable_run_says_where_and_keeps_what_there_is(tmp_path):
    """A particle is made sick during the run: exit as UnstableRun, with step and place, files written."""
    scene = load_scene("intact", dx=5e-3, strain_end=1e-3)

    def spoil(progress: Progress) -> None:
        if progress.fraction > 0.1:
            spoil.run.sim.particles.v.fill(float("nan"))

    import rsmpm_ti.run.run as module

    settings = module.Settings(name="intact", threads=1, progress=spoil)
    spoil.run = module.Run(scene, scene.particles(), module.prepare(scene, tmp_path), settings, module.Interrupt())
    with pytest.raises(UnstableRun, match=r"not finite or left the domain at step \d+, t = .* mm"):
        spoil.run.go()
    assert len(table(tmp_path / "history.csv")) > 10
    assert "not finite" in json.loads((tmp_path / "summary.json").read_text())["stopped"]


def test_module_runs_as_a_command():
    done = subprocess.run(
        [sys.executable, "-m", "rsmpm_ti.scene", "--list"], capture_output=True, text=True, timeout=120, check=False
    )
    assert done.returncode == 0
    assert "cube" in done.stdout and "flaw_angle" in done.stdout and "Taichi" not in done.stdout


@pytest.mark.thorough
def test_a_flying_fragment_is_sorted_before_it_leaves_its_slabs_reach():
    """One particle in a hundred moves: too few to be sorted for their share, so they must be for their distance."""
    from rsmpm_ti.fields.parallel import REACH
    from rsmpm_ti.rock.criteria import Unbreakable
    from rsmpm_ti.rock.elasticity import Hooke
    from rsmpm_ti.rock.rock import Rock
    from rsmpm_ti.solver.survey import survey
    from rsmpm_ti.spec.domain import Domain
    from rsmpm_ti.spec.regions import Box
    from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule

    big = Body(region=Box(lower=(0.0, 0.0), upper=(0.02, 0.02)))
    small = Body(region=Box(lower=(0.03, 0.01), upper=(0.032, 0.012)), velocity=(200.0, 0.0))
    scene = Scene(
        title="fragment",
        domain=Domain(lower=(0.0, 0.0), upper=(0.05, 0.02), dx=1e-3),
        bodies=(big, small),
        rock=Rock(density=2600.0, elasticity=Hooke(E=17e9, nu=0.14), criterion=Unbreakable()),
        loading=Loading(),
        schedule=Schedule(t_end=6e-5, rows=20),
    )
    farthest = 0

    def look(progress: Progress) -> None:
        nonlocal farthest
        sim = look.run.sim
        row = sim.particles.key.to_numpy() // sim.grid.nodes[1]
        x = sim.particles.reference.to_numpy()[:, 0] + sim.particles.u.to_numpy()[:, 0]
        now = np.floor((x - sim.grid.origin[0]) / 1e-3 - sim.shape.shift)
        farthest = max(farthest, int(np.abs(now - row).max()))

    import rsmpm_ti.run.run as module

    look.run = module.Run(scene, scene.particles(), None, module.Settings(threads=1, progress=look), module.Interrupt())
    result = look.run.go()
    assert result.snapshot.displacement[-1, 0] > 0.01  # it has crossed more than ten cells
    assert farthest <= REACH - scene.shape.width  # the rows by which particles may stray
    assert survey(look.run.sim).sick == 0


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.thorough("2")
def test_run_in_which_nothing_fails_knows_no_onset(threads):
    """Several threads take a minimum of times, and made the largest number that there is of one that never comes."""
    scene = load_scene("cube", dx=2e-3, flaw_width=6e-3, time_scale=16.0, strain_end=5e-5)
    result = simulate(replace(scene, schedule=replace(scene.schedule, rows=10)), threads=threads)
    assert len(result.events) == 0 and result.events.onset == np.inf
    assert [result.summary[name] for name in ("onset_stress_Pa", "onset_strain", "first_failure_stress_Pa")] == 3 * [
        None
    ]
    assert "0 failures" in repr(result) and "\n" not in repr(result)
