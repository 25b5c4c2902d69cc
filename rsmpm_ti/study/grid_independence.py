"""Cracks that do not know the grid: the specimen turned against it, three seeds, two cell sizes."""

import itertools
from dataclasses import dataclass

import numpy as np

from rsmpm_ti.cases.case import Outcome, Row, at_least, at_most
from rsmpm_ti.spec.regions import Slit
from rsmpm_ti.study.rotated_specimen import ENDS, grow
from rsmpm_ti.study.runs import Run, Study

ANGLES, SEEDS = (0.0, 15.0, 30.0, 45.0), (1, 2, 3)
PATH = 20e-3
"""Paths are compared over this length along the load axis [m]."""

BIN, FIT = 1e-3, 3e-3
"""Height of a bin, and length over which the direction of the young path is fitted [m]."""

REACH = 8e-3
"""A wing's particles lie within this lateral distance of the flaw's tip [m]."""

FLAW = Slit(centre=(0.0, 0.0), length=15e-3, width=3e-3, angle=45.0, rounded=True)


def runs(quick: bool) -> list[Run]:
    """Cells of a half and of a quarter of the length of the mean: every orientation and seed, and one seed.

    length = 1 mm, so dx = 0.5 and 0.25 mm; quick: 2 mm, 1 and 0.5 mm, a rock of coarser grain around the same flaw. The
    paper's rule on a lattice of the larger cells.
    """
    length = 2e-3 if quick else 1e-3
    plan = [(0.5 * length, angle, seed) for angle in ANGLES for seed in SEEDS]
    plan += [(0.25 * length, angle, 1) for angle in ANGLES]
    common = {"time_scale": 16.0, "length": length}
    out = []
    for dx, angle, seed in plan:
        settings = {"angle": angle, "dx": dx, "seed": seed, "paper": False, "end": 13e6}
        out.append(Run(f"lab_{1e3 * dx:g}_{angle:g}_{seed}", grow, settings | common))
    dx = 0.5 * length
    for angle in ANGLES:
        settings = {"angle": angle, "dx": dx, "seed": 0, "paper": True, "end": 5e6}
        out.append(Run(f"paper_{1e3 * dx:g}_{angle:g}", grow, settings | common))
    return out


@dataclass(frozen=True)
class Wing:
    """`first`, `left`: angles from the flaw's plane of the first cracks and of the first FIT of the path [degrees];
    `path`: of the tip [k, 2] [m]. NaN and empty where there is none."""

    first: float
    left: float
    path: np.ndarray


def read_wing(result: dict, name: str, dx: float) -> Wing:
    """One wing of a run.

    The path is that of the tip: in bins of height, the mean place of what failed there first, half as many particles as
    a band of two cells has in a bin. What fails beside the wing later is not its path.
    """
    first = float(result[f"first_{name}"].mean()) if f"first_{name}" in result else np.nan
    x = result[f"failed_{name}"]
    tip = 0.5 * FLAW.length * FLAW.direction
    x = x[(np.abs(x[:, 0] - tip[0]) < REACH) & (x[:, 1] < tip[1] + PATH)]
    if len(x) == 0:
        return Wing(first, np.nan, np.zeros((0, 2)))
    x = x[x[:, 1] >= x[0, 1]]
    bins = np.floor(x[:, 1] / BIN).astype(int)
    height = np.unique(bins)
    leading = [x[bins == b][: round(4.0 * BIN / dx)] for b in height]
    path = np.stack([[positions[:, 0].mean() for positions in leading], (height + 0.5) * BIN], axis=1)
    early = np.concatenate(leading)
    early = early[np.linalg.norm(early - x[0], axis=1) < FIT]
    left = np.nan
    if np.ptp(early[:, 1]) > BIN:
        line = np.array([np.polyfit(early[:, 1], early[:, 0], 1)[0], 1.0])
        left = float(np.degrees(np.arccos(line @ FLAW.direction / np.linalg.norm(line))))
    return Wing(first, left, path)


def spread(paths: list[np.ndarray]) -> tuple[float, float]:
    """Largest and root-mean-square distance between any two paths at the same height [m]; nan if no two meet there."""
    by_bin: dict[int, list[float]] = {}
    for path in paths:
        for lateral, along in path:
            by_bin.setdefault(round(along / BIN - 0.5), []).append(lateral)
    gaps = np.array([abs(a - b) for positions in by_bin.values() for a, b in itertools.combinations(positions, 2)])
    if not len(gaps):
        return np.nan, np.nan
    return float(gaps.max()), float(np.sqrt((gaps**2).mean()))


def finish(results: dict) -> Outcome:
    families: dict[str, list[tuple[str, Wing]]] = {"lab": [], "paper": []}
    onset: dict[str, list[float]] = {"lab": [], "paper": []}
    by_size: dict[str, list[float]] = {}
    for tag, result in results.items():
        family, dx, *_ = tag.split("_")
        families[family] += [(tag, read_wing(result, name, 1e-3 * float(dx))) for name in ENDS]
        loads = [float(result[f"onset_{name}"]) for name in ENDS]
        onset[family] += loads
        if family == "lab":
            by_size.setdefault(dx, []).extend(loads)
    twice = "twice the length of the mean stress, 1 mm: it knows nothing finer"
    ends = "0.25 mm in the end's radius of 1.5 mm is 8 % of the root that stress there goes with"
    first = np.array([wing.first for _, wing in families["lab"]])  # of both wings of every run
    means = np.array([np.mean(loads) for loads in by_size.values()])
    finer = "the end's radius is known to a part of a cell, and stress there goes with its root"
    rows: list[Row] = []
    if families["lab"]:
        section = "docs/references.md, section 9"
        name, limit = "cube_lab: mean onset loads of the cell sizes, (max - min)/mean", 0.03
        rows += [
            at_most(name, np.ptp(means) / means.mean(), limit, finer),
            at_most("cube_lab: angle of first cracks, largest distance from mean [deg]",
                    np.abs(first - first.mean()).max(), 8.0,
                    "half a particle of dx 1 mm, 0.25 mm, on the end's radius of 1.5 mm turns its normal by 9.5"),
            at_most("cube_lab: largest angle of first cracks [deg]", first.max(), 95.0, section),
            at_least("cube_lab: smallest angle of first cracks [deg]", first.min(), 70.0, section),
        ]  # fmt: skip
    for family, name, limit in (("lab", "cube_lab", 1.0), ("paper", "paper's rule", np.inf)):
        if not families[family]:  # --kept, before all is run
            continue
        paths = [wing.path for _, wing in families[family]]
        left = np.array([wing.left for _, wing in families[family]])
        why = "shown, not held to anything: half of the strength is lost only when the crack has turned"
        rows += [
            at_most(f"{name}: largest angle of the path's first 3 mm [deg]", left.max(), np.inf, why),
            at_least(f"{name}: smallest angle of the path's first 3 mm [deg]", left.min(), -np.inf, why),
        ]
        for dx in sorted({tag.split("_")[1] for tag, _ in families[family]}, key=float):
            some = [wing.path for tag, wing in families[family] if tag.split("_")[1] == dx]
            largest, rms = spread(some)
            rows += [
                at_most(f"{name}: paths at dx {dx} mm apart, at most [m]", largest, 2e-3 * limit, twice),
                at_most(f"{name}: paths at dx {dx} mm apart, rms [m]", rms, 1e-3 * limit, "the length of the mean"),
            ]
        largest, rms = spread(paths)
        reached = min(np.ptp(path[:, 1]) if len(path) else 0.0 for path in paths)
        loads = np.array(onset[family])
        rows += [
            at_most(f"{name}: all paths apart, at most [m]", largest, 2e-3 * limit, twice),
            at_most(f"{name}: all paths apart, rms [m]", rms, 1e-3 * limit, "the length of the mean"),
            at_least(f"{name}: shortest wing compared [m]", reached, 18e-3 / limit, "20 mm less two bins"),
            at_most(f"{name}: onset load, (max - min)/mean", np.ptp(loads) / loads.mean(), 0.1 * limit, ends),
        ]

    def draw(figure):
        figure.set_size_inches(9.0, 8.0)
        for axes, (family, title) in zip(
            figure.subplots(1, 2, sharey=True), (("lab", "cube_lab"), ("paper", "paper's rule, lattice")), strict=True
        ):
            colours = {angle: f"C{k}" for k, angle in enumerate(ANGLES)}
            styles = {"1": ":", "0.5": "-", "0.25": "--"}
            for tag, wing in families[family]:
                _, dx, angle, *_ = tag.split("_")
                axes.plot(*(1e3 * wing.path.T), styles[dx], color=colours[float(angle)], linewidth=1.0)
            s = np.linspace(0.0, 2.0 * np.pi, 200)
            outline = _outline(s)
            axes.fill(*(1e3 * outline.T), color="0.85")
            axes.set(aspect="equal", xlim=(-4, 14), ylim=(0, 28), xlabel="x [mm]", title=title)
        axes.set_xlabel("x [mm]")
        for angle, colour in colours.items():
            axes.plot([], [], color=colour, label=f"grid turned {angle:g} degrees")
        for dx, style in styles.items():
            axes.plot([], [], style, color="k", label=f"dx {dx} mm")
        axes.legend(fontsize=8)

    return Outcome(tuple(rows), draw)


def _outline(s: np.ndarray) -> np.ndarray:
    """The flaw's outline, [n, 2]."""
    half, radius = 0.5 * (FLAW.length - FLAW.width), 0.5 * FLAW.width
    along = np.sign(np.cos(s)) * half + radius * np.cos(s)
    across = radius * np.sin(s)
    t = FLAW.direction
    return np.outer(along, t) + np.outer(across, [-t[1], t[0]])


STUDIES = (Study("grid_independence", "crack paths against grid orientation, seed and cell size", runs, finish),)
