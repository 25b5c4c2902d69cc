"""What to paint of a run: kinds of frames, limits and titles, in plain values."""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rsmpm_ti.analysis.fracture import spacing_of
from rsmpm_ti.analysis.neighbours import pairs_within
from rsmpm_ti.fields.side_motion import held_sides
from rsmpm_ti.rock.criteria import Unbreakable
from rsmpm_ti.spec.bodies.rocks import rock_indices
from rsmpm_ti.spec.scene import Scene
from rsmpm_ti.spec.seeding import Seeds

BESIDE = 1.3
"""Spacings of particles up to which two lie beside each other: less than across the diagonal of a lattice."""


@dataclass(frozen=True, kw_only=True)
class Commission:
    """What is to be painted of one run, in plain values: they reach the process that paints.

    kinds: of frames; painters: keywords that all of them share; title: of summary.png; name: of the movie.
    """

    kinds: tuple[str, ...]
    painters: dict
    title: str
    name: str
    movie: bool
    out: Path


def commission(scene: Scene, name: str, out: Path, seeds: list[Seeds]) -> Commission:
    """seeds: `scene.particles()`."""
    volume = float(sum(body.volume.sum() for body in seeds))
    low, high = zip(*(body.region.bounds() for body in scene.bodies), strict=True)
    lower, upper = np.min(low, axis=0)[:2], np.max(high, axis=0)[:2]
    strain, load = load_limits(scene, volume)
    painters = {
        "lower": tuple(lower), "upper": tuple(upper), "stress_limit": stress_limit(scene, load),
        "strain_limit": strain, "load_limit": load, "backend": scene.output.painter, "softens": softens(scene),
        "load_name": load_name(scene), "interface": interface(scene, seeds),
    }  # fmt: skip
    return Commission(
        kinds=kinds_of(scene), painters=painters, title=scene.title, name=name, movie=scene.output.movie, out=Path(out)
    )


def interface(scene: Scene, seeds: list[Seeds]) -> np.ndarray | None:
    """Ids of particles beside each other of two rocks, [pairs, 2]; None where there is one rock."""
    if len(scene.rocks) == 1:
        return None
    rock = np.repeat(rock_indices(scene), [len(body.x) for body in seeds])
    x, spacing = np.concatenate([body.x for body in seeds]), spacing_of(scene)
    a, b = pairs_within(x, BESIDE * spacing)
    return np.stack([a, b], axis=1)[rock[a] != rock[b]]


def kinds_of(scene: Scene) -> tuple[str, ...]:
    """Of frames."""
    return ("stress", "cracks", "margin") if scene.output.margin else ("stress", "cracks")


def load_name(scene: Scene) -> str:
    """Of the load axis. Total: confining pressure is part of it. Axial where the loaded width is the specimen's own, so
    that it is the mean stress of a section; the nominal stress of a disc is not."""
    cell = scene.loading.load_cell
    if cell is None or cell.axis is None or cell.width is None:
        return "total nominal stress"
    low, high = zip(*(body.region.bounds() for body in scene.bodies), strict=True)
    edges = np.max(high, axis=0) - np.min(low, axis=0)
    own = math.isclose(cell.width, math.prod(np.delete(edges, cell.axis)), rel_tol=1e-6)
    return "total axial stress" if own else "total nominal stress"


def softens(scene: Scene) -> bool:
    """Whether any rock of a scene loses its strength while it cracks, not at once."""
    return any(rock.after_failure.softens for rock in scene.rocks)


def stress_limit(scene: Scene, load: float | None) -> float:
    """Colour limit [Pa]: 1.5 times the tensile strength, of the strongest rock, or for an elastic run a tenth of the
    load expected."""
    if scene.output.stress_limit is not None:
        return scene.output.stress_limit
    criteria = [rock.criterion for rock in scene.rocks if not isinstance(rock.criterion, Unbreakable)]
    if criteria:
        return 1.5 * max(criterion.tensile_strength for criterion in criteria)
    return 0.1 * load if load else 1e6


OVERSHOOT = 2.0
"""Times the strain under a force that the same force makes when it comes at once."""


def _most_factor(scene: Scene) -> float:
    """Of a held load, within a run."""
    return max(abs(scene.loading.start.factor(time)) for time in np.linspace(0.0, scene.t_end, 1001))


def load_limits(scene: Scene, volume: float) -> tuple[float | None, float | None]:
    """Ends of the inset's axes: the last strain, or under a held force the largest, and the nominal stress of a
    uniformly strained body of this volume.

    That is an upper bound of the elastic load (Voigt), of the stiffest rock; the strength of the strongest bounds it
    too. Confinement adds its pressure.
    """
    cell = scene.loading.load_cell
    if scene.loading.ends is None or cell is None or cell.width is None:
        return None, None
    strain = abs(scene.schedule.strain_end or scene.loading.strain_rate * scene.t_end)
    modulus = max(rock.elasticity.uniaxial_modulus(scene.dim) for rock in scene.rocks)
    stiffness = modulus * volume / (scene.loading.height * cell.width)
    held = [abs(side.force) for side in held_sides(scene) if side.axis == scene.loading.ends[0].axis]
    if held:
        strain = max(strain, OVERSHOOT * max(held) * _most_factor(scene) / cell.width / stiffness)
    if strain == 0.0:  # ends that stand still
        return None, None
    load = stiffness * strain + scene.loading.confinement
    criteria = [rock.criterion for rock in scene.rocks if not isinstance(rock.criterion, Unbreakable)]
    if len(criteria) == len(scene.rocks):
        load = min(load, 1.05 * max(criterion.strength(scene.loading.confinement) for criterion in criteria))
    return strain, load
