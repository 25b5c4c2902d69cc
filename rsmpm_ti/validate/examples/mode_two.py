"""Which answers depend on the energy that a crack in shear costs: G_f_II over three decades in three tests.

From 24 J/m^2, which is 4.8 G_f_I (Al-Shayea 2005, Eng. Geol. 81:84, limestone) and was the lab's rock's at first, to a
thousand times that; it has 240 now. Intact granite sheared under pressure has 1e3 to 1e4 (Lockner et al. 1991, Nature
350:39; Moore & Lockner 1995, J. Struct. Geol. 17:95). Nothing judges these rows: they say how wrong an answer can be
whose G_f_II nobody has measured.
"""

from dataclasses import replace

from rsmpm_ti.cases.case import Outcome
from rsmpm_ti.rock.presets import lab_rock
from rsmpm_ti.setups.uniaxial import uniaxial_test
from rsmpm_ti.spec.scene import Scene
from rsmpm_ti.spec.seeding import Jittered
from rsmpm_ti.units import MPa
from rsmpm_ti.validate.comparison import predict
from rsmpm_ti.validate.examples.specimen_runs import QUICK, Told, tell, to_the_peak
from rsmpm_ti.validate.experiment import Experiment, Input

ENERGIES = (24.0, 240.0, 2400.0, 24000.0)
"""G_f_II [J/m^2]; the second is that of the lab's rock."""

PRESSURE = 5.0 * MPa
"""Of the jacket of the intact specimen."""


def _jacketed(energy: float) -> Scene:
    return uniaxial_test(
        title="Triaxial test of intact rock", rock=lab_rock(G_f_II=energy, length=2e-3), dx=1e-3, width=25e-3,
        height=50e-3, strain_end=5e-3, confinement=PRESSURE, time_scale="auto", seeding=Jittered(amount=0.01),
    )  # fmt: skip


def _flawed(name: str, energy: float) -> Scene:
    """The scene with its rock's G_f_II replaced, until its load has fallen."""
    scene = to_the_peak(name, **QUICK)
    law = scene.rock.after_failure
    softer = replace(law, softening=replace(law.softening, G_f_II=energy))
    return replace(scene, rock=replace(scene.rock, after_failure=softer))


TESTS = {
    "flawed": lambda energy: _flawed("cube_lab", energy),
    "flawed, confined": lambda energy: _flawed("confined", energy),
    "intact at 5 MPa": _jacketed,
}
STRENGTHS = {"onset": "first failure", "peak": "peak"}
READ = {
    "flawed": STRENGTHS,
    "flawed, confined": STRENGTHS,
    "intact at 5 MPa": {"peak": "peak", "residual": "stress at the end"},
}
COLOURS = {"onset": "C0", "peak": "C1", "residual": "C2"}
WHY = "what depends on an energy that nobody measured for this rock; nothing judges it"


def _draw(figure, found: dict[str, list[Told]]) -> None:
    panels = figure.subplots(1, len(TESTS))
    for axes, (name, series) in zip(panels, found.items(), strict=True):
        for key, word in READ[name].items():
            axes.semilogx(
                ENERGIES,
                [getattr(t, key) / MPa for t in series],
                "o-",
                color=COLOURS[key],
                label=word,
            )
        axes.set(xlabel="G_f_II [J/m^2]", title=name, ylim=(0, None))
        axes.axvspan(1e3, 1e4, color="0.9", zorder=0)
    panels[0].set_ylabel("nominal stress [MPa]")
    for axes in (panels[0], panels[-1]):
        axes.legend(fontsize="small", loc="lower right")
    figure.suptitle("What depends on the energy of a crack in shear; grey: intact granite")


def sweep(full: bool) -> Outcome:
    found: dict[str, list[Told]] = {name: [tell(make(energy)) for energy in ENERGIES] for name, make in TESTS.items()}
    rows = [
        predict(f"{name}: {word}, G_f_II {energy:g} J/m^2", "MPa", getattr(told, key) / MPa, WHY)
        for name, series in found.items()
        for key, word in READ[name].items()
        for energy, told in zip(ENERGIES, series, strict=True)
    ]

    return Outcome(tuple(rows), lambda figure: _draw(figure, found))


CASES = (
    Experiment("mode_two", "which answers depend on the fracture energy in shear: 24 J/m2 times 1 to 1000", sweep,
               quick=False, inputs=(Input("G_f_II", ENERGIES[0], "J/m^2", "the least of the sweep"),)),
)  # fmt: skip
