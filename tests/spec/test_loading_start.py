"""How platens start: the distance that each start promises."""

import numpy as np
import pytest

from rsmpm_ti.spec.loading_start import Affine, Press, Ramp


@pytest.mark.parametrize("start, distance", [(Ramp(time=2.0), 9.0), (Press(time=2.0), 1.0), (Affine(), 10.0)], ids=str)
def test_platens_travel_what_the_start_promises(start, distance):
    """In 10 s at full speed 1: a ramp and a press of 2 s cover half of what full speed would in their time."""
    times = (np.arange(100_000) + 0.5) * 1e-4
    assert sum(map(start.factor, times)) * 1e-4 == pytest.approx(distance, rel=1e-6)
    assert start.factor(1.0) == pytest.approx(0.5 if isinstance(start, Ramp) else 1.0)


@pytest.mark.parametrize("wanted", [1e-9, 0.03, 0.4, 0.999, 1.0, 1.5, 7.0])
def test_ramp_lasts_until_platens_have_come_as_far_as_asked(wanted):
    """The way by adding up small times, within the ramp of 2 s and beyond it."""
    ramp = Ramp(time=2.0)
    end, n = ramp.duration(wanted), 100_000
    way = sum(ramp.factor((k + 0.5) * end / n) for k in range(n)) * end / n
    assert way == pytest.approx(wanted, rel=1e-6)
