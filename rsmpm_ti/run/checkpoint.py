"""A run in the middle, as arrays: taken between two history rows, written by the writer, read back by `--resume`.

Everything that the next step or the next row depends on, as it lies in memory and in the order in which it lies there,
so that a run that goes on takes the same sums in the same order as one that was never stopped.
"""

import json
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from rsmpm_ti.errors import ObserverError, RockWarning, SceneError, refuse, short, shown
from rsmpm_ti.output.files import CHECKPOINTS
from rsmpm_ti.output.folder import RunFolder
from rsmpm_ti.run.kept.contents import Contents
from rsmpm_ti.run.kept.layout import MOST_TEXT, OBSERVERS, check_layout
from rsmpm_ti.run.kept.observers import check_progress
from rsmpm_ti.run.kept.reading import MOST_ARRAYS, StoredArrays, find_file, need
from rsmpm_ti.run.kept.states import Unkept, divided
from rsmpm_ti.run.settings import Settings
from rsmpm_ti.solver.observer import Observer, Watch
from rsmpm_ti.solver.outflow import Dropped
from rsmpm_ti.solver.view import View
from rsmpm_ti.spec.review.machine import address_space, free_memory
from rsmpm_ti.spec.scene import Scene

LEDGER = ("impulse", "work", "latest", "speed", "body_work", "viscous", "released", "damped", "mixed", "stopped")
PER_SLOT = ("body_work", "viscous", "released", "damped", "mixed")
"""Those of the ledger that have a slot for each thread: their sum is what counts."""


class Checkpoint(Observer):
    """Has a checkpoint written every so many seconds of wall time. It is the last to look at a row."""

    every = 0.0  # it looks at every row, and then at the clock on the wall

    def __init__(self, seconds: float, write: Callable[[], None]):
        self._seconds, self._write, self._written = seconds, write, time.perf_counter()

    def see(self, view: View) -> None:
        if view.step > 0 and time.perf_counter() - self._written >= self._seconds:
            self._write()
            self._written = time.perf_counter()


MAY_CHANGE = {"schedule": ("strain_end", "t_end", "rows"), "loading": ("time_scale",)}
"""Fields of a scene that a run which goes on may have otherwise, beside all of its output: where it ends and how often
it is looked at. The time scale is compared as a number: 'auto' asks where the run ends."""


def held(identity: dict) -> dict:
    """What a run that goes on must share with the one that wrote a checkpoint."""
    scene = dict(identity["scene"])
    scene.pop("output", None)
    for part, names in MAY_CHANGE.items():
        if isinstance(scene.get(part), dict):
            scene[part] = {name: value for name, value in scene[part].items() if name not in names}
    return identity | {"scene": scene}


def take(drive, history, progress: dict, identity: dict) -> dict[str, np.ndarray]:
    """Arrays of a checkpoint. progress: numbers of the run's loop; identity: what a run that goes on must share."""
    sim = drive.sim
    arrays = particle_arrays(sim)
    arrays |= {f"ledger_{name}": getattr(sim.ledger, name).to_numpy() for name in LEDGER}
    count = min(sim.events.count[None], sim.events.capacity)
    arrays |= {f"event_{name}": getattr(sim.events, name).to_numpy()[:count] for name in _event_columns(sim)}
    arrays["event_by_mode"] = sim.events.by_mode.to_numpy()
    arrays["event_onset"] = np.array(sim.events.onset[None])
    arrays |= sim.grid.state() | sim.contacts.state() | sim.walls.state() | history.state()
    arrays |= {f"dropped_{name}": np.array(value) for name, value in vars(drive.dropped).items()}
    arrays |= {f"clock_{name}": np.array(value) for name, value in drive.clock.state().items()}
    if drive.control is not None:
        arrays |= {f"servo_{name}": np.array(value) for name, value in drive.control.state().items()}
    arrays["end"] = np.array(drive.clock.end)
    arrays["text"] = np.array(json.dumps({"progress": progress, "identity": identity}))
    return arrays


def restore(arrays: dict[str, np.ndarray], drive, history) -> dict:
    """Put a checkpoint's state into a run of the same scene that has not begun; its `progress`."""
    sim = drive.sim
    for name, field in _particle_fields(sim):
        field.from_numpy(arrays[f"particle_{name}"])
    for name in LEDGER:
        field, kept = getattr(sim.ledger, name), arrays[f"ledger_{name}"]
        if name in PER_SLOT and len(kept) != field.shape[0]:  # written with another number of threads
            kept = np.concatenate(([kept.sum()], np.zeros(field.shape[0] - 1)))
        field.from_numpy(kept)
    count = len(arrays["event_time"])
    for name in _event_columns(sim):
        field = getattr(sim.events, name)
        column = field.to_numpy()
        column[:count] = arrays[f"event_{name}"]
        field.from_numpy(column)
    sim.events.count[None], sim.events.onset[None] = count, float(arrays["event_onset"])
    sim.events.by_mode.from_numpy(arrays["event_by_mode"])
    for part in (sim.grid, sim.contacts, sim.walls, history):
        part.resume(arrays)
    planned = drive.clock.total
    drive.clock.resume({name: arrays[f"clock_{name}"] for name in drive.clock.state()})
    if drive.control is not None:
        drive.control.resume({name: arrays[f"servo_{name}"] for name in drive.control.state()})
        drive.clock.keep_pace(drive.clock.pace)
    elif float(arrays["end"]) != drive.clock.end:
        if sim.scene.schedule.adaptive:
            drive.clock.retime(drive.clock.dt)
        else:
            drive.clock.total = planned
    drive.dropped = Dropped(
        count=int(arrays["dropped_count"]), momentum=arrays["dropped_momentum"],
        **{name: float(arrays[f"dropped_{name}"]) for name in ("mass", "energy")},
    )  # fmt: skip
    drive.look()
    return json.loads(str(arrays["text"]))["progress"]


def observer_arrays(watches: list[Watch]) -> tuple[list[dict], dict[str, np.ndarray]]:
    """What observers remember: a plain part for each, and arrays by numbers that say whose they are: a file's own names
    hold neither NUL nor much. Raises ObserverError for what would not come back."""
    parts: list[dict] = []
    arrays: dict[str, np.ndarray] = {}
    size = 0
    for k, watch in enumerate(watches):
        state = watch.state()
        try:
            rest, found = divided(state["own"])
        except Unkept as problem:
            raise ObserverError(f"observer {watch.name}: {problem}; a state may hold {WANTED}") from None
        arrays |= {f"{OBSERVERS}{k}_{n}": values for n, values in enumerate(found.values())}
        parts.append({"next": state["next"], "own": rest, "arrays": list(found)})
        size += len(json.dumps(parts[-1]))
        if size > MOST_TEXT // 2:  # of all together, which are one text
            raise ObserverError(f"observer {watch.name}: state() holds too many numbers in lists; use NumPy arrays")
        if len(arrays) > MOST_ARRAYS // 2:
            raise ObserverError(
                f"observer {watch.name}: state() holds {len(found)} arrays, and a checkpoint at most "
                f"{MOST_ARRAYS // 2}; join them to larger ones"
            )
    return parts, arrays


WANTED = "numbers, texts, None, lists and dicts of them, and beside these NumPy arrays of numbers or texts"


def restore_observers(
    watches: list[Watch], parts: list[dict], arrays: dict[str, np.ndarray], fraction: float | None = None
) -> None:
    """The way back of `observer_arrays`, into observers of the same kinds in the same order.

    fraction: of the run that is done, where its end or its output is another now; None where it is not.
    """
    for k, (watch, part) in enumerate(zip(watches, parts, strict=True)):
        kept = {name: arrays[f"{OBSERVERS}{k}_{n}"] for n, name in enumerate(part["arrays"])}
        watch.resume({"next": part["next"], "own": part["own"] | kept})
        if fraction is not None:
            watch.realign(fraction)


def particle_arrays(sim) -> dict[str, np.ndarray]:
    """Every stored component of the particles as it lies in memory."""
    return {f"particle_{name}": field.to_numpy() for name, field in _particle_fields(sim)}


def _particle_fields(sim) -> list[tuple[str, Any]]:
    """Every stored component, and the cell of each particle at the last sort, on which the order of sums depends."""
    particles = sim.particles
    real = [(f"real_{k}", c) for k, c in enumerate(particles.real_components)]
    return [*real, *((f"whole_{k}", c) for k, c in enumerate(particles.whole_components)), ("key", particles.key)]


def _event_columns(sim) -> tuple[str, ...]:
    return sim.events.names


def read(
    out: Path, scene: Scene, seeds, settings: Settings, passed_over: list[str] | None = None
) -> dict[str, np.ndarray] | None:
    """The latest checkpoint in a run's folder that is sound; None where there is none at all.

    seeds: `scene.particles()`; passed_over: takes the names of damaged ones before it. A stranger may have written it:
    nothing of it is used before all of it has been checked. One that is damaged is passed over, with a RockWarning, for
    the one before. Raises SceneError where it belongs to another scene, version or precision, naming the difference,
    and where there are only damaged ones. The end of the run, its rows and its output may differ.
    """
    damaged = ""
    for name in CHECKPOINTS:
        path, arrays = Path(out) / name, None
        try:
            if find_file(Path(out), name):
                arrays = _sound(path, scene, seeds, settings)
        except SceneError:
            raise
        except Exception as error:  # libraries raise anything where what they are to read was made for it
            reason = "".join(c if c.isprintable() else " " for c in str(error) or type(error).__name__)
            damaged = f"{path} is damaged ({short(' '.join(reason.split()))})"
            if passed_over is not None:
                passed_over.append(name)
        if arrays is not None:
            if damaged:
                warnings.warn(f"{damaged}; the run goes on from {name}", RockWarning, stacklevel=2)
            return arrays
    if damaged:
        raise SceneError(f"{damaged} and there is no other; start anew without --resume")
    return None


def kept_in(folder: RunFolder, scene: Scene, seeds, settings: Settings, damaged: list[str]) -> dict | None:
    """Arrays of the checkpoint from which to go on; None where there is none, and the run starts anew. damaged: takes
    the names of those that were passed over."""
    kept = read(folder.path, scene, seeds, settings, damaged)
    if kept is None:
        folder.start_anew()
        said = f"there is no checkpoint in {folder.path} to go on from: the run starts anew"
        warnings.warn(said, RockWarning, stacklevel=4)
    else:
        check_end(kept, scene)
    return kept


def _sound(path: Path, scene: Scene, seeds, settings: Settings) -> dict[str, np.ndarray]:
    """All arrays of a checkpoint, once they are known to be those of this run; raises Damaged and what else happens."""
    with open(path, "rb") as file:
        stored = StoredArrays(file)
        need("text" in stored.headers, "it has no text")
        header = stored.headers["text"]
        need(header.dtype.kind == "U" and header.shape == (), "its text is none")
        need(header.dtype.itemsize <= 4 * MOST_TEXT, "its text is too long")
        text = json.loads(str(stored.read("text")))
        need(isinstance(text, dict) and set(text) == {"progress", "identity"}, "its text is no dict of two")
        identity = text["identity"]
        need(isinstance(identity, dict) and isinstance(identity.get("scene"), dict), "it does not say whose it is")
        where = difference(held(identity), held(json.loads(json.dumps(settings.identity(scene)))))
        if where:
            raise SceneError(
                f"{path} is of another run and is refused: {where}; resume with the options of that run (its end, rows "
                f"and output may differ), or start anew without --resume"
            )
        count, free = sum(len(body.x) for body in seeds), min(free_memory(), address_space())
        check_layout(stored.headers, scene, count, settings)
        need(stored.size < free, f"it holds {stored.size / 1e9:.3g} GB, and {free / 1e9:.3g} GB are free")
        arrays = {name: stored.read(name) for name in stored.headers}
    contents = Contents({name: values for name, values in arrays.items() if name != "text"}, scene, seeds)
    contents.check()
    check_progress(text["progress"], contents, settings)
    return arrays


def changed(arrays: dict[str, np.ndarray], identity: dict) -> bool:
    """Whether a run that goes on from a checkpoint has another end, other rows or other output than it had."""
    return bool(difference(json.loads(str(arrays["text"]))["identity"], json.loads(json.dumps(identity))))


def check_end(arrays: dict[str, np.ndarray], scene) -> None:
    """Refuse a run that would end before the checkpoint from which it is to go on."""
    reached = float(arrays["clock_since"] + (arrays["clock_step"] - arrays["clock_first"]) * arrays["clock_dt"])
    clock = ""
    if scene.servo is not None:
        reached, clock = float(arrays["clock_loaded"]), " of platens at full speed"
    if scene.t_end < reached - float(arrays["clock_dt"]):  # an end is rounded up to whole steps
        name = "t_end" if scene.schedule.strain_end is None else "strain_end"
        allowed = f"such that the run ends after t = {reached:.6g} s{clock}, to where the checkpoint has come"
        raise refuse(f"schedule.{name}", getattr(scene.schedule, name), allowed, "start anew without --resume")


def difference(there, here, where: str = "") -> str:
    """The first place in which two plain structures differ, in words; "" where they do not."""
    if isinstance(there, dict) and isinstance(here, dict):
        for key in sorted(set(there) | set(here)):
            found = difference(there.get(key), here.get(key), f"{where}.{key}" if where else key)
            if found:
                return found
        return ""
    if isinstance(there, list) and isinstance(here, list) and len(there) == len(here):
        pairs = enumerate(zip(there, here, strict=True))
        return next(filter(None, (difference(a, b, f"{where}[{k}]") for k, (a, b) in pairs)), "")
    name = where if where.isprintable() else repr(where)
    return "" if there == here else f"{short(name)} is {shown(there)} there and {shown(here)} here"
