"""A deterministic run has the same bits whatever the number of threads."""

import numpy as np
import pytest

from rsmpm_ti import load_scene, simulate

SMALL = {
    "cube": {
        "dx": 2e-3,
        "flaw_width": 6e-3,
        "time_scale": 16.0,
        "settings": {"shape": "Linear", "schedule.rows": "30"},
    },
    # mean stress over a length: cracks of one step exclude particles in turn
    "cube_lab": {"quick": True, "settings": {"schedule.rows": "30"}},
}


def bits(result) -> dict[str, bytes]:
    snapshot, events = result.snapshot, result.events
    arrays = {"history": result.history}
    arrays |= {name: getattr(snapshot, name) for name in ("x", "velocity", "sigma", "failure_mode", "failure_time")}
    arrays |= {f"event {name}": getattr(events, name) for name in ("time", "id", "released")}
    return {name: np.ascontiguousarray(array).tobytes() for name, array in arrays.items()}


@pytest.mark.parametrize("name", ["cube", pytest.param("cube_lab", marks=pytest.mark.validation)])
@pytest.mark.thorough("cube")
def test_threads_do_not_show(name):
    scene = load_scene(name, **SMALL[name])
    found = [simulate(scene, threads=threads, deterministic=True) for threads in (1, 3)]
    assert len(found[0].events) > 20
    one, three = map(bits, found)
    assert [key for key in one if one[key] != three[key]] == []
