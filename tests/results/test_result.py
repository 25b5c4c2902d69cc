"""A Result shows itself: curve, frames, movie and a short table; and it is read back from its folder as it was."""

import dataclasses
import math
import pickle
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from snapshots import snapshot_of

from rsmpm_ti import Result, SceneError, load_result, load_scene, simulate
from rsmpm_ti.records.events import EventTable
from rsmpm_ti.records.history_table import HISTORY_COLUMNS, nominal_stress
from rsmpm_ti.records.rows import Rows

SMALL = {
    "dx": 2e-3, "flaw_width": "6 mm", "strain_end": "0.02 %", "shape": "Linear", "schedule.rows": 50,
    "output.frames": 3, "output.vtu": 1,
}  # fmt: skip


@pytest.fixture(scope="module")
def result(tmp_path_factory) -> Result:
    """Of a specimen whose load has a peak before its end; with frames and a movie."""
    out = tmp_path_factory.mktemp("runs") / "cube"
    return simulate(load_scene("cube", settings=SMALL), out=out, name="cube", threads=1)


def made(**changes) -> Result:
    """Of a load that rises to 5 MPa and falls, at a strain of 0.1 % and on; one failure; never run."""
    history = np.zeros(101, dtype=[(name, float) for name in HISTORY_COLUMNS])
    history["time_s"] = np.arange(101) * 1e-4
    history["axial_strain"] = np.arange(101) * 2e-5
    history["stress_top_Pa"] = history["stress_bottom_Pa"] = 5e6 - abs(np.arange(101) - 50) * 1e5
    history["failed_tension"] = np.arange(101) > 30
    events = EventTable(
        time=np.array([3.05e-3]), x=np.zeros((1, 2)), mode=np.array([1]), sigma_1=np.zeros(1), sigma_3=np.zeros(1),
        released=np.zeros(1), id=np.zeros(1, dtype=int),
    )  # fmt: skip
    whole = Result(
        history=history.view(Rows), summary={}, events=events, fracture=None, snapshot=snapshot_of(np.zeros((1, 2))),
        out=None,
    )  # fmt: skip
    return dataclasses.replace(whole, **changes)


def refusal(ask) -> str:
    with pytest.raises(SceneError) as refused:
        ask()
    assert "\n" not in str(refused.value)
    return str(refused.value)


# --- settings


def test_settings_take_numbers_as_texts_do():
    assert load_scene("cube", settings=SMALL) == load_scene(
        "cube", settings={name: str(value) for name, value in SMALL.items()}
    )
    assert load_scene("cube", settings={"dx": 1e-3}).domain.dx == 1e-3
    assert load_scene("cube", settings={"schedule.rows": np.int64(70)}).schedule.rows == 70


# --- the curve


def test_plot_marks_the_peak_and_the_first_failure():
    figure = made().plot()
    assert isinstance(figure, Figure) and figure._repr_png_().startswith(b"\x89PNG")
    load, counts = figure.axes
    lines = {line.get_label(): line for line in load.get_lines()}
    curve = lines["total nominal stress [MPa]"].get_xydata()
    assert curve.max(axis=0) == pytest.approx([0.2, 5.0])  # percent, MPa
    assert load.get_title(loc="left") == "peak 5.00 MPa at 0.100 %"
    assert lines["first failure"].get_xdata() == pytest.approx([0.061, 0.061])
    assert {line.get_label() for line in counts.get_lines()} == {"failed in tension", "failed in shear"}


def test_plot_of_a_run_with_acoustic_events_counts_them(result):
    labels = [text.get_text() for text in result.plot().axes[0].get_legend().get_texts()]
    assert "acoustic events" in labels and "first failure" in labels


def test_plot_bears_a_run_without_load_failures_or_rows():
    idle = made().history.copy()
    for name in ("axial_strain", "stress_top_Pa", "stress_bottom_Pa"):
        idle[name] = np.nan
    none = made().events.until(0.0)
    for history in (idle, idle[:0], made().history[:1]):
        assert made(history=history.view(Rows), events=none).plot()._repr_png_()


def test_plot_leaves_no_figure_with_pyplot():
    from matplotlib import pyplot

    before = pyplot.get_fignums()
    made().plot()
    assert pyplot.get_fignums() == before


# --- frames


def test_frame_is_the_picture_nearest_to_the_instant(result):
    peak = int(np.nanargmax(np.abs(nominal_stress(result.history))))
    rows = {"start": 0.0, "first failure": result.events.time[0], "peak": result.history["time_s"][peak]}
    rows |= {"end": 1.0, float(result.frames["axial_strain"][1]): result.frames["time_s"][1]}
    for at, time in rows.items():
        picture = result.frame(at=at)
        nearest = np.argmin(abs(result.frames["time_s"] - time))
        assert picture.mode == "RGB" and picture.info["frame"] == nearest, at
    files = sorted((result.out / "frames").glob("cracks_*.png"))
    assert len(files) == len(result.frames) > 3
    assert result.frame(at="start").tobytes() != result.frame(at="start", kind="stress").tobytes()


def test_times_of_frames_are_those_of_rows(result):
    frames, history = result.frames, result.history
    assert frames["frame"].tolist() == list(range(len(frames))) and frames["time_s"][0] == 0.0
    assert np.isnan(frames["axial_strain"][0])  # nothing was measured yet
    rows = np.searchsorted(history["time_s"], frames["time_s"][1:])
    assert (history["time_s"][rows] == frames["time_s"][1:]).all()
    assert (history["axial_strain"][rows] == frames["axial_strain"][1:]).all()
    assert (nominal_stress(history)[rows] == frames["nominal_stress_Pa"][1:]).all()


def test_instants_that_a_run_does_not_have_are_refused():
    nothing = made(events=made().events.until(0.0))
    assert "nothing failed" in refusal(lambda: nothing.frame(at="first failure"))
    assert "one of start, first failure, peak, end, or a strain" in refusal(lambda: made().frame(at="middle"))
    for at in (0.1, -1e-3, math.nan, math.inf):
        assert "0 to 0.002; 0.001 is 0.1 %" in refusal(lambda at=at: made().frame(at=at))
    for at in (True, None, [1]):
        assert "or a strain" in refusal(lambda at=at: made().frame(at=at))
    idle = made().history.copy()
    idle["stress_top_Pa"] = idle["stress_bottom_Pa"] = idle["axial_strain"] = np.nan
    assert "no load was recorded" in refusal(lambda: made(history=idle).frame(at="peak"))
    assert "no strain was recorded" in refusal(lambda: made(history=idle).frame(at=1e-4))


def test_pictures_of_a_run_that_was_not_written_are_refused():
    for ask in (made().frame, made().movie):
        assert "was not written" in refusal(ask) and "out=" in refusal(ask)


def test_kinds_that_are_not_there_are_refused(result):
    assert "output.margin" in refusal(lambda: result.frame(kind="margin"))
    assert "one of stress, cracks, margin" in refusal(lambda: result.frame(kind="../../etc/passwd"))
    assert "output.frames" in refusal(lambda: dataclasses.replace(result, frames=None).frame())


def test_a_folder_that_another_run_has_taken_is_not_shown_as_this_one(result):
    other = dataclasses.replace(result, run="0" * 32)
    assert "holds another run by now" in refusal(other.frame) and "holds another run" in refusal(other.movie)


# --- the movie


def test_movie_is_shown_in_the_page(result):
    movie = result.movie()
    assert movie.path == result.out / "cube.mp4" and movie.path.exists() and "cube.mp4" in repr(movie)
    assert movie._repr_html_().startswith("<video controls") and "base64," in movie._repr_html_()


# --- the short table


def test_short_table_holds_the_numbers(result):
    table = result._repr_html_()
    assert f"{result.summary['largest_stress_Pa'] / 1e6:.4g} MPa" in table and f"{len(result.history)} rows" in table
    assert f"{result.summary['failed_tension']} in tension" in table and "in tension</td>" in table
    assert all(name in table for name in ("peak", "first failure", "wall time", "warning"))


def test_every_word_of_the_short_table_is_escaped():
    bad = "<script>alert(1)</script>"
    summary = {
        "warnings": [bad] * 12,
        "first_failure_mode": bad,
        "failed_tension": 1,
        "failed_shear": bad,
        "cracks": bad,
    }
    summary |= {"particles": bad, "largest_stress_Pa": 10**400, "wall_s": bad, "steps": [bad], "fragments": {bad: bad}}
    table = made(summary=summary, stopped=bad, out=Path(bad))._repr_html_()
    assert "<script" not in table and table.count("&lt;script") >= 12 and "and 2 more" in table
    assert "<table>" in made()._repr_html_() and "<table>" in made(summary={"warnings": 3})._repr_html_()


# --- rows


def test_rows_are_an_array_and_their_columns_plain_ones(result):
    history = result.history
    assert isinstance(history, np.ndarray) and type(history[2:4]) is type(history[["time_s", "dt_s"]]) is Rows
    assert type(history["time_s"]) is type(history == history) is type(history != history) is np.ndarray
    assert isinstance(history["time_s"].max(), float) and (history == history.copy()).shape == history.shape
    back = pickle.loads(pickle.dumps(history))
    assert type(back) is Rows and back.tobytes() == history.tobytes()
    assert type(result.reactions) is type(result.frames) is Rows


def test_rows_and_events_become_frames_of_pandas(result):
    pandas = pytest.importorskip("pandas")
    for rows in (result.history, result.reactions, result.frames):
        frame = rows.to_frame()
        assert isinstance(frame, pandas.DataFrame) and tuple(frame.columns) == rows.dtype.names
        np.testing.assert_array_equal(frame["time_s"], rows["time_s"])
    events = result.events.to_frame()
    assert len(events) == len(result.events) and set(events["mode"]) <= {"tension", "shear"}
    frame = result.history.to_frame()
    frame.loc[0, "time_s"] = -1.0
    assert result.history["time_s"][0] >= 0.0  # a copy


def test_without_pandas_a_line_names_the_extra(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "pandas", None)
    for rows in (made().history, made().events):
        assert "pip install rsmpm_ti[pandas]" in refusal(rows.to_frame)


# --- read back


def test_a_run_is_read_back_as_it_was(result):
    back = load_result(result.out)
    assert type(back) is Result and repr(back) == repr(result) and back._repr_html_() == result._repr_html_()
    assert back.summary == result.summary and back.run == result.run
    for name in ("history", "reactions", "frames"):
        there, was = getattr(back, name), getattr(result, name)
        assert there.dtype == was.dtype and type(there) is Rows
        for column in was.dtype.names:
            np.testing.assert_allclose(there[column], was[column], rtol=1e-9, atol=0.0, err_msg=column)
    for name in ("time", "x", "mode", "sigma_1", "sigma_3", "released", "true_time"):
        np.testing.assert_allclose(getattr(back.events, name), getattr(result.events, name), rtol=1e-6)
    assert back.frame(at="peak").tobytes() == result.frame(at="peak").tobytes()
    assert back.movie()._repr_html_() == result.movie()._repr_html_()
    assert back.snapshot is None and back.fracture is None and back.plot()._repr_png_()
