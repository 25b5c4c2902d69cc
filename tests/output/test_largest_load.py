"""The crack pattern at the largest load is kept, of the row in which it was, and a checkpoint keeps it too."""

from types import SimpleNamespace

import numpy as np
import pytest

from rsmpm_ti import LoadCell, Scene, load_scene
from rsmpm_ti.output.observers import LargestLoad
from rsmpm_ti.output.pictures import load_name
from rsmpm_ti.records.snapshot import Pattern


def seen(observer: LargestLoad, stresses, begun=True) -> LargestLoad:
    for k, stress in enumerate(stresses):
        nothing = dict.fromkeys(("x", "displacement", "volume", "failure_mode", "governs", "damage"), np.zeros(1))
        pattern = Pattern(time=float(k), id=np.array([k]), **nothing)
        observer.see(SimpleNamespace(load=SimpleNamespace(stress=stress), begun=begun, pattern=pattern))
    return observer


@pytest.mark.parametrize(
    ("stresses", "row"),
    [((1.0, 3.0, 2.0), 1), ((-1.0, -2.0, -1.0), 1), ((np.nan, 1.0, np.nan), 1), ((1.0, 2.0, 3.0), 2)],
)
def test_it_is_that_of_the_row_of_the_largest_load_of_either_sign(stresses, row):
    assert seen(LargestLoad(), stresses).pattern.time == row


def test_there_is_none_before_the_first_crack_and_without_a_load():
    assert seen(LargestLoad(), (1.0, 2.0), begun=False).pattern is None
    assert seen(LargestLoad(), (np.nan, np.nan)).pattern is None


def test_a_checkpoint_keeps_it():
    first = seen(LargestLoad(), (1.0, 3.0))
    again = LargestLoad()
    again.resume(first.state())
    assert again.pattern == first.pattern
    assert seen(again, (2.0,)).pattern.id == 1, "smaller than before the stop"
    empty = LargestLoad()
    empty.resume(LargestLoad().state())
    assert empty.pattern is None


def test_the_load_axis_says_what_stress_it_is():
    """The stress of a section where the loaded width is the specimen's, else a nominal one; total either way."""

    def cell(width: float) -> Scene:
        return load_scene("intact", settings={"loading.cell": LoadCell(width=width)})

    assert load_name(load_scene("confined")) == load_name(cell(50e-3)) == "total axial stress"
    assert load_name(load_scene("disc")) == load_name(cell(40e-3)) == "total nominal stress"
