"""What a run looks like from outside at one instant: plain NumPy, no Taichi."""

from dataclasses import dataclass, field

import numpy as np

from rsmpm_ti.records.tables import Column, Table

INTACT, TENSION, SHEAR = 0, 1, 2
"""Values of `failure_mode`."""

MODE_NAMES = ("intact", "tension", "shear")


@dataclass(frozen=True)
class Snapshot:
    """Particles at one instant, in the order of their ids, which is the order in which they were seeded.

    Those that have left the domain and were dropped are not among them.
    Shapes: n particles in dim dimensions. Stress is Cauchy, tension positive.
    """

    time: float  # [s]
    id: np.ndarray  # ascending, int [n]
    x: np.ndarray  # current positions [m], [n, dim]
    displacement: np.ndarray  # [m], [n, dim]
    velocity: np.ndarray  # [m/s], [n, dim]
    sigma: np.ndarray  # [Pa], [n, 3, 3]
    sigma_1: np.ndarray  # largest (most tensile) principal stress [Pa], [n]
    sigma_3: np.ndarray  # smallest principal stress [Pa], [n]
    volume: np.ndarray  # current volume [m^dim], [n]
    strength: np.ndarray  # factor on the rock's cohesion and tensile strength, 1 where uniform, [n]
    failure_mode: np.ndarray  # INTACT, TENSION or SHEAR, int8 [n]
    failure_time: np.ndarray  # [s], NaN where intact, [n]
    # how near to failure: 1 unloaded, or pressed from all sides; 0 at failure, and where failed or begun to crack;
    # below 0 where the mean stress exceeds the strength and a particle nearby, which exceeds it more, fails first; NaN
    # in rock that does not break; [n]
    margin: np.ndarray
    governs: np.ndarray  # which failure the margin is to, or which it was: TENSION, SHEAR, or 0 for none, int8 [n]
    damage: np.ndarray  # fraction of strength lost, 0 to 1, by the paper's laws 1 where failed, [n]
    aperture: np.ndarray  # opening of the crack in the particle [m], NaN by the paper's laws, which know none, [n]
    # of the normal of the crack in the particle, from +x [degrees, 0 to 180), NaN where it has none and by the paper's
    # laws; where it failed in shear, of sigma_1 then; [n]
    crack_angle: np.ndarray
    history: dict[str, np.ndarray] = field(default_factory=dict)  # what the law after failure remembers, by name
    rock: np.ndarray | None = None  # index in `Scene.rocks`, int8 [n]; None of a run of one rock


@dataclass(frozen=True)
class Pattern:
    """What of a Snapshot a picture of cracks needs, by the same names: it is copied at every new largest load."""

    time: float
    id: np.ndarray
    x: np.ndarray
    displacement: np.ndarray
    volume: np.ndarray
    failure_mode: np.ndarray
    governs: np.ndarray
    damage: np.ndarray


PARTICLES = Table(
    file="particles_0000.vtu, particles_0001.vtu, ...",
    about=(
        "Particles at `output.vtu` + 1 equal intervals of the run, for ParaView: open particles.pvd, which knows their "
        "times. One vertex per particle, in the order of their seeding, without those that were dropped. Vectors have "
        "three components, in 2D the last is 0. Positions are in double precision, all else in single. What the law "
        "after failure remembers of each particle follows under the law's own names (with `law_` before a name that "
        "stands here already)."
    ),
    columns=(
        Column(name="id", unit="1", about="number of the particle, the same in every file", value=lambda s: s.id),
        Column(name="displacement", unit="m", about="since the start, 3 components", value=lambda s: s.displacement),
        Column(
            name="velocity", unit="m/s", about="of the run, 3 components; times time_scale without mass scaling",
            value=lambda s: s.velocity,
        ),
        Column(
            name="stress", unit="Pa", about="Cauchy stress, tension positive, 9 components xx xy xz yx yy yz zx zy zz",
            value=lambda s: s.sigma,
        ),
        Column(name="sigma_1", unit="Pa", about="largest (most tensile) principal stress", value=lambda s: s.sigma_1),
        Column(name="sigma_3", unit="Pa", about="smallest principal stress", value=lambda s: s.sigma_3),
        Column(
            name="failure_mode", unit="1", about="0 intact, 1 failed in tension, 2 failed in shear",
            value=lambda s: s.failure_mode,
        ),
        Column(name="failure_time", unit="s", about="NaN where intact", value=lambda s: s.failure_time),
        Column(name="volume", unit="m^dim", about="current volume, in 2D an area", value=lambda s: s.volume),
        Column(
            name="strength_factor", unit="1", about="on cohesion and tensile strength; 1 in uniform rock",
            value=lambda s: s.strength,
        ),
        Column(
            name="margin", unit="1", about="how near to failure: 1 unloaded or pressed from all sides, 0 at failure "
            "and where failed; NaN in rock that does not break",
            value=lambda s: s.margin,
        ),
        Column(
            name="governs", unit="1", about="the failure that the margin is to, or that it was: 1 tension, 2 shear, "
            "0 none",
            value=lambda s: s.governs,
        ),
        Column(name="damage", unit="1", about="fraction of the strength lost, 0 to 1", value=lambda s: s.damage),
        Column(
            name="aperture_m", unit="m", about="opening of the crack in the particle; NaN by the paper's laws, "
            "which know none",
            value=lambda s: s.aperture,
        ),
        Column(
            name="rock", unit="1", about="which rock of the scene: 0 the scene's own, then the others in the order of "
            "bodies",
            only="in scenes of several rocks", value=lambda s: s.rock, wanted=lambda s: s.rock is not None,
        ),
    ),
)  # fmt: skip

INSTANT = Table(
    file="field data of particles_0000.vtu, ...",
    about=(
        "Numbers of the whole specimen at the time of a VTU file, in ParaView's Information panel; what is not defined "
        "is left out. The names of the failure modes stand beside them with their codes: `failure_mode_tension` is 1."
    ),
    columns=(
        Column(name="time_s", unit="s", about="time of the run, that of the platens", value=lambda view: view.time),
        Column(
            name="true_time_s", unit="s", about="time without mass scaling: time_s / time_scale",
            value=lambda view: view.true_time,
        ),
        Column(
            name="axial_strain", unit="1", about="nominal strain, compression positive", value=lambda view: view.strain
        ),
        Column(
            name="nominal_stress_Pa", unit="Pa", about="mean of both sides of the load cell since the history row "
            "before, confining pressure included; compression positive",
            value=lambda view: view.load.stress,
        ),
    ),
)  # fmt: skip
