"""Lines of cracks as they are drawn: where the rock is at that instant, of the failures until then."""

import dataclasses

import numpy as np
import pytest
from broken_bands import SPACING, failures, snapshot, strip

from rsmpm_ti import load_scene
from rsmpm_ti.analysis.crack_bands import carried, course_of, find_bands
from rsmpm_ti.analysis.crack_path import centre_path, path_length
from rsmpm_ti.analysis.fracture import crack_lines
from rsmpm_ti.records.events import EventTable


def test_lines_are_drawn_where_the_rock_is_now():
    """A band that failed in place and then moved as a whole, but for every third particle, which flew off."""
    x, shift = strip(30.0, 10e-3, 3.0), np.array([2e-3, -1e-3])
    events, (bands, graph) = failures(x), find_bands(failures(x), SPACING)
    path = centre_path(x, graph, SPACING)
    now = x + shift
    now[::3] += (5e-3, 20e-3)
    (line,) = carried([path], bands, events, snapshot(now, np.ones(len(x))), SPACING)
    np.testing.assert_allclose(line, path + shift, rtol=0.0, atol=1e-15)
    gone = snapshot(now[:0])
    assert carried([path], bands, events, gone, SPACING) == [], "what has left the domain is not drawn"


def test_lines_at_the_largest_load_are_those_of_the_failures_until_then():
    x = strip(0.0, 10e-3, 3.0)
    table = failures(x)
    columns = {name: getattr(table, name) for name in ("time", "x", "mode", "sigma_1", "sigma_3", "released", "id")}
    events, half = EventTable(**columns), table.time[len(x) // 2]
    early = events.until(half)
    assert len(early) == len(x) // 2 + 1 and early.time[-1] == half and early.normal is None
    last = dataclasses.replace(snapshot(x, np.ones(len(x))), time=half)
    scene = load_scene("cube", dx=2.0 * SPACING, flaw_width=2e-3)
    (line,) = crack_lines(scene, events, last)
    # the centres of bands along the same line, half as long
    assert path_length(line) == pytest.approx(5e-3, abs=2.0 * SPACING)


def test_a_block_that_failed_everywhere_has_no_line():
    """Its line would be its own diagonal, which passes for a shear band: atan 2 = 63 degrees in a specimen."""
    columns, rows = np.meshgrid(np.arange(25), np.arange(50))
    x = SPACING * np.stack([columns.ravel(), rows.ravel()], axis=1)
    bands, graph = find_bands(failures(x), SPACING)
    assert len(bands) == 1 and course_of(x[bands[0]], len(x), graph[bands[0]][:, bands[0]], SPACING) is None
    thin = strip(63.0, 20e-3, 4.0)
    bands, graph = find_bands(failures(thin), SPACING)
    course = course_of(thin[bands[0]], len(thin), graph[bands[0]][:, bands[0]], SPACING)
    assert course is not None and course.direction == pytest.approx(63.0, abs=3.0)
