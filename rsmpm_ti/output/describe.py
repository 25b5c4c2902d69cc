"""python -m rsmpm_ti.output.describe: prints docs/outputs.md, from the tables that the files are written from."""

import sys
import typing

from rsmpm_ti.checks import members
from rsmpm_ti.output.fracture_tables import ACOUSTIC, CRACKS, FRAGMENTS
from rsmpm_ti.records.events import EVENTS
from rsmpm_ti.records.frame_table import FRAMES
from rsmpm_ti.records.history_table import HISTORY
from rsmpm_ti.records.reaction_table import REACTIONS
from rsmpm_ti.records.snapshot import INSTANT, PARTICLES
from rsmpm_ti.records.summary_table import RECORD, SUMMARY
from rsmpm_ti.records.tables import Table
from rsmpm_ti.rock.rock import Rock

HEAD = """\
# What a run writes

<!-- Printed by `python -m rsmpm_ti.output.describe`; edit the tables in rsmpm_ti/records and rsmpm_ti/output. -->

A run writes into one folder, `renders/NAME` unless `--out` says otherwise. Every file appears under its name only when
it is complete and on the disk. `manifest.txt` lists the files of the run: what is not on it is yours, and is never
removed, moved or replaced. A folder is at any time of one run; while that is under way, `summary.json` is not there or
says that it is not complete. SI units throughout; angles in degrees. Stresses of the load curve are compression
positive, as tests report them; stresses of particles and failures are tension positive. In 2D energies, masses and
forces are per metre of thickness. In a CSV an empty cell means *not defined*, and so does `null` in JSON and `NaN` in a
VTU file: a number that is not finite is never written otherwise, and no 0 in place of it. Numbers in a CSV have ten
digits. A name with `{axis}` stands for one column for each axis: x, y and in 3D z.

| file | what it is |
|---|---|
| `frames/stress_0000.png`, ... | maximum principal stress, tension red; the inset is the load curve so far |
| `frames/cracks_0000.png`, ... | what has failed, and how; each frame has its time in the file, as a note `time_s` |
| `frames/margin_0000.png`, ... | how near the rock is to failure; with `--margin` |
| `NAME.mp4` | cracks on the left, stress on the right, of all frames |
| `summary.png` | the load curve with acoustic events; the cracks at the largest load and at the end |
| `manifest.txt` | the files of this run, a name a line, each listed before it is made |
"""

TAIL = """\
## checkpoint.npz, checkpoint.previous.npz

The run in the middle, as NumPy arrays, for `--resume`: every component of every particle field, sums over steps,
failures, the history, the clock, and what each observer returned as its state. The second is the one before, and is
used where the first is damaged. No code is run when one is read.
"""


def page() -> str:
    """docs/outputs.md."""
    files = [
        *(f"| [{table.file}](#{anchor(table)}) | {sentence(table.about)} |\n" for table in TABLES),
        "| `particles.pvd` | list of the VTU files with their times; open this one in ParaView |\n",
        "| `checkpoint.npz` | from which `--resume` goes on |\n",
    ]
    sections = [section(table) + (of_laws() if table is PARTICLES else "") for table in TABLES]
    return "\n".join([HEAD + "".join(files), *sections, YOURS, TAIL])


YOURS = """\
## Columns and observers of your own

`simulate(scene, columns=(Column(name="speed_m_s", unit="m/s", about="...", value=lambda view: view.survey.speed),))`
adds a column to history.csv and `Result.history`. `simulate(scene, observers=(Mine(),))` lets an `Observer` look at the
run at its own interval and write what it likes; see its docstring, and that of `View` for what there is to see. A
`Gauge` in `Loading(cell=LoadCell(gauges=(...)))` adds a column `gauge_NAME`, or `gauge_NAME_m` for one that reads an
opening.
"""

TABLES = (HISTORY, REACTIONS, FRAMES, EVENTS, CRACKS, FRAGMENTS, ACOUSTIC, PARTICLES, INSTANT, SUMMARY, RECORD)


def anchor(table: Table) -> str:
    """As GitHub makes it of a heading."""
    return "".join(c for c in table.file.lower().replace(" ", "-") if c.isalnum() or c in "-_")


def sentence(text: str) -> str:
    """The first one."""
    return text.partition(". ")[0].rstrip(".")


def section(table: Table) -> str:
    rows = []
    for column in table.columns:
        about = f"{column.about} (only {column.only})" if column.only else column.about
        rows.append(f"| `{column.name}` | {column.unit} | {about} |")
    return "\n".join([f"## {table.file}", "", table.about, "", "| name | unit | meaning |", "|---|---|---|", *rows, ""])


def of_laws() -> str:
    """What the laws after failure of this package remember of a particle: more rows for the VTU table."""
    rows = []
    for law in members(typing.get_type_hints(Rock)["after_failure"]):
        for variable in getattr(law, "history", ()):
            name = f"law_{variable.name}" if variable.name in PARTICLES.names else variable.name
            about = f"{variable.about}{', 3 components' if variable.per_axis else ''} (only `{law.__name__}`)"
            rows.append(f"| `{name}` | {variable.unit} | {about} |\n")
    return "".join(rows)


if __name__ == "__main__":
    sys.stdout.write(page())
