"""The report of a standard test: every section there, strangers' words escaped, the same data the same bytes."""

import json
import math
import re
from html import unescape
from html.parser import HTMLParser

import numpy as np
import pytest
from PIL import Image
from reported import END, FRAMES, report_and_runs

from rsmpm_ti.lab.catalogue import TESTS
from rsmpm_ti.lab.record import write_records
from rsmpm_ti.lab.report.curves import Drawing, drawings_of
from rsmpm_ti.lab.report.envelopes import envelope_drawings, line_of
from rsmpm_ti.lab.report.page import PAGE, page_of, write_page
from rsmpm_ti.lab.report.pictures import chosen, frames_of, movie_of, pictures_of
from rsmpm_ti.lab.report.tables import number, quantity_rows, sheet_rows, shown

SECTIONS = ["results", "curves", "cracks", "movie", "runs", "rock", "limits", "scene", "again"]
EVIL = '<script>alert(1)</script> & "quoted" {{ 7 * 7 }}'
MOST_BYTES = 3_000_000

pytestmark = pytest.mark.filterwarnings("ignore::rsmpm_ti.errors.RockWarning")  # of cells as coarse as --quick has


class Tags(HTMLParser):
    """Opened and closed tags match; keeps what elements refer to."""

    ALONE = {"meta", "link", "img", "br"}

    def __init__(self, text: str):
        super().__init__()
        self.open, self.names, self.references, self.ids = [], [], [], []
        self.feed(text)
        assert self.open == []

    def handle_starttag(self, tag, attributes):
        self.names.append(tag)
        self.references += [value for name, value in attributes if name in ("src", "href", "xlink:href", "action")]
        self.ids += [value for name, value in attributes if name == "id"]
        if tag not in self.ALONE:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.handle_starttag(tag, attributes)
        if tag not in self.ALONE:
            self.open.pop()

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


@pytest.mark.parametrize("test", TESTS)
def test_every_section_is_there_for_every_test(tmp_path, test):
    report, measured = report_and_runs(test, tmp_path)
    page = page_of(report, measured)
    tags = Tags(page)
    assert re.findall(r'<section id="(\w+)">', page) == SECTIONS
    words = unescape(page)
    assert all(one["name"] in words for one in report["quantities"])
    assert all(limit in words for limit in TESTS[test].limits) and report["commands"][0] in words
    assert tags.names.count("svg") >= 3 and tags.names.count("img") == 3 * len(report["runs"][:6])
    assert "script" not in tags.names
    assert len(tags.ids) == len(set(tags.ids)), "ids of one drawing are not those of another"


def test_nothing_is_loaded_from_elsewhere(tmp_path):
    tags = Tags(page_of(*report_and_runs("tension", tmp_path)))
    ours = re.compile(r"data:|#|runs/|report\.json$|quantities\.csv$")
    assert [one for one in tags.references if not ours.match(one)] == []


def test_words_of_strangers_are_escaped(tmp_path):
    report, measured = report_and_runs("tension", tmp_path, name=EVIL, warnings=[EVIL], stopped=EVIL)
    report["rock"] |= {"source": EVIL, "sources": {"E": EVIL}}
    report["doubts"] = [{"run": EVIL, "grave": True, "sentence": EVIL}]
    report["commands"] = [EVIL]
    page = page_of(report | {"valid": False}, measured)
    assert "<script" not in page and page.count("&lt;script&gt;") >= 7
    assert "{{ 7 * 7 }}" in page and "49" not in re.findall(r"quoted[^<]*", page)[0], "a name is no template"
    Tags(page)


def test_verdict_says_valid_or_why_not(tmp_path):
    report, measured = report_and_runs("tension", tmp_path)
    page = page_of(report, measured)
    assert report["valid"] and "<strong>Valid.</strong>" in page and "Not valid" not in page
    report, measured = report_and_runs("tension", tmp_path / "other", numerical_fracture="particles have parted")
    page = page_of(report, measured)
    assert "<strong>Not valid.</strong>" in page and "particles have parted" in page


def test_what_is_not_a_number_is_not_defined(tmp_path):
    report, measured = report_and_runs("tension", tmp_path, peak_filtered_Pa=None, peak_filtered_strain=None)
    page = page_of(report, measured)
    row = quantity_rows(report)[0]
    assert (row["name"], row["value"], row["off"]) == ("tensile strength", "not defined", "")
    assert "not defined" in page and not re.search(r"\b[Nn]a[Nn]\b|\bNone\b", re.sub(r"base64,[\w+/=]*", "", page))
    assert number(math.nan) == number(None) == number(1e307) == shown(math.inf, "m") == "not defined"


def test_the_same_data_gives_the_same_bytes(tmp_path):
    report, measured = report_and_runs("ucs", tmp_path)
    assert page_of(report, measured) == page_of(report, measured)


def test_page_is_written_beside_its_data_and_small(tmp_path):
    report, measured = report_and_runs("triaxial", tmp_path, seeds=2)
    write_records(tmp_path, report)
    write_page(tmp_path, report, measured)
    assert {path.name for path in tmp_path.iterdir()} == {PAGE, "report.json", "quantities.csv", "runs"}
    assert (tmp_path / PAGE).stat().st_size < MOST_BYTES
    data = json.loads((tmp_path / "report.json").read_text(encoding="utf-8"))
    assert data["runs"][0]["scene"]["shape"] and data["machine"]["numpy"] == np.__version__
    page = (tmp_path / PAGE).read_text(encoding="utf-8")
    assert "Not shown here" in page, "of eight runs six have pictures"


def test_results_are_held_against_the_sheet(tmp_path):
    report, _ = report_and_runs("tension", tmp_path, seeds=3)
    row = quantity_rows(report)[0]
    assert row["value"] == "2.2 ± 0.25 MPa" and row["given"] == "2 MPa" and row["off"] == "+10 %"
    assert row["each"] == "2.1 MPa, 2.2 MPa, 2.3 MPa"


def test_sheet_marks_what_is_estimated(tmp_path):
    report, _ = report_and_runs("tension", tmp_path)
    rows = {row["key"]: row for row in sheet_rows(report["rock"])}
    assert rows["E"]["value"] == "17 GPa" and not rows["E"]["estimated"]
    assert rows["G_f"]["estimated"] and "Zhang" in rows["G_f"]["source"] and "UCS" not in rows


# --- pictures


def test_frames_are_those_before_and_at_the_peak_and_at_the_end(tmp_path):
    _, [[one]] = report_and_runs("tension", tmp_path)
    frames = frames_of(one.folder)
    assert [time for time, _ in frames] == pytest.approx(np.linspace(0.0, END, FRAMES))
    found = {title: path.name for title, (_, path) in chosen(frames, one).items()}
    assert found == {
        "Before the peak": "cracks_0002.png", "At the peak": "cracks_0003.png", "At the end": "cracks_0005.png",
    }  # fmt: skip
    pictures = pictures_of("tension", one)
    assert [picture.title for picture in pictures] == list(found)
    assert "nominal stress 2.1 MPa" in pictures[1].caption and pictures[0].source.startswith("data:image/webp;base64,")


def test_a_frame_that_is_damaged_or_has_no_time_is_left_out(tmp_path):
    _, [[one]] = report_and_runs("tension", tmp_path)
    (one.folder / "frames/cracks_0003.png").write_bytes(b"no picture")
    Image.new("RGB", (800, 400)).save(one.folder / "frames/cracks_0004.png")
    assert len(frames_of(one.folder)) == FRAMES - 2 and len(pictures_of("tension", one)) == 3


def test_a_run_without_frames_or_movie_has_a_page(tmp_path):
    report, [[one]] = report_and_runs("tension", tmp_path)
    for path in (one.folder / "frames").iterdir():
        path.unlink()
    (one.folder / "acoustic.csv").write_text("nonsense")
    page = page_of(report, [[one]])
    assert "There are no frames to show" in page and "No movie was written" in page and "<video" not in page


def test_a_large_movie_stays_beside_the_page(tmp_path):
    _, [[one]] = report_and_runs("tension", tmp_path)
    (one.folder / "run.mp4").write_bytes(b"small")
    assert movie_of(one) == ("data:video/mp4;base64,c21hbGw=", "")
    (one.folder / "run.mp4").write_bytes(bytes(3_500_000))
    assert movie_of(one) == ("", "The movie has 3.5 MB and is not in this page.")


# --- curves


def titles(drawings: list[Drawing]) -> list[str]:
    return [drawing.title for drawing in drawings]


def test_drawings_belong_to_the_test(tmp_path):
    found = {}
    for test in TESTS:
        report, measured = report_and_runs(test, tmp_path / test)
        found[test] = titles([*drawings_of(test, measured), *envelope_drawings(report, measured)])
    assert found["tension"] == ["Stress and strain", "Energies", "Acoustic events"]
    assert "Axial, lateral and volumetric strain" in found["ucs"] and "Strength and pressure" not in found["ucs"]
    assert found["bend"][:2] == ["Load and displacement", "Load and crack mouth opening"]
    assert found["triaxial"][-1] == found["shear"][-1] == "Strength and pressure"


def test_words_in_a_drawing_stay_words_and_nothing_reaches_beyond_it(tmp_path):
    report, measured = report_and_runs("triaxial", tmp_path)
    for one in [*drawings_of("triaxial", measured), *envelope_drawings(report, measured)]:
        assert one.svg.startswith("<svg ") and one.svg.endswith("</svg>")
        assert "<text" in one.svg and "<style" not in one.svg and "http" not in one.svg


def test_line_of_an_envelope_is_that_of_its_numbers():
    quantities = [{"name": "cohesion", "value": 10e6, "given": math.nan},
                  {"name": "friction angle", "value": 30.0, "given": 30.0}]  # fmt: skip
    ucs, slope = line_of({"test": "triaxial", "quantities": quantities}, "value")
    assert ucs == pytest.approx(2.0 * 10e6 * math.sqrt(3.0)) and slope == pytest.approx(3.0)
    assert line_of({"test": "shear", "quantities": quantities}, "value") == pytest.approx((10e6, 3.0**-0.5))
    assert line_of({"test": "triaxial", "quantities": quantities}, "given") is None
