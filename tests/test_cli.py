"""The command line: what it lists and checks, and bad input refused in one line before anything compiles."""

import subprocess
import sys

import numpy as np
import pytest

from rsmpm_ti.errors import SceneError
from rsmpm_ti.method.shape import Linear
from rsmpm_ti.records.files import write_json
from rsmpm_ti.scene import build, main, parser
from rsmpm_ti.spec.library.places import available
from rsmpm_ti.spec.loader import keywords_of, load_scene
from rsmpm_ti.spec.mass_scaling import estimate
from rsmpm_ti.spec.scene import Scene
from rsmpm_ti.spec.scene_json import to_plain

SHIPPED = sorted(available())


@pytest.fixture
def command(monkeypatch, capsys, tmp_path):
    """run(*arguments) -> (exit status, stdout, stderr), in an empty folder; a run that starts Taichi fails the test."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("rsmpm_ti.run.run.start_taichi", lambda *_: pytest.fail("Taichi was started"))

    def run(*arguments: str):
        status = main(list(arguments))
        out, err = capsys.readouterr()
        return status, out, err

    return run


def scene_of(*arguments: str) -> Scene:
    return build(parser().parse_args(arguments))


def refused(command, *arguments: str) -> str:
    """The one line on standard error of a refused command."""
    status, out, err = command(*arguments)
    assert (status, out) == (2, "")
    assert err.startswith("rsmpm_ti: ") and err.endswith("\n") and err.count("\n") == 1, err
    return err


def listed(out: str) -> dict[str, tuple[str, list[str]]]:
    """Scene -> what is said of it, and its keywords with defaults."""
    found, lines = {}, out.splitlines()
    for line, after in zip(lines, [*lines[1:], "."], strict=True):
        if line[0] != " ":
            name, _, said = line.partition(" ")
            found[name] = said.strip(), after.split() if after[0] == " " else []
    return found


def test_list_says_in_a_line_what_every_scene_is_and_its_keywords_with_units(command):
    status, out, err = command("--list")
    assert (status, err) == (0, "")
    scenes = listed(out)
    assert list(scenes) == SHIPPED
    for name, (said, keywords) in scenes.items():
        assert 20 < len(said) < 120
        assert [keyword.partition("=")[0] for keyword in keywords] == list(keywords_of(available()[name]))
        pairs = [part for keyword in keywords for part in ("--set", keyword)]
        assert scene_of(name, *pairs) == load_scene(name), "what is shown can be set, and is the default"
    assert {"flaw_angle=45deg", "dx=0.5mm", "strain_end=0.00025"} <= set(scenes["cube"][1])
    assert {"confinement=2MPa"} <= set(scenes["confined"][1]) and {"G_f_I=5J/m2"} <= set(scenes["cube_lab"][1])


@pytest.mark.parametrize("name", SHIPPED)
@pytest.mark.parametrize("quick", [(), ("--quick",)], ids=["full", "quick"])
def test_check_says_what_would_be_run(command, name, quick):
    status, out, err = command(name, *quick, "--check")
    assert (status, err) == (0, "")
    scene = load_scene(name, quick=bool(quick))
    facts = {line[:12].strip(): line[12:] for line in out.splitlines()}
    assert facts["scene"] == scene.title
    assert int(facts["particles"]) == sum(len(body.x) for body in scene.particles())
    assert facts["steps"].split()[0] == str(scene.steps)
    assert float(facts["dt"].split()[0]) == pytest.approx(scene.dt, rel=1e-3)


def test_override_reaches_a_keyword_and_a_dotted_field():
    plain = scene_of("cube", "--quick")
    assert scene_of("cube", "--quick", "--set", "schedule.cfl=0.3").dt == pytest.approx(
        0.3 / plain.schedule.cfl * plain.dt, rel=1e-12
    )
    turned = scene_of("disc_lab", "--set", "flaw_angle=30", "--set", "bodies.0.seeding.seed=7")
    assert turned.bodies[0].region.removed[0].angle == 30.0
    assert turned.bodies[0].seeding.seed == 7
    assert scene_of("cube", "--set", "domain.grid=sparse").domain.grid == "sparse"
    assert scene_of("cube", "--set", "output.movie=false").output.movie is False


OPENED = [
    f"loading.boundaries.{k}.{name}"
    for k, v in ((0, "-2.5e-3"), (1, "2.5e-3"))
    for name in (f"speed={v}", "pulls=true")
]

TOGETHER = {
    "two platens": (OPENED, ["strain_end=-2e-4"], lambda s: s.loading.strain_rate == pytest.approx(-0.05)),
    "end": (["strain_end=none"], ["t_end=1ms"], lambda s: (s.schedule.strain_end, s.t_end) == (None, 1e-3)),
    "end by its place": (["schedule.strain_end=none"], ["schedule.t_end=1ms"], lambda s: s.t_end == 1e-3),
    "strengths": (["rock.criterion.tensile_strength=8MPa"], ["rock.criterion.cohesion=20MPa"],
                  lambda s: s.rock.criterion.tensile_strength == 8e6),
    "order and shape": (["shape=Linear"], ["order=usf"], lambda s: type(s.shape).__name__ == "Linear"),
    "whole and part": (["bodies.0.seeding=Lattice"], ["bodies.0.seeding.particles_per_axis=3"],
                       lambda s: s.bodies[0].seeding.particles_per_axis == 3),
}  # fmt: skip
"""Settings of which the first alone may be refused: pairs that make sense together."""


@pytest.mark.parametrize("name", TOGETHER)
def test_settings_are_merged_before_they_are_checked_in_any_order(name):
    first, second, holds = TOGETHER[name]
    for settings in (first + second, second + first):
        assert holds(scene_of("cube", *[part for setting in settings for part in ("--set", setting)]))


def test_what_settings_make_together_is_still_checked(command):
    message = refused(command, "cube", *[part for s in OPENED for part in ("--set", s)])
    assert "schedule.strain_end = 0.00025" in message and "loading.boundaries.0.speed" in message
    assert "set the other to none" in refused(command, "cube", "--set", "t_end=1ms")


OTHERS = "notched_beam semicircular_bend direct_shear tunnel impact slope blast_hole excavation inclusion".split()
"""Scenes that are no compression of a box or a disc."""


@pytest.mark.parametrize("name", sorted({*SHIPPED} - {*OTHERS}))
@pytest.mark.parametrize("key", ["time_scale", "loading.time_scale"])
def test_every_test_of_a_box_or_disc_takes_a_time_scale_by_tolerance(name, key):
    scene = scene_of(name, "--quick", "--set", f"{key}=auto")
    assert scene.loading.time_scale == "auto" and 1.0 < scene.time_scale < 1000.0


@pytest.mark.parametrize("name", ["disc", "disc_lab"])
def test_ramp_and_time_scale_of_a_disc_are_found_together(name):
    """The ramp is that of the true density times the scale, and inertia then adds what is allowed, 1 %."""
    scene = scene_of(name, "--quick", "--set", "time_scale=auto")
    assert scene.loading.start.time == pytest.approx(0.3e-3 * scene.time_scale, rel=1e-6)
    assert estimate(scene).error(scene.time_scale) == pytest.approx(0.01, rel=1e-6)


def test_settings_in_python_are_numbers_texts_or_objects():
    settings = {"rock.elasticity.E": 55e9, "shape": Linear(), "loading.body_force": [0.0, -9.81], "schedule.rows": 7}
    settings |= {"rock.density": np.float32(2500.0)}
    scene = load_scene("cube", settings=settings)
    assert (scene.rock.elasticity.E, scene.shape, scene.schedule.rows) == (55e9, Linear(), 7)
    assert scene.loading.body_force == (0.0, -9.81) and scene.rock.density == 2500.0
    assert scene == load_scene("cube", settings=settings | {"rock.elasticity.E": "55 GPa"})
    with pytest.raises(SceneError, match="elasticity.E"):
        load_scene("cube", settings={"rock.elasticity.E": float("nan")})


def test_options_change_what_they_say():
    scene = scene_of("cube", "--frames", "3", "--no-movie", "--painter", "ggui", "--elastic")
    assert (scene.output.frames, scene.output.movie, scene.output.painter) == (3, False, "ggui")
    assert not scene.rock.criterion.breaks
    assert not scene.output.margin and scene_of("cube", "--margin").output.margin
    assert scene_of("cube", "--set", "output.margin=true").output.margin is True


def test_recorded_scene_is_a_scene_again(command, tmp_path):
    path = tmp_path / "cube" / "scene.json"
    path.parent.mkdir()
    write_json(path, {"name": "cube", "scene": to_plain(load_scene("cube", quick=True))})
    again, first = command(str(path), "--check", "--frames", "10"), command("cube", "--quick", "--check")
    others = "file", "estimate"  # the second by a loop that takes a little more or less each time
    assert [line for line in again[1].splitlines() if not line.startswith(others)] == [
        line for line in first[1].splitlines() if not line.startswith(others)
    ]
    assert again[0] == first[0] == 0
    assert scene_of(str(path), "--set", "schedule.cfl=0.2").schedule.cfl == 0.2
    assert "no keywords" in refused(command, str(path), "--set", "flaw_angle=30")


@pytest.mark.parametrize(
    "settings, words",
    [
        (["flaw_agnle=30"], ["'flaw_agnle'", "flaw_width", "did you mean flaw_angle?"]),
        (["schedule.cfll=0.3"], ["Schedule has no setting 'cfll'", "strain_end", "did you mean cfl?"]),
        (["rock.elasticity.K=1"], ["Hooke has no setting 'K'", "E, nu"]),
        (["title.x=1"], ["'x' is no field"]),
        (["bodies.1.spin=1"], ["'1' is no index", "1 entries"]),
        (["flaw_angle=steep"], ["flaw_angle=steep", "a number"]),
        (["schedule.rows=1.5"], ["schedule.rows=1.5", "an integer"]),
        (["output.movie=perhaps"], ["true or false"]),
        (["domain.upper=a,b"], ["numbers separated by commas"]),
        (["domain.shape=Linear"], ["Domain has no setting 'shape'"]),
        (["rock.viscosity=Syrup"], ["rock.viscosity=Syrup", "NoViscosity"]),
        (["loading.start=Ramp"], ["needs parameters"]),
        (["flaw_angle"], ["name=value"]),
        (["=3"], ["name=value"]),
        (["rock.elasticity.nu=0.5"], ["elasticity.nu = 0.5", "(-1, 0.5)"]),
        (["rock.criterion.cohesion=-1e6"], ["criterion.cohesion", "positive"]),
        (["rock.criterion.tensile_strength=-2e6"], ["criterion.tensile_strength", "positive"]),
        (["rock.criterion.tensile_strength=8e6"], ["criterion.tensile_strength", "apex"]),
        (["rock.density=nan"], ["rock.density", "positive"]),
        (["flaw_width=0.0005"], ["slit.width = 0.0005", "a width of at least"]),
        (["flaw_width=-0.001"], ["slit.width", "positive"]),
        (["domain.upper=0.055,0.09"], ["outside the domain"]),
        (["dx=0"], ["domain.dx", "positive"]),
        (["schedule.cfl=2"], ["schedule.cfl = 2.0", "use cfl <="]),
        (["schedule.dt=1.91e-5", "time_scale=1"], ["the paper prints this value"]),
        (["time_scale=0"], ["loading.time_scale", "[1, 1000]"]),
        (["strain_end=-1e-4"], ["schedule.strain_end", "strain rate"]),
        (["output.frames=-1"], ["output.frames"]),
    ],
    ids=lambda v: v[0] if isinstance(v, list) else None,
)
def test_bad_setting_is_refused_in_one_line_before_anything_compiles(command, settings, words):
    arguments = [part for setting in settings for part in ("--set", setting)]
    message = refused(command, "cube", *arguments, "--out", "out")
    for word in words:
        assert word in message, message


@pytest.mark.parametrize(
    "setting, words",
    [
        ("loading.body_force=3", "2 components"),
        ("bodies.0.velocity=1", "2 components"),
        ("bodies.0.velocity=true,1", "numbers separated by commas"),
        ("loading.boundaries=1,2", "a list of Platen, Wall, Fixed or Absorbing"),
        ("loading.boundaries.0.axis=true", "an integer"),
        ("loading.boundaries.0.span=0.01", "2 numbers"),
        ("bodies.0.seeding=Linear", "Lattice or Jittered"),
        ("bodies.0.region=3", "Box, Disc"),
        ("rock.elasticity=Void", "must be Hooke"),
        ("rock.criterion=Void", "MohrCoulomb, HoekBrown, Fairhurst or Unbreakable"),
        ("rock.criterion=none", "MohrCoulomb, HoekBrown, Fairhurst or Unbreakable"),
        ("rock=Void", "must be Rock"),
        ("transfer=Gimp", "PicFlip or Apic"),
    ],
)
def test_setting_of_a_wrong_kind_is_refused_in_one_line(command, setting, words):
    assert words in refused(command, "cube", "--quick", "--set", setting, "--out", "out")


@pytest.mark.parametrize(
    "setting, field",
    [("order=usf", "order"), ("shape=Gimp", "shape"), ("transfer=Apic", "transfer"), ("title=Slab", "title")],
)
def test_top_level_fields_can_be_set(command, tmp_path, setting, field):
    value = getattr(scene_of("intact", "--set", setting), field)
    assert setting.partition("=")[2] in (value, type(value).__name__)
    write_json(tmp_path / "scene.json", to_plain(load_scene("intact", quick=True)))
    assert getattr(scene_of("scene.json", "--set", setting), field) == value


def test_values_are_read_as_their_fields_say():
    scene = scene_of("cube", "--set", "bodies.0.seeding=Lattice", "--set", "loading.body_force=0,-9.81")
    assert type(scene.bodies[0].seeding).__name__ == "Lattice" and scene.loading.body_force == (0.0, -9.81)
    assert scene_of("cube", "--set", "output.stress_limit=3").output.stress_limit == 3.0
    assert scene_of("disc", "--set", "loading.boundaries.0.span=none").loading.boundaries[0].span is None


def test_unknown_name_is_answered_with_keywords_and_fields(command):
    message = refused(command, "cube", "--set", "ordr=usf")
    assert all(keyword in message for keyword in keywords_of(available()["cube"]))
    assert "order" in message and "schedule.cfl=0.3" in message and "did you mean order?" in message


def test_missing_scenes_are_refused_with_what_there_is(command):
    for arguments in (("nosuch",), ()):
        message = refused(command, *arguments)
        assert all(name in message for name in SHIPPED)
    assert "does not exist" in refused(command, "nosuch.py")
    assert "does not exist" in refused(command, "nosuch/scene.json")


FILES = {
    "syntax": ("def scene(:\n    pass\n", "line 1"),
    "raises": ("x = 1\ny = x / 0\ndef scene(): pass\n", "line 2 cannot be loaded: ZeroDivisionError"),
    "imports": ("import no_such_module\n", "ModuleNotFoundError"),
    "without": ("x = 1\n", "defines no function scene()"),
    "value": ("scene = 3\n", "defines no function scene()"),
    "returns": ("def scene(): return 3\n", "must return a Scene, not int"),
    "none": ("def scene(): pass\n", "must return a Scene, not NoneType"),
    "fails": ("def scene(*, n=1.0): return [][0]\n", "failed: IndexError"),
    "needs": ("def scene(angle): return angle\n", "failed: TypeError"),
    "exits": ("import sys\nsys.exit(0)\n", "line 2 cannot be loaded: SystemExit: 0"),
    "exits_later": ("import sys\ndef scene(): sys.exit(0)\n", "failed: SystemExit: 0"),
    "endless": ("def scene(): return scene()\n", "failed: RecursionError"),
    "endless_at_once": ("def f(): return f()\nf()\n", "line 1 cannot be loaded: RecursionError"),
    "null": ("\0", "cannot be loaded: "),
    "wordy": ("raise ValueError('x' * 1_000_000)\n", "ValueError: xxx"),
    "speechless": ("class E(Exception):\n    def __str__(self): return 1 / 0\nraise E\n", "cannot be loaded: E"),
    "quick": ("QUICK = {1: 2}\ndef scene(): pass\n", "QUICK must be a dict of keywords"),
    "positional": ("def scene(a, /): pass\n", "failed: TypeError"),
    "long": ("def scene(): raise ValueError('one\\ntwo')\n", "failed: ValueError"),
}


@pytest.mark.parametrize("name", FILES)
def test_malformed_scene_file_is_refused_in_one_line(command, tmp_path, name):
    text, words = FILES[name]
    (tmp_path / f"{name}.py").write_text(text)
    message = refused(command, f"{name}.py")
    assert f"{name}.py" in message and words in message and len(message) < 1000, message


@pytest.mark.parametrize("text", ["{", "[]", '{"scene": {"type": "Rocket"}}', '{"scene": {"type": "Linear"}}', "\x00"])
def test_malformed_recorded_scene_is_refused_in_one_line(command, tmp_path, text):
    (tmp_path / "scene.json").write_text(text)
    refused(command, "scene.json")


def test_bad_file_does_not_hide_the_other_scenes(command, tmp_path):
    (tmp_path / "scenes").mkdir()
    bad = {
        "notes": "x = 1\n",
        "stops": "import sys\nsys.exit(5)\n",
        "syntax": "def scene(:\n",
        "callable": "scene = dict\n",
        "odd": "class D:\n    def __repr__(self): return 1 / 0\ndef scene(*, d=D()): pass\n",
    }
    for name, text in bad.items():
        (tmp_path / "scenes" / f"{name}.py").write_text(text)
    status, out, err = command("--list")
    scenes = listed(out)
    assert (status, err) == (0, "") and sorted(scenes) == sorted([*SHIPPED, *bad])
    assert "flaw_angle=45deg" in scenes["cube"][1]
    assert "scenes/notes.py defines no function scene()" in scenes["notes"][0]
    assert "SyntaxError" in scenes["syntax"][0] and scenes["odd"][1] == ["d=D()"]


def test_unwritable_output_is_refused_before_anything_compiles(command, tmp_path):
    (tmp_path / "file").write_text("")
    assert "cannot be written" in refused(command, "cube", "--quick", "--out", "file/out")


def test_refused_command_ends_with_status_2_and_without_a_traceback(tmp_path):
    code = [sys.executable, "-m", "rsmpm_ti.scene", "cube", "--set", "rock.elasticity.nu=0.5"]
    root = str(__import__("pathlib").Path(__file__).resolve().parent.parent)
    done = subprocess.run(code, cwd=root, capture_output=True, text=True, timeout=120)
    assert done.returncode == 2 and done.stdout == ""
    assert done.stderr.count("\n") == 1 and "elasticity.nu" in done.stderr
