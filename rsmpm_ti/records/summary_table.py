"""The keys of summary.json; who makes the values is said in `run/finish.py`."""

from rsmpm_ti.records.tables import Column, Table


def _key(name: str, unit: str, about: str) -> Column:
    return Column(name=name, unit=unit, about=about)


def _of_rocks(name: str, unit: str, about: str) -> Column:
    return Column(name=name, unit=unit, about=about, only="in scenes of several rocks")


FLAWED = "; empty or null but for 2D scenes of one flaw in which something failed"

SUMMARY = Table(
    file="summary.json",
    about=(
        "The numbers of a run that people quote, and how it went. Onset: a particle first begins to lose strength; "
        "first failure: one has lost half of it. In rock without fracture energy they are one. Under confinement axial "
        "stresses are whole ones, the pressure included, and strains count from the confined state."
    ),
    columns=(
        _key("particles", "1", "particles at the start"),
        _key("steps", "1", "steps taken"),
        _key("dt_s", "s", "time step, the last one where steps adapt"),
        _key("wall_s", "s", "wall time of the run without start-up, of all its parts if it was resumed"),
        _key("compile_s", "s", "wall time of start-up: kernels are compiled or found kept, and bodies settle"),
        _key("painting_s", "s", "what of `wall_s` went to observers: copying particles out, waiting for the writer"),
        _key("painting_cpu_s", "s", "processor time of the process that paints and writes"),
        _key("particle_steps_per_s", "1/s", "particles times steps over the solver's time"),
        _key("time_scale", "1", "mass scaling: density is multiplied by its square"),
        _key("least_pace", "1", "least fraction of their speed at which the servo let the platens go, 1 without one"),
        _key("local_damping_J", "J", "what local damping took, part of the dissipated energy"),
        _key("confinement_Pa", "Pa", "confining pressure"),
        _key("onset_stress_Pa", "Pa", "nominal stress at onset, compression positive"),
        _key("onset_strain", "1", "nominal strain at onset"),
        _key("first_failure_stress_Pa", "Pa", "nominal stress at first failure, extrapolated from the rows before it"),
        _key("first_failure_strain", "1", "nominal strain then"),
        _key("first_failure_time_s", "s", "time of first failure"),
        _key("first_failure_true_time_s", "s", "the same without mass scaling: over time_scale"),
        _key("first_failure_mode", "", "tension or shear"),
        _key("first_failure_position_m", "m", "where it was, a list of coordinates"),
        _key(
            "first_crack_angles_deg", "degree", "of the first cracks at the two tips; for rock whose cracks have a "
            "direction" + FLAWED,
        ),
        _key("wing_reach_m", "m", "distance from the two wings to the platens they grow to" + FLAWED),
        _key("half_turn_mismatch_m", "m", "distance of one wing from the other turned by 180 degrees" + FLAWED),
        _key("failed_tension", "1", "failures in tension"),
        _key("failed_shear", "1", "failures in shear"),
        _of_rocks("by_rock", "", "list: failures by rock, in the order of the scene's rocks, as follows"),
        _of_rocks("by_rock[].rock", "", "`rock`, or `bodies[k].rock` of the first body of that rock"),
        _of_rocks("by_rock[].particles", "1", "particles of it at the start"),
        _of_rocks("by_rock[].failed_tension", "1", "their failures in tension"),
        _of_rocks("by_rock[].failed_shear", "1", "their failures in shear"),
        _key("apparent_modulus_Pa", "Pa", "slope of the curve between 0.2 and 0.9 of the time to onset"),
        _key("platen_imbalance", "1", "up to onset: mean difference of both sides over their mean added stress"),
        _key("platen_imbalance_max", "1", "largest such ratio of rows with a tenth of the load or more"),
        _key("kinetic_share", "1", "kinetic over elastic energy in the last row before onset"),
        _key("largest_stress_Pa", "Pa", "nominal stress of largest size so far, of one row, with its sign"),
        _key(
            "peak_stress_Pa", "Pa", "the same, where it is a peak: the filtered load has fallen by a tenth of its own "
            "largest since; else null",
        ),
        _key(
            "peak_filtered_Pa", "Pa", "the peak of the filtered load, its running median over a quarter of a wave "
            "transit from platen to platen, at least three rows; what one row alone shows is no part of it",
        ),
        _key("peak_filtered_strain", "1", "nominal strain there"),
        _key("energy_balance_error", "1", "largest residual of kinetic + elastic + dissipated - work, over the work "
             "and the energy at the start"),
        _key("energy_balance_error_elastic", "1", "the same up to onset"),
        _key(
            "kinetic_share_after", "1", "after first failure: largest kinetic energy over the largest elastic energy "
            "so far; null where nothing failed",
        ),
        _key("cracks", "1", "rows of cracks.csv"),
        _key("crack_length_m", "m", "sum of the lengths of all cracks; null in 3D"),
        _key("fragments", "1", "pieces of intact rock, without dust"),
        _key("largest_fragment_share", "1", "mass of the largest over that of the specimen"),
        _key("acoustic_events", "1", "rows of acoustic.csv"),
        _key("b_value", "1", "slope of log10 N(magnitude); null for too few events"),
        _key("b_value_error", "1", "its standard error"),
        _key(
            "initiation_angles_deg", "degree", "`initiation[].angle_deg` of both tips of the flaw; empty but for 2D "
            "scenes of one flaw",
        ),
        _key("initiation", "", "list: the first failure near each flaw tip that became part of a crack, as follows"),
        _key("initiation[].flaw", "1", "number of the flaw, from 0"),
        _key("initiation[].tip", "", "number of the flaw and + or -"),
        _key("initiation[].tip_m", "m", "where the tip is"),
        _key("initiation[].stress_Pa", "Pa", "nominal stress then; null where nothing grew, as all that follows"),
        _key("initiation[].strain", "1", "nominal strain then"),
        _key("initiation[].time_s", "s", "its time"),
        _key("initiation[].true_time_s", "s", "the same without mass scaling: over time_scale"),
        _key("initiation[].position_m", "m", "where it was"),
        _key(
            "initiation[].angle_deg", "degree", "between the flaw's continuation and the crack where it leaves. In "
            "rock whose cracks have a direction: the median direction of its first failures in tension, at most 20, "
            "within 3 mm of the flaw's end (and half its width). In other rock, and of a crack that begins in shear: "
            "the line through its failures of one mode within 3 mm of the first, before it is 6 mm long. Null for "
            "fewer than 6",
        ),
        _key("initiation[].mode", "", "tension or shear"),
        _key("initiation[].crack", "1", "number of the crack in cracks.csv"),
        _key("numerical_fracture", "", "a warning that intact particles have parted; null where they have not"),
        _key("dropped", "1", "particles that left the domain and were taken out"),
        _key("dropped_mass_kg", "kg", "their mass, the rock's own"),
        _key("dropped_momentum_kg_m_s", "kg m/s", "their momentum, mass scaling included"),
        _key("dropped_energy_J", "J", "their kinetic and elastic energy"),
        _key("excavated", "1", "particles that were excavated"),
        _key("stopped", "", "why the run ended before the end of its schedule; empty where it did not"),
        _key(
            "complete", "", "whether the run came to its end and every file of it is there; false or no file while a "
            "run is under way, and where frames or particle files were lost before --resume",
        ),
        _key("warnings", "", "list of sentences: what the numbers must not be taken for, and what went wrong beside"),
    ),
)  # fmt: skip

RECORD = Table(
    file="scene.json",
    about="What was run. `scene scene.json` runs it again; nothing in it is executed. Of an image or a mesh it holds "
    "the name and the SHA-256 of the file, which must be there ([drawings.md](drawings.md#what-the-record-holds)). An "
    "object of a class that the scene file brought is told by its class and, under `own`, by what it holds "
    "(`unrecorded`: what no file can hold); such a record is refused: run the scene file again.",
    columns=(
        _key("rsmpm_ti", "", "version of the program"),
        _key("name", "", "name of the run"),
        _key("precision", "", "f64 or f32"),
        _key("seeds", "1", "random seed of each body's seeding, null for a lattice"),
        _key("machine", "", "versions of Python and of packages, kind of machine"),
        _key("time_scale", "1", "the number that loading.time_scale comes to"),
        _key("scene", "", "the whole scene: classes by name, with their fields"),
    ),
)
