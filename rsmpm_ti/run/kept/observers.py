"""Whether what observers remember in a checkpoint can be theirs. What users' own remember is for them to judge."""

import math
from dataclasses import fields

import numpy as np

from rsmpm_ti.records.snapshot import Pattern
from rsmpm_ti.run.kept.contents import Contents
from rsmpm_ti.run.kept.layout import OBSERVERS
from rsmpm_ti.run.kept.reading import need
from rsmpm_ti.run.settings import Settings

MOST_LOOKS = 20_100
"""Most frames of a run, those at jumps included, and a few."""


def check_progress(progress, contents: Contents, settings: Settings) -> None:
    """Raises Damaged; progress: the part of a checkpoint's text of that name."""
    need(isinstance(progress, dict) and set(progress) == {"observers", "wall_s"}, "its progress is incomplete")
    need(_number(progress["wall_s"], 1e12), "its wall time is no time")
    parts = progress["observers"]
    need(isinstance(parts, list) and len(parts) == 4 + len(settings.observers), "it has other observers")
    for k, part in enumerate(parts):
        need(isinstance(part, dict) and set(part) == {"next", "own", "arrays"}, f"observer {k} is incomplete")
        names = part["arrays"]
        need(_count(part["next"], 2**31), f"observer {k} looks next at {str(part['next'])[:20]}")
        need(isinstance(part["own"], dict), f"observer {k} remembers no dict")
        need(isinstance(names, list) and all(isinstance(name, str) for name in names), f"observer {k} names no arrays")
    told = {f"{OBSERVERS}{k}_{n}" for k, part in enumerate(parts) for n in range(len(part["arrays"]))}
    need(told == {name for name in contents.arrays if name.startswith(OBSERVERS)}, "observers have other arrays")
    largest, frames, files, *_, clock = parts
    _check_largest(largest, contents)
    _check_frames(frames, contents.time)
    _check_files(files, contents.time)
    need(clock["own"] == {} and clock["arrays"] == [], "the last observer remembers something")


def _number(value, most: float) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and 0.0 <= value <= most


def _count(value, most: int) -> bool:
    return type(value) is int and 0 <= value <= most


def _check_largest(part: dict, contents: Contents) -> None:
    """The crack pattern at the largest load, if there was any."""
    own, names = part["own"], part["arrays"]
    need("largest" in own and _number(own["largest"], 1e30), "its largest load is no number")
    if set(own) == {"largest"} and not names:
        return
    wanted = {field.name for field in fields(Pattern)}
    need(set(own) == {"largest", "time"} and set(names) == wanted - {"time"} and len(names) == len(wanted) - 1,
         "its pattern of cracks is incomplete")  # fmt: skip
    need(_number(own["time"], contents.time * (1.0 + 1e-9)), "its pattern of cracks is of another time")
    of = {name: contents.arrays[f"{OBSERVERS}0_{n}"] for n, name in enumerate(names)}
    ids, dim = of["id"], contents.scene.dim
    need(ids.ndim == 1 and 0 < len(ids) <= contents.count, "its pattern of cracks has no particles")
    kinds = {"id": "i", "failure_mode": "i", "governs": "i"}
    for name, values in of.items():
        shape = (len(ids), dim) if name in ("x", "displacement") else (len(ids),)
        need(values.shape == shape and values.dtype.kind == kinds.get(name, "f"), f"its pattern has no {name}")
        need(np.isfinite(values).all(), f"{name} of its pattern is not finite")
    need((ids >= 0).all() and (ids < contents.count).all() and (np.diff(ids) > 0).all(), "its pattern has no order")
    for name in ("failure_mode", "governs"):
        need(((of[name] >= 0) & (of[name] <= 2)).all(), f"{name} of its pattern is unknown")
    need(((of["damage"] >= 0.0) & (of["damage"] <= 1.0)).all(), "damage of its pattern is no fraction")
    need((of["volume"] > 0.0).all() and of["volume"].max() <= 1e6 * contents.seeded.volume.max(), "rock has no volume")
    need(contents.near(of["x"], ids) and contents.near(contents.seeded.x[ids] + of["displacement"], ids),
         "its pattern is far from the particles")  # fmt: skip


def _check_frames(part: dict, time: float) -> None:
    own = part["own"]
    need(set(own) == {"next", "used", "failed", "times"} and not part["arrays"], "its frames are not counted")
    times = own["times"]
    need(isinstance(times, list) and len(times) <= MOST_LOOKS, "its frames are not counted")
    need(all(_number(entry, time * (1.0 + 1e-9)) for entry in times), "its frames are of other times")
    need(times == sorted(times), "its frames are of other times")
    need(all(_count(own[name], MOST_LOOKS) for name in ("next", "used")), "its frames are not counted")
    need(_number(own["failed"], 1e12), "failures at its latest frame are not counted")


def _check_files(part: dict, time: float) -> None:
    """Names go into a list for ParaView: each is the one that the run gives."""
    own = part["own"]
    need(set(own) == {"entries"} and not part["arrays"], "its particle files are not listed")
    entries, before = own["entries"], 0.0
    need(isinstance(entries, list) and len(entries) <= MOST_LOOKS, "its particle files are not listed")
    for k, entry in enumerate(entries):
        need(isinstance(entry, list) and len(entry) == 2, "its particle files are not listed")
        need(entry[1] == f"particles_{k:04d}.vtu", "its particle files have other names")
        need(_number(entry[0], time * (1.0 + 1e-9)) and entry[0] >= before, "its particle files are of other times")
        before = float(entry[0])
    need(math.isfinite(before), "its particle files are of other times")
