"""cracks.csv, fragments.csv and acoustic.csv."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rsmpm_ti.analysis.crack_bands import Crack
from rsmpm_ti.analysis.fracture import Fracture
from rsmpm_ti.analysis.fragments import Fragment
from rsmpm_ti.analysis.load_curve import load_at
from rsmpm_ti.output.files import write_table
from rsmpm_ti.records.snapshot import MODE_NAMES
from rsmpm_ti.records.tables import Column, Table


@dataclass(frozen=True, kw_only=True)
class CrackRow:
    """A crack with what is said of it in a row of cracks.csv."""

    number: int
    crack: Crack
    stress: float  # nominal, when it began [Pa]
    strain: float
    rayleigh_speed: float  # [m/s]
    time_scale: float
    aperture: np.ndarray  # opening along its path where it is known [m]
    slip: np.ndarray  # sliding of its faces there [m]


@dataclass(frozen=True, kw_only=True)
class Named:
    """A fragment and what it is called: its number, or dust."""

    name: int | str
    fragment: Fragment
    time_scale: float


def each(value: Callable) -> Callable:
    """Entries of a column, by a function of one row."""
    return lambda rows: [value(row) for row in rows]


def course(value: Callable) -> Callable:
    """The same of a crack's line, of which there is none in 3D."""
    return each(lambda row: None if row.crack.course is None else value(row.crack.course))


CRACKS = Table(
    file="cracks.csv",
    about="One row per crack, a connected band of failed particles, in the order in which they began.",
    columns=(
        Column(name="crack", unit="1", about="number, from 0", value=each(lambda row: row.number)),
        Column(
            name="particles", unit="1", about="failed particles in it; one that failed twice counts once",
            value=each(lambda row: row.crack.particles),
        ),
        Column(
            name="tension_failures", unit="1", about="failures in tension", value=each(lambda row: row.crack.tension)
        ),
        Column(name="shear_failures", unit="1", about="failures in shear", value=each(lambda row: row.crack.shear)),
        Column(
            name="shear_share", unit="1", about="fraction of its failures that are in shear",
            value=each(lambda row: row.crack.shear / (row.crack.tension + row.crack.shear)),
        ),
        Column(
            name="shear_energy_share", unit="1", about="fraction of its energy that shear failures released",
            value=each(lambda row: row.crack.shear_energy / row.crack.released if row.crack.released > 0.0 else None),
        ),
        Column(
            name="released_energy_J", unit="J", about="released by its failures; per metre of thickness in 2D",
            value=each(lambda row: row.crack.released),
        ),
        Column(
            name="initiation_time_s", unit="s", about="time of its first failure",
            value=each(lambda row: row.crack.origin.time),
        ),
        Column(
            name="initiation_true_time_s", unit="s", about="the same without mass scaling: over time_scale",
            value=each(lambda row: row.crack.origin.time / row.time_scale),
        ),
        Column(
            name="initiation_stress_Pa", unit="Pa", about="nominal stress then, compression positive",
            value=each(lambda row: row.stress),
        ),
        Column(name="initiation_strain", unit="1", about="nominal strain then", value=each(lambda row: row.strain)),
        Column(
            name="initiation_{axis}_m",
            unit="m",
            about="where it began",
            value=each(lambda row: row.crack.origin.position),
        ),
        Column(
            name="initiation_mode", unit="", about="tension or shear, of its first failure",
            value=each(lambda row: MODE_NAMES[row.crack.origin.mode]),
        ),
        Column(
            name="flaw_tip", unit="", about="the flaw's end it began at: number of the flaw and + or -; empty: none",
            value=each(lambda row: row.crack.origin.tip),
        ),
        Column(
            name="leaving_angle_deg", unit="degree", about="between the flaw's continuation and the crack, by the rule "
            "of `initiation[].angle_deg` of summary.json",
            value=each(lambda row: row.crack.origin.angle),
        ),
        Column(
            name="growth_m", unit="m", about="furthest distance within the band from where the crack began",
            value=each(lambda row: row.crack.length_at[-1]),
        ),
        Column(
            name="tip_speed_m_s", unit="m/s", about="largest speed of its tip, in the run's own time",
            value=each(lambda row: float(row.crack.speed_at.max())),
        ),
        Column(
            name="true_tip_speed_m_s", unit="m/s", about="the same without mass scaling: times time_scale",
            value=each(lambda row: float(row.crack.speed_at.max()) * row.time_scale),
        ),
        Column(
            name="tip_speed_over_rayleigh", unit="1", about="the same over the Rayleigh speed of the rock as run",
            value=each(lambda row: float(row.crack.speed_at.max()) / row.rayleigh_speed),
        ),
        Column(
            name="length_m", unit="m", about="of its line; 2D, and none of a zone wider than a quarter of it",
            value=course(lambda line: line.length),
        ),
        Column(
            name="tortuosity", unit="1", about="length over the distance of its ends; 2D",
            value=course(lambda line: line.tortuosity),
        ),
        Column(
            name="direction_deg", unit="degree", about="mean direction from +x, 0 to 180; 2D",
            value=course(lambda line: line.direction),
        ),
        Column(
            name="width_m", unit="m", about="area of its failed particles over its length; 2D",
            value=course(lambda line: line.width),
        ),
        Column(
            name="aperture_mean_m", unit="m", about="mean opening along the line at the end of the run; 2D",
            value=each(lambda row: row.aperture.mean() if len(row.aperture) else None),
        ),
        Column(
            name="aperture_max_m", unit="m", about="largest opening along the line; 2D",
            value=each(lambda row: row.aperture.max() if len(row.aperture) else None),
        ),
        Column(
            name="slip_mean_m", unit="m", about="mean sliding of its faces on each other, dextral positive; 2D",
            value=each(lambda row: row.slip.mean() if len(row.slip) else None),
        ),
    ),
)  # fmt: skip

FRAGMENTS = Table(
    file="fragments.csv",
    about=(
        "Pieces of intact rock at the end of the run, by falling mass; those of fewer than 4 particles together in a "
        "row `dust`. Failed particles belong to none."
    ),
    columns=(
        Column(name="fragment", unit="", about="number, from 0, or dust", value=each(lambda row: row.name)),
        Column(name="particles", unit="1", about="particles in it", value=each(lambda row: row.fragment.particles)),
        Column(
            name="mass_kg", unit="kg", about="the rock's own mass, per metre of thickness in 2D",
            value=each(lambda row: row.fragment.mass),
        ),
        Column(
            name="diameter_m", unit="m", about="of the disc (2D) or ball of its volume",
            value=each(lambda row: row.fragment.diameter),
        ),
        Column(name="{axis}_m", unit="m", about="its centre of mass", value=each(lambda row: row.fragment.centroid)),
        Column(
            name="v{axis}_m_s", unit="m/s", about="its velocity, in the run's own time",
            value=each(lambda row: row.fragment.velocity),
        ),
        Column(
            name="true_v{axis}_m_s", unit="m/s", about="the same without mass scaling: times time_scale",
            value=each(lambda row: row.fragment.velocity * row.time_scale),
        ),
    ),
)  # fmt: skip

ACOUSTIC = Table(
    file="acoustic.csv",
    about=(
        "Acoustic events: failures near each other in space and time, as sensors of a laboratory would hear them "
        "together; in the order of time."
    ),
    columns=(
        Column(name="time_s", unit="s", about="of its first failure", value=lambda s: s.catalogue.time),
        Column(
            name="true_time_s", unit="s", about="the same without mass scaling: time_s / time_scale",
            value=lambda s: s.catalogue.time / s.time_scale,
        ),
        Column(name="{axis}_m", unit="m", about="where that was, the hypocentre", value=lambda s: s.catalogue.position),
        Column(
            name="energy_J", unit="J", about="released by all its failures; per metre of thickness in 2D",
            value=lambda s: s.catalogue.energy,
        ),
        Column(
            name="magnitude", unit="1", about="(2/3) log10(energy / 1 J); its zero is a convention",
            value=lambda s: s.catalogue.magnitude,
        ),
        Column(name="failures", unit="1", about="failures in it", value=lambda s: s.catalogue.failures),
        Column(
            name="particles", unit="1", about="particles in it; one that failed twice counts once",
            value=lambda s: s.catalogue.particles,
        ),
        Column(
            name="shear_share", unit="1", about="fraction of its failures that are in shear",
            value=lambda s: s.catalogue.shear_fraction,
        ),
        Column(
            name="nominal_stress_Pa", unit="Pa", about="nominal stress then, compression positive",
            value=lambda s: s.stress,
        ),
        Column(
            name="cumulative", unit="1", about="events so far, this one included",
            value=lambda s: np.arange(1, len(s.catalogue) + 1),
        ),
    ),
)  # fmt: skip


@dataclass(frozen=True)
class Heard:
    """Acoustic events and the nominal stress [Pa] at each."""

    catalogue: object
    stress: np.ndarray
    time_scale: float


def write_fracture(file: Callable[[str], Path], fracture: Fracture, history: np.ndarray) -> None:
    """cracks.csv, fragments.csv and acoustic.csv; with nothing in them, their headers. file: the path of a name."""
    scale = fracture.time_scale
    pieces = [Named(name=k, fragment=piece, time_scale=scale) for k, piece in enumerate(fracture.fragments.pieces)]
    if fracture.fragments.dust is not None:
        pieces.append(Named(name="dust", fragment=fracture.fragments.dust, time_scale=scale))
    heard = Heard(fracture.acoustic, load_at(history, fracture.acoustic.time)[0], scale)
    write_table(file(CRACKS.file), CRACKS, _crack_rows(fracture, history), fracture.dim)
    write_table(file(FRAGMENTS.file), FRAGMENTS, pieces, fracture.dim)
    write_table(file(ACOUSTIC.file), ACOUSTIC, heard, fracture.dim)


def _crack_rows(fracture: Fracture, history: np.ndarray) -> list[CrackRow]:
    rows = []
    for k, crack in enumerate(fracture.cracks):
        stress, strain = load_at(history, crack.origin.time)
        opening, slip = fracture.openings[k].T if crack.course is not None else np.zeros((2, 0))
        known = np.isfinite(opening)
        rows.append(
            CrackRow(
                number=k,
                crack=crack,
                stress=float(stress),
                strain=float(strain),
                rayleigh_speed=fracture.rayleigh_speed,
                time_scale=fracture.time_scale,
                aperture=opening[known],
                slip=slip[known],
            )  # fmt: skip
        )
    return rows
