"""What an observer remembers comes back from a checkpoint as it was, or is refused by its name as the run starts."""

import io
import json
import math
from types import SimpleNamespace

import numpy as np
import pytest

from rsmpm_ti import Observer, ObserverError, load_scene, simulate
from rsmpm_ti.run.checkpoint import observer_arrays, restore_observers
from rsmpm_ti.run.kept.reading import MOST_ARRAYS, StoredArrays
from rsmpm_ti.solver.observer import Watch

QUICK = {"shape": "Linear", "schedule.rows": "40", "output.frames": "0", "output.vtu": "0"}


def watched(state: dict, back: dict | None = None) -> list[Watch]:
    resume = ({} if back is None else back).update
    return [Watch(SimpleNamespace(every=0.5, see=id, state=lambda: state, resume=resume))]


def through_a_file(state: dict) -> dict:
    """A state as a run that goes on gets it."""
    parts, arrays = observer_arrays(watched(state))
    file = io.BytesIO()
    np.savez(file, text=np.array(json.dumps(parts)), **arrays)
    stored, back = StoredArrays(file), {}
    found = {name: stored.read(name) for name in stored.headers}
    restore_observers(watched({}, back), json.loads(str(found["text"])), found)
    return back


def same(a, b) -> bool:
    if isinstance(a, np.ndarray):
        return type(b) is np.ndarray and a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()
    if isinstance(a, dict):
        return set(a) == set(b) and all(same(a[key], b[key]) for key in a)
    if isinstance(a, list):
        return len(a) == len(b) and all(map(same, a, b))
    return type(a) is type(b) and (a == b or (a != a and b != b))


NAMES = ["plain", "", "a\0b", "end\0", "n" * 10_000, "\ud800", "\udfff up", "../../x", "a/b", "file", "text", "ä\n"]


@pytest.mark.parametrize("name", NAMES, ids=lambda name: ascii(name[:10]))
@pytest.mark.parametrize("value", [np.arange(3.0), [1, {"in": "\ud800 \0"}]], ids=["array", "list"])
def test_names_of_any_kind_are_kept(name, value):
    state = {name: value, "beside": np.ones((2, 2), dtype=np.int8)}
    assert same(state, through_a_file(state))


def test_values_of_any_kind_that_is_promised_are_kept():
    plain = [None, True, 1, -(2**70), 0.1, -0.0, math.inf, math.nan, "a\0", "\ud83d", "", [], {}, {"1": [{"": None}]}]
    kinds = ("bool", "i1", "u8", ">f8", "f2", "c16", "U3", "S2", "M8[s]", "m8[ns]")
    arrays = {kind: np.zeros((2, 3), dtype=kind) for kind in kinds} | {"none": np.zeros((0, 2)), "one": np.array(1.0)}
    state = {"plain": plain, **arrays, "by columns": np.asfortranarray(np.arange(6.0).reshape(2, 3))}
    assert same(state, through_a_file(state))


MASKED = np.ma.masked_array([1.0, 2.0], mask=[False, True])
DEEP: list = []
for _ in range(2000):
    DEEP = [DEEP]
ENDLESS: dict = {}
ENDLESS["again"] = [ENDLESS]

REFUSED = {
    "two keys of one name in JSON": ({"a": {1: "one", "1": "text"}}, r"\['a'\] has the key 1"),
    "a key that is true": ({"a": [{}, {True: "yes", "true": "text"}]}, r"\['a'\]\[1\] has the key True"),
    "a number as name": ({1: 0.5}, r"state\(\) has the key 1"),
    "none as name of an array": ({None: np.zeros(2)}, r"state\(\) has the key None"),
    "masked array": ({"sum": MASKED}, r"\['sum'\] is a MaskedArray.* mask"),
    "other heirs of arrays": ({"sum": np.zeros(2).view(np.recarray)}, r"\['sum'\] is a recarray"),
    "fields in an array": ({"sum": np.zeros(2, dtype=[("a", "f8")])}, r"\['sum'\] is an array of"),
    "array within a list": ({"a": [np.zeros(2)]}, r"\['a'\]\[0\] is a ndarray"),
    "time of NumPy": ({"a": np.datetime64(1, "ns")}, r"\['a'\] is a datetime64"),
    "surrogates that JSON joins": ({"a": "\ud83d\ude00"}, r"\['a'\] holds surrogates"),
    "a name that JSON joins": ({"\ud83d\ude00": 1}, "holds surrogates"),
    "deep": ({"a": DEEP}, r"deep"),
    "endless": (ENDLESS, "deep"),
    "an integer beyond printing": ({"a": 10**5000}, r"\['a'\] is an integer"),
    "more arrays than are read": ({str(k): np.zeros(1) for k in range(MOST_ARRAYS)}, "arrays"),
}


@pytest.mark.parametrize("state, words", REFUSED.values(), ids=REFUSED)
def test_what_would_come_back_otherwise_is_refused_by_its_name(state, words):
    with pytest.raises(ObserverError, match=words) as refused:
        observer_arrays(watched(state))
    said = str(refused.value)
    assert said.startswith("observer SimpleNamespace: state()") and len(said) < 600 and "\n" not in said


class Remembers(Observer):
    every = 0.5

    def __init__(self):
        self.seen = None

    def see(self, view) -> None:
        self.seen = {"a": {1: view.step}}

    def state(self) -> dict:
        return dict(self.seen)  # as users write them: nothing before the first look


@pytest.mark.thorough
def test_a_state_that_cannot_be_kept_ends_the_run_as_it_starts_and_not_at_its_end(tmp_path):
    scene = load_scene("intact", dx=1e-2, strain_end=2e-4, settings=QUICK).elastic()
    with pytest.raises(ObserverError, match=r"observer Remembers: state\(\)\['a'\] has the key 1.*at step 0") as failed:
        simulate(scene, out=tmp_path, threads=1, observers=(Remembers(),))
    assert len(failed.value.result.history) == 0
    assert {"history.csv", "summary.json"} <= {path.name for path in tmp_path.iterdir()}
    simulate(scene, threads=1, observers=(Remembers(),))  # without a folder there is no checkpoint to fail
