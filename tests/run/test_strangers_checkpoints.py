"""Checkpoints that a stranger wrote, or a failing disk: one line each, the one before, and never a wild write."""

import io
import json
import os
import shutil
import warnings
import zipfile
from pathlib import Path

import crafted
import numpy as np
import pytest
from hostile import clear, quickly
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hypothesis_numpy

from rsmpm_ti.errors import RockWarning, SceneError
from rsmpm_ti.output import manifest
from rsmpm_ti.output.files import CHECKPOINTS
from rsmpm_ti.run import checkpoint
from rsmpm_ti.run.kept import reading
from rsmpm_ti.run.run import simulate
from rsmpm_ti.run.settings import Settings
from rsmpm_ti.scene import build, main, parser

RUN = [
    *("cube", "--set", "dx=0.002", "--set", "flaw_width=0.006", "--set", "shape=Linear", "--set", "time_scale=16"),
    *("--set", "turn=0"),  # platens that push have states of their nodes
    *("--set", "bodies.0.seeding=Lattice", "--set", "schedule.rows=60", "--frames", "1", "--no-movie"),
    *("--set", "output.vtu=1", "--threads", "1"),
]


@pytest.fixture(scope="module")
def scene():
    return build(parser().parse_args(RUN))


@pytest.fixture(scope="module")
def seeds(scene):
    return scene.particles()


@pytest.fixture(scope="module")
def stopped(scene, tmp_path_factory) -> Path:
    """The folder of a run in which rock has failed, and of which a fifth is still to come."""
    out = tmp_path_factory.mktemp("stopped")

    def stop(progress) -> None:
        if progress.fraction > 0.8:
            os.kill(os.getpid(), 2)

    result = simulate(scene, out=out, threads=1, progress=stop)
    assert result.signal == 2 and len(result.events.time) > 20
    return out


@pytest.fixture(scope="module")
def sound(stopped) -> dict[str, np.ndarray]:
    """Arrays of its checkpoint."""
    with np.load(stopped / CHECKPOINTS[0], allow_pickle=False) as file:
        return {name: file[name] for name in file.files}


def refused(folder: Path, scene, seeds) -> str:
    """The one line in which all checkpoints of a folder are refused; "" where one is accepted."""
    try:
        with quickly(), warnings.catch_warnings():
            warnings.simplefilter("ignore", RockWarning)
            checkpoint.read(folder, scene, seeds, Settings(threads=1))
    except SceneError as error:
        message = str(error)
        assert clear(message) and CHECKPOINTS[0] in message, message
        assert "pickle" not in message
        return message
    return ""


def test_a_sound_one_is_accepted(sound, scene, seeds, tmp_path):
    (tmp_path / CHECKPOINTS[0]).write_bytes(crafted.archive(sound))
    assert refused(tmp_path, scene, seeds) == ""


def emptied(name: str, number: float):
    return lambda arrays: {name: np.full_like(arrays[name], number)}


def first(name: str, number: float):
    def change(arrays):
        values = arrays[name].copy()
        values.reshape(-1)[0] = number
        return {name: values}

    return change


def more_events(arrays):
    """As many as make kernels write behind the end, where nobody looks."""
    count = 3 * len(arrays["particle_key"])
    names = [name for name in arrays if name.startswith("event_") and name not in ("event_by_mode", "event_onset")]
    return {name: np.resize(arrays[name], (count, *arrays[name].shape[1:])) for name in names}


def text(change):
    def changed(arrays):
        held = json.loads(str(arrays["text"]))
        change(held["progress"])
        return {"text": np.array(json.dumps(held))}

    return changed


def swapped(*names: str):
    """Two particles that lie in one row of cells change places, in some of the fields."""
    return lambda arrays: {name: np.concatenate((arrays[name][1::-1], arrays[name][2:])) for name in names}


ATTACKS = {
    "events beyond their room": (more_events, "has .* events, and 4906 particles have at most 4906"),
    "failed particles are whole": (emptied("particle_whole_1", 0), "particles that have failed are whole"),
    "no such failure": (first("particle_whole_1", 7), "failed in no known way"),
    "two particles of one number": (first("particle_whole_0", 5), "do not have each number once"),
    "numbers in another order": (swapped("particle_whole_0"), "did not start where the scene's do"),
    "a cell that is not there": (emptied("particle_key", 2**31 - 1), "cells that are not there"),
    "cells of other particles": (emptied("particle_key", 0), "far from the cells"),
    "a particle out of the grid": (first("particle_real_2", 1e3), "out of the grid"),
    "speed of nobody": (first("particle_real_4", 50.0), "particles go at other speeds"),
    "rock of no volume": (first("particle_real_11", 0.0), "no volume"),
    "a grid without spacing": (emptied("grid_frame", 0.0), "grid does not lie where"),
    "a grid that has met itself": (first("grid_travel", 50.0), "sides of its grid have gone"),
    "a step of no length": (emptied("clock_dt", 0.0), "its step is 0 s"),
    "steps without end": (emptied("clock_total", 10**9), "its clock and its end disagree"),
    "a step before the first": (emptied("clock_step", -5), "steps"),
    "a ledger of nothing": (first("ledger_impulse", np.nan), "ledger_impulse is not finite"),
    "an event of nobody": (first("event_id", 10**6), "particles that are not there"),
    "an event to come": (first("event_time", 1e3), "events are of another time"),
    "an event before rock fails": (first("event_time", 5e-324), "events are of another time"),
    "instruments that read nonsense": (emptied("history_zero", 1e300), "instruments are not finite"),
    "other counts": (first("event_by_mode", 4), "counts other events"),
    "nodes in no state": (first("contact_0", 9), "no state of nodes"),
    "a file of another name": (
        text(lambda p: p["observers"][2]["own"].update(entries=[[0.0, "../../stolen.vtu"]])),
        "particle files have other names",
    ),
    "frames without end": (text(lambda p: p["observers"][1]["own"].update(count=10**12)), "frames are not counted"),
    "observers too many": (text(lambda p: p["observers"].append({})), "other observers"),
    "time of NaN": (text(lambda p: p.update(wall_s=float("nan"))), "wall time"),
}


@pytest.mark.parametrize("name", ATTACKS)
def test_numbers_that_no_run_has_are_refused_by_what_is_wrong(sound, scene, seeds, tmp_path, name):
    change, reason = ATTACKS[name]
    (tmp_path / CHECKPOINTS[0]).write_bytes(crafted.archive(sound | change(sound)))
    message = refused(tmp_path, scene, seeds)
    with pytest.raises(SceneError, match=reason):
        raise SceneError(message)


def test_a_damaged_one_is_passed_over_in_one_line_by_the_command(sound, stopped, tmp_path, capsys):
    shutil.copytree(stopped, tmp_path, dirs_exist_ok=True)
    (tmp_path / CHECKPOINTS[0]).write_bytes(crafted.archive(sound | more_events(sound)))
    (tmp_path / CHECKPOINTS[1]).write_bytes(crafted.archive(sound))
    with open(tmp_path / manifest.FILE, "a") as file:
        file.write(f"{CHECKPOINTS[1]}\n")
    assert main([*RUN, "--out", str(tmp_path), "--resume"]) == 0
    said = [line for line in capsys.readouterr().err.splitlines() if "damaged" in line]
    assert len(said) == 1 and said[0].startswith("rsmpm_ti: warning: ") and said[0].endswith(f"from {CHECKPOINTS[1]}")
    for name in CHECKPOINTS:  # neither is the damaged one: the good one before it was not overwritten by it
        if (tmp_path / name).exists():
            with np.load(tmp_path / name) as kept:
                assert len(kept["event_time"]) <= kept["particle_key"].size * 2


def test_what_is_no_file_of_the_folder_is_never_opened(sound, scene, seeds, tmp_path):
    """A FIFO would be waited for without end; a link may lead to a device, or to what is not the run's."""
    (tmp_path / "out").mkdir()
    path, elsewhere = tmp_path / "out" / CHECKPOINTS[0], tmp_path / "elsewhere.npz"
    elsewhere.write_bytes(crafted.archive(sound))
    kinds = {
        "no regular file": [lambda: os.mkfifo(path), path.mkdir],
        "a link out of the folder": [lambda: path.symlink_to(elsewhere), lambda: path.symlink_to("/dev/zero")],
    }
    for reason, makings in kinds.items():
        for make in makings:
            make()
            assert reason in refused(tmp_path / "out", scene, seeds)
            path.rmdir() if path.is_dir() else path.unlink()
    path.symlink_to(CHECKPOINTS[1])
    (tmp_path / "out" / CHECKPOINTS[1]).write_bytes(crafted.archive(sound))
    assert refused(tmp_path / "out", scene, seeds) == "", "a link within the folder is the user's own"


def test_a_small_file_stays_small(sound, scene, seeds, tmp_path, monkeypatch):
    """What is packed, and what says to be larger than the file, is refused before it is read."""
    read = []
    monkeypatch.setattr(reading.StoredArrays, "read", lambda self, name: read.append(name))
    for packed in (zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA):
        (tmp_path / CHECKPOINTS[0]).write_bytes(crafted.archive({"text": np.zeros(1_000_000)}, packed))
        assert "it is compressed" in refused(tmp_path, scene, seeds)
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as claiming:
        claiming.writestr("text.npy", crafted.claiming("(10000000000,)"))
    (tmp_path / CHECKPOINTS[0]).write_bytes(file.getvalue())
    assert "array text of 80000000000 bytes has 0" in refused(tmp_path, scene, seeds)
    assert not read


@settings(max_examples=100, derandomize=True, deadline=None)
@given(
    hypothesis_numpy.arrays(hypothesis_numpy.scalar_dtypes(), hypothesis_numpy.array_shapes(min_dims=0, max_dims=3)),
    st.booleans(),
)
def test_arrays_of_users_come_back_as_they_were(values, by_columns):
    """What an observer remembers may be of any kind of numbers or texts, and lie either way."""
    values, file = np.asfortranarray(values) if by_columns else values, io.BytesIO()
    np.savez(file, observer_3_own=values)
    back = reading.StoredArrays(file).read("observer_3_own")
    assert back.dtype == values.dtype and back.tobytes("F") == values.tobytes("F") and back.flags.writeable


def test_what_memory_cannot_hold_is_not_read(sound, scene, seeds, tmp_path, monkeypatch):
    (tmp_path / CHECKPOINTS[0]).write_bytes(crafted.archive(sound))
    monkeypatch.setattr(checkpoint, "free_memory", lambda: 1e5)
    assert "are free" in refused(tmp_path, scene, seeds)


def outcome(seed: int, sound, scene, seeds, stopped: Path, folder: Path) -> str:
    """How a run goes on from a crafted checkpoint: "refused" before it starts, or its exit status."""
    shutil.copytree(stopped, folder, dirs_exist_ok=True)
    (folder / CHECKPOINTS[1]).unlink(missing_ok=True)
    (folder / CHECKPOINTS[0]).write_bytes(crafted.checkpoint(seed, sound))
    if refused(folder, scene, seeds):
        return "refused"
    return str(main([*RUN, "--out", str(folder), "--resume"]))


@pytest.mark.filterwarnings("ignore:Duplicate name")
def test_a_dozen_crafted_ones_are_refused_in_one_line(sound, scene, seeds, tmp_path):
    """Those of the long tier that are refused: no run of them is needed."""
    found = [refused_seed(seed, sound, scene, seeds, tmp_path) for seed in range(40)]
    assert found.count(True) >= 12


def refused_seed(seed: int, sound, scene, seeds, folder: Path) -> bool:
    (folder / CHECKPOINTS[0]).write_bytes(crafted.checkpoint(seed, sound))
    return bool(refused(folder, scene, seeds))


@pytest.mark.validation
@pytest.mark.filterwarnings("ignore:Duplicate name")
@pytest.mark.parametrize("part", range(10))
def test_five_hundred_crafted_ones_end_in_one_line_or_run(sound, scene, seeds, stopped, tmp_path, part, capsys):
    """A run from one that is accepted ends well (0), in a refusal (2), or as unstable (3), by its own words."""
    for seed in range(50 * part, 50 * part + 50):
        ended = outcome(seed, sound, scene, seeds, stopped, tmp_path)
        said = capsys.readouterr().err
        assert ended in ("refused", "0", "2", "3"), f"{seed}: {ended}"
        assert "Traceback" not in said and all(line.startswith("rsmpm_ti: ") for line in said.splitlines()), said
