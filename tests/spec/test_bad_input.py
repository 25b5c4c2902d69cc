"""Thousands of bad values: each is refused in one clear line, or is what the scene then runs with; never a traceback.

By Python's constructors, by `--set`, and as a recorded scene.json. What is attacked follows from the annotations.
"""

import contextlib
import dataclasses
import io
import itertools
import json
import re

import numpy as np
import pytest
from hostile import (
    LARGE,
    TEXTS,
    TOKENS,
    at,
    attacks,
    check_runnable,
    clear,
    home,
    names_below,
    number_of,
    put,
    quickly,
    reading,
    says,
)
from hypothesis import example, given, settings
from hypothesis import strategies as st

from rsmpm_ti.analysis import summary
from rsmpm_ti.checks import KNOWN
from rsmpm_ti.errors import SceneError, shown
from rsmpm_ti.scene import main
from rsmpm_ti.spec.library.places import available
from rsmpm_ti.spec.loader import keywords_of, load_scene
from rsmpm_ti.spec.loading_start import AtRest
from rsmpm_ti.spec.scene_json import read_scene, to_plain

SMALL = {"dx": 2e-3, "flaw_width": 6e-3}
KEYWORDS = tuple(keywords_of(available()["cube"]))
NAMES = (*KEYWORDS, *names_below(load_scene("cube", **SMALL)))
NOT_NAMES = (
    "nosuch",
    "rock.",
    ".",
    "",
    "bodies.-1",
    "bodies.99999999999.spin",
    "rock.__class__",
    "x" * 10_000,
    "dx=dx",
)


def outcome(attempt, field: str | None) -> str:
    """What is wrong with how an attempt to build and check a scene ended; "" where it ended as it should."""
    try:
        with quickly():
            attempt()
    except SceneError as error:
        if not clear(str(error)):
            return f"unclear: {error}"
        return "" if field is None or says(str(error), field) else f"names another field: {error}"
    except Exception as error:
        return f"{type(error).__name__}: {error}"[:600]
    return ""


@pytest.mark.parametrize("kind", KNOWN.values(), ids=KNOWN)
def test_constructor_refuses_by_field_or_the_scene_runs_with_the_value(kind):
    scene, path = home(kind)
    wrong = [
        f"{kind.__name__}.{field} = {shown(value)}: {found}"
        for field, value in attacks(kind)
        if (found := outcome(lambda f=field, v=value: check_runnable(put(scene, [*path, f], v)), field))
    ]
    assert not wrong, "\n".join(wrong)


def test_platens_that_stand_still_are_no_load_axis_of_length_zero():
    scene, _ = home(AtRest)
    still = tuple(dataclasses.replace(platen, speed=0.0) for platen in scene.loading.boundaries)
    check_runnable(put(scene, ["loading", "boundaries"], still))


def test_platens_that_stand_still_have_no_modulus():
    n = np.ones(20)
    names = ("stress_top_Pa", "stress_bottom_Pa", "energy_kinetic_J", "energy_elastic_J")
    numbers = summary._stress_numbers(1e6 * n, 0.0 * n, np.arange(20.0), n > 0.0, dict.fromkeys(names, 1e6 * n), 0.0)
    assert numbers["apparent_modulus_Pa"] is None and numbers["platen_imbalance"] == 0.0


@pytest.fixture(scope="module")
def command():
    """run(setting, ...) -> (the scene or None, message) of `cube --check`, in this process."""
    patch, accepted = pytest.MonkeyPatch(), []

    def describe(scene, threads=None, file=None, rock=None) -> str:
        check_runnable(scene)
        accepted.append(scene)
        return "runs"

    patch.setattr("rsmpm_ti.scene.describe", describe)
    patch.setattr("rsmpm_ti.run.run.start_taichi", lambda *_: pytest.fail("Taichi was started"))
    small = [part for name, value in SMALL.items() for part in ("--set", f"{name}={value}")]

    def run(*settings: str):
        accepted.clear()
        out, err = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), quickly():
            status = main(["cube", "--check", *small, *(part for text in settings for part in ("--set", text))])
        message = err.getvalue()
        if status == 0:
            assert out.getvalue() == "runs\n"
            assert all(line.startswith("rsmpm_ti: warning: ") and clear(line) for line in message.splitlines()), message
            return accepted[0], ""
        assert status == 2 and out.getvalue() == "" and message.startswith("rsmpm_ti: ") and message.endswith("\n")
        assert clear(message[:-1]), message
        return None, message

    yield run
    patch.undo()


def named(message: str, name: str) -> bool:
    """Whether a refusal names the setting, or the field that a keyword or an index belongs to: flaw_width, width."""
    words = [word for word in re.split(r"[._]", name) if not word.isdigit()]
    return name in message or says(message, words[-1])


def check_setting(command, name: str, text: str) -> None:
    scene, message = command(f"{name}={text}")
    if scene is None:
        assert named(message, name) or name not in NAMES, message
    elif name in KEYWORDS:
        assert scene == load_scene("cube", **(SMALL | {name: number_of(text)}))
    else:
        value = at(scene, [int(step) if step.isdigit() else step for step in name.strip().split(".")])
        assert reading(text.strip(), value), f"{name} = {value!r}"


@pytest.mark.parametrize("fraction", range(8))
def test_setting_is_refused_by_name_or_is_what_the_scene_holds(command, fraction):
    """Every name gets a third of the texts, each text a third of the names."""
    pairs = [(n, t) for k, n in enumerate(NAMES) for j, t in enumerate(TEXTS) if (k + j) % 3 == 0]
    pairs += [(n, t) for n in NOT_NAMES for t in ("1", "")]
    wrong = []
    for name, text in pairs[fraction::8]:
        try:
            check_setting(command, name, text)
        except Exception as error:
            wrong.append(f"{name[:40]}={shown(text)}: {type(error).__name__}: {error}"[:600])
    assert not wrong, "\n".join(wrong)


def random_text(name: str):
    """Texts for a name; cell sizes come from a list, since a fine grid is a fair request that takes long."""
    numbers = st.one_of(st.floats(), st.floats(-100.0, 100.0), st.integers()).map(str)
    if name.split(".")[-1] in LARGE:
        return st.sampled_from(["2e-3", "0.01", "1", "1e300", "1e-9", "5e-324", "0", "-1", "nan", "inf", "1,2", "2"])
    return st.one_of(numbers, st.lists(numbers, max_size=4).map(",".join), st.sampled_from(TEXTS), st.text(max_size=8))


PAIRS = st.sampled_from(NAMES).flatmap(lambda name: st.tuples(st.just(name), random_text(name)))


@settings(max_examples=400, derandomize=True, deadline=None)
@given(st.lists(PAIRS, min_size=1, max_size=3))
@example([("domain.upper", "1e6,1e6")])
@example([("schedule.strain_end", "5e-324")])
@example([("loading.boundaries.0.position", "0.1")])
@example([("rock.criterion.friction_angle", "5e-324")])
@example([("loading.start", "AtRest"), ("schedule.strain_end", "none"), ("schedule.t_end", "1e-3")])
def test_settings_together_are_refused_or_run(command, pairs):
    command(*("=".join(pair) for pair in pairs))


def recorded(scene, path: list, field: str, token: str) -> str:
    """The record of a scene with one field given by raw JSON text."""
    plain = to_plain(scene)
    owner = plain
    for step in path:
        owner = owner[step]
    owner[field] = "<here>"
    return json.dumps(plain).replace('"<here>"', token)


def is_json(text: str) -> bool:
    try:
        json.loads(text)
    except (ValueError, RecursionError):
        return False
    return True


def same(read, written) -> bool:
    """Whether what was read holds all that was written; a field left out has its default, and a file its digest."""
    if isinstance(written, dict):
        return all(same(read[key], value) for key, value in written.items() if (key, value) != ("sha256", None))
    if isinstance(written, list):
        return len(read) == len(written) and all(map(same, read, written))
    return read == written and isinstance(read, bool) == isinstance(written, bool)


def check_file(path, text: str) -> None:
    path.write_bytes(text.encode("utf-8", "surrogatepass"))
    scene = read_scene(path)
    check_runnable(scene)
    assert same(to_plain(scene), json.loads(text)), "the scene is not what the file says"


@pytest.mark.parametrize("kind", KNOWN.values(), ids=KNOWN)
def test_recorded_field_is_refused_by_name_or_is_what_the_scene_holds(tmp_path, kind):
    scene, path = home(kind)
    wrong = []
    classes = tuple(f'{{"type": "{name}"}}' for name in list(KNOWN)[len(kind.__name__) % 5 :: 5])
    for field, token in itertools.product((f.name for f in dataclasses.fields(kind)), TOKENS + classes):
        text = recorded(scene, path, field, token)
        named = field if is_json(token) else None
        if found := outcome(lambda t=text: check_file(tmp_path / "scene.json", t), named):
            wrong.append(f"{kind.__name__}.{field}: {token[:60]}: {found}")
    assert not wrong, "\n".join(wrong)


TEXT = json.dumps({"scene": to_plain(load_scene("cube", **SMALL))}, indent=1)


@settings(max_examples=300, derandomize=True, deadline=None)
@given(
    start=st.integers(0, len(TEXT)),
    length=st.integers(0, 40),
    put_in=st.one_of(st.text(max_size=4), st.sampled_from([*TOKENS, ",", "}", "]", '"', "e", "-", "0" * 500])),
    again=st.booleans(),
)
def test_damaged_record_is_refused_or_is_what_the_file_says(tmp_path_factory, start, length, put_in, again):
    cut = TEXT[start : start + length]
    damaged = TEXT[:start] + put_in + (cut + cut if again else "") + TEXT[start + length :]

    def attempt():
        path = tmp_path_factory.getbasetemp() / "damaged.json"
        path.write_bytes(damaged.encode("utf-8", "surrogatepass"))
        scene = read_scene(path)
        if re.findall(r'"dx": ([^,]*)', damaged) == re.findall(r'"dx": ([^,]*)', TEXT):
            check_runnable(scene)
        assert same(to_plain(scene), json.loads(damaged)["scene"])

    assert not (found := outcome(attempt, None)), found


def test_at_least_two_thousand_bad_inputs_are_tried():
    constructors = sum(1 for kind in KNOWN.values() for _ in attacks(kind))
    set_texts = len(NAMES) * len(TEXTS) // 3
    tokens = (len(TOKENS) + len(KNOWN) // 5) * sum(len(dataclasses.fields(kind)) for kind in KNOWN.values())
    print(f"{constructors} by constructors, {set_texts} + 400 by --set, {tokens} + 300 as JSON")
    assert constructors + set_texts + tokens + 400 + 300 >= 2000
