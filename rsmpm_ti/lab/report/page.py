"""report.html: data and pictures of a test -> one page. Names and sentences of strangers are escaped by Jinja2."""

from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from rsmpm_ti.lab.report.curves import drawings_of
from rsmpm_ti.lab.report.envelopes import envelope_drawings
from rsmpm_ti.lab.report.pictures import SHOWN_RUNS, corners, movie_of, pictures_of
from rsmpm_ti.lab.report.tables import RUN_NUMBERS, number, quantity_rows, run_rows, scene_rows, sheet_rows
from rsmpm_ti.lab.standard import Measured
from rsmpm_ti.records.files import complete

HERE = Path(__file__).parent
PAGE = "report.html"


def page_of(report: dict, measured: list[list[Measured]]) -> str:
    """The page, from what record.py made and from the runs' own files."""
    runs = [one for seed in measured for one in seed]
    movie, no_movie = movie_of(runs[0])
    environment = Environment(
        loader=FileSystemLoader(HERE), autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    return environment.get_template(
        "page.html.j2"
    ).render(
        report=report,
        style=Markup((HERE / "style.css").read_text(encoding="utf-8")),  # our own file
        grave=[doubt for doubt in report["doubts"] if doubt["grave"]],
        notes=[doubt for doubt in report["doubts"] if not doubt["grave"]],
        quantities=quantity_rows(report),
        drawings=[*envelope_drawings(report, measured), *drawings_of(report["test"], measured)],
        as_svg=Markup,  # made by matplotlib, which escapes texts
        galleries=[(one.specimen, size_of(one), pictures_of(report["test"], one)) for one in runs[:SHOWN_RUNS]],
        without_pictures=report["runs"][SHOWN_RUNS:],
        movie=movie,
        no_movie=no_movie,
        runs=run_rows(report),
        headings=[heading for heading, *_ in RUN_NUMBERS],
        sheet=sheet_rows(report["rock"]),
        scene=scene_rows(report),
    )


def size_of(one: Measured) -> str:
    """Width and height of a specimen, as people read them."""
    low, high = corners(one)
    return f"{number(high[0] - low[0], 1e-3, 3)} mm wide, {number(high[1] - low[1], 1e-3, 3)} mm high"


def write_page(out: Path, report: dict, measured: list[list[Measured]]) -> None:
    with complete(out / PAGE) as part:
        part.write_text(page_of(report, measured), encoding="utf-8")
