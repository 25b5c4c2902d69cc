"""The columns of history.csv. Each is made from a `View` of the run (`solver/view.py`)."""

import numpy as np

from rsmpm_ti.records.tables import Column, Table

HISTORY = Table(
    file="history.csv",
    about=(
        "The curve of the test, one row per look at the particles: about `schedule.rows` of them. "
        "`Result.history` is the same as a structured NumPy array. Energies are per metre of thickness in 2D. "
        "Platen forces and stresses are means over the steps since the row before; everything else is of the row's "
        "time. Under confinement stress is the whole axial stress, the pressure included, and strain and work count "
        "from the confined state. Gauges of the scene and columns of your own follow."
    ),
    columns=(
        Column(name="time_s", unit="s", about="time of the run, that of the platens", value=lambda view: view.time),
        Column(
            name="true_time_s", unit="s", about="time without mass scaling, that of waves and of running cracks: "
            "time_s / time_scale",
            value=lambda view: view.true_time,
        ),
        Column(
            name="axial_strain", unit="1", about="nominal strain: how far the platens, or a platen and what "
            "faces it, have closed in, over their distance; compression positive",
            value=lambda view: view.strain,
        ),
        Column(
            name="lateral_strain", unit="1", about="across the load: how far the sides have closed in, over their "
            "distance; compression positive, so negative while the specimen bulges. By least squares from intact rock "
            "of both sides, over the middle half of the height; in 3D the mean of both directions",
            value=lambda view: view.lateral_strain,
        ),
        Column(
            name="volumetric_strain", unit="1", about="axial_strain and the lateral strains, added; compression "
            "positive. In 2D that of plane strain; not defined in plane stress",
            value=lambda view: view.volumetric_strain,
        ),
        Column(
            name="stress_top_Pa", unit="Pa", about="nominal stress at the upper side of the load cell: force over "
            "width, and the confining pressure; compression positive",
            value=lambda view: view.load.stress_upper,
        ),
        Column(
            name="stress_bottom_Pa", unit="Pa", about="the same at the lower side",
            value=lambda view: view.load.stress_lower,
        ),
        Column(
            name="energy_kinetic_J", unit="J", about="kinetic energy, mass scaling included, that of waves and of "
            "running cracks",
            value=lambda view: view.survey.kinetic,
        ),
        Column(
            name="energy_kinetic_true_density_J", unit="J", about="the same with the rock's own density, that of the "
            "motion at the platens' speed: energy_kinetic_J / time_scale^2",
            value=lambda view: view.survey.kinetic / view.scene.time_scale**2,
        ),
        Column(
            name="energy_elastic_J", unit="J", about="elastic energy stored", value=lambda view: view.survey.elastic
        ),
        Column(
            name="energy_dissipated_J",
            unit="J",
            about="dissipated since the start by failure, viscosity, local damping, PIC's part of the transfer and "
            "impact on boundaries; gone with rock that left or was excavated; absorbed by boundaries",
            value=lambda view: view.survey.dissipated,
        ),
        Column(
            name="work_J", unit="J", about="work of boundaries, body force, confining pressure, pressure in holes and "
            "supports of what was excavated, since the start",
            value=lambda view: view.survey.work,
        ),
        Column(
            name="failed_tension", unit="1", about="failures in tension so far",
            value=lambda view: view.survey.failed_tension,
        ),
        Column(
            name="failed_shear", unit="1", about="failures in shear so far",
            value=lambda view: view.survey.failed_shear,
        ),
        Column(name="dt_s", unit="s", about="time step", value=lambda view: view.dt),
        Column(
            name="force_top_N", unit="N", about="force of all boundaries of the load cell's upper side on the "
            "specimen, pressing positive; per metre of thickness in 2D",
            value=lambda view: view.load.force_upper,
        ),
        Column(
            name="force_bottom_N", unit="N", about="the same of its lower side",
            value=lambda view: view.load.force_lower,
        ),
    ),
)  # fmt: skip

PEAK_DROP = 0.1
"""The load has passed a peak where it has fallen by this fraction of its largest: more than waves swing it in a test
that is quasi-static."""

HISTORY_COLUMNS = HISTORY.names
"""Columns of every history: fields of the structured array `Result.history`, all float64."""


def nominal_stress(history: np.ndarray) -> np.ndarray:
    """Mean of both sides of the load cell [Pa], [rows], compression positive; of a cell that reads one, that side."""
    top, bottom = history["stress_top_Pa"], history["stress_bottom_Pa"]
    both = 0.5 * (top + bottom)
    return np.where(np.isnan(both), np.where(np.isnan(top), bottom, top), both)
