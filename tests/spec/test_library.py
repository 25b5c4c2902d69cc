"""Names of runs, and scene files that are found by name: which is taken, and what is told of one that is not run."""

from pathlib import Path

import pytest

from rsmpm_ti.errors import RockWarning, SceneError
from rsmpm_ti.run.settings import Settings
from rsmpm_ti.scene import main
from rsmpm_ti.spec.library import places
from rsmpm_ti.spec.library.names import MAX_BYTES, MAX_LETTERS, is_name, run_name
from rsmpm_ti.spec.loader import load_scene

NAMES = {
    "cube": "cube", "../scene.json": "here", "scene.json": "inside", "./scene.json": "inside", "/scene.json": "scene",
    "a/b/scene.json": "b", "../../x/scene.json": "x", ".hidden/scene.json": "hidden", "my scene (2).py": "my_scene__2_",
    "v1.2": "v1.2", "/a/b/x.y.py": "x.y", "..py": "scene", "x\ny.py": "x_y", "岩石.py": "岩石", "other.json": "other",
    "~.py": "_", "-x.py": "-x", "x" * 300 + ".py": "x" * MAX_LETTERS, "岩" * 300 + ".py": "岩" * (MAX_BYTES // 3),
}  # fmt: skip


@pytest.mark.parametrize("scene", NAMES)
def test_a_run_is_filed_under_a_name_that_is_one_part_of_a_path(tmp_path, monkeypatch, scene):
    (tmp_path / "here" / "inside").mkdir(parents=True)
    monkeypatch.chdir(tmp_path / "here" / "inside")
    name = run_name(scene)
    assert name == NAMES[scene] and is_name(name)
    assert Path("renders", name).resolve().parent == Path("renders").resolve()
    (tmp_path / f".{name}.part.mp4").touch()


@pytest.mark.parametrize(
    "name", ["", ".", "..", "../x", "a/b", "/x", ".x", "a\\b", "a\0", "a b", "x" * 101, "岩" * 67, 3, None, Path("x")]
)
def test_what_is_no_name_is_refused(name):
    with pytest.raises(SceneError, match="^name = .* is refused: it must be a file name of 1 to 100 letters"):
        Settings(name=name).check(load_scene("intact", quick=True))


SPY = "open('executed', 'w')\n"
OWN = f'"""Mine.\n\nMore."""\n{SPY}\ndef scene(a, b=2.0 * 3, /, *, dx: float = 1.0 * mm, n): ...\n'


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with scenes of its own, one of them under the name of a scene that ships; the current one."""
    (tmp_path / "scenes").mkdir()
    ships = (places.shipped() / "cube.py").read_text()
    for name, text in {"cube": SPY + ships, "mine": OWN}.items():
        (tmp_path / "scenes" / f"{name}.py").write_text(text)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_list_executes_no_file_of_the_current_folder(folder, capsys):
    assert main(["--list"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[lines.index(f"{'mine':<15} Mine") + 1].split() == ["a=?", "b=2.0*3", "dx=1.0*mm", "n=?"]
    assert not (folder / "executed").exists()


def test_a_scene_in_place_of_one_that_ships_is_told(folder, capsys):
    assert main(["cube", "--quick", "--check"]) == 0
    out, err = capsys.readouterr()
    assert "file        scenes/cube.py\n" in out and (folder / "executed").exists()
    assert err.count("\n") == 1 and "warning: scene cube is scenes/cube.py of the current folder, not the one" in err
    with pytest.warns(RockWarning, match="of the current folder"):
        load_scene("cube")


def test_a_scene_that_ships_is_taken_without_a_word(tmp_path, monkeypatch, capsys):
    for place in (tmp_path, places.shipped().parent):
        monkeypatch.chdir(place)
        assert main(["cube", "--quick", "--check"]) == 0
        out, err = capsys.readouterr()
        assert err == "" and out.startswith("file  ") and "cube.py\n" in out


def test_the_folder_beside_an_installed_package_is_none_of_ours(tmp_path, monkeypatch):
    for folder in (tmp_path / "rsmpm_ti" / "scenes", tmp_path / "scenes"):
        folder.mkdir(parents=True)
        (folder / f"{folder.parent.name[:3]}.py").touch()
    monkeypatch.chdir(tmp_path / "rsmpm_ti" / "scenes")
    monkeypatch.setattr(places, "PACKAGE", tmp_path / "rsmpm_ti")
    assert list(places.available()) == ["rsm"]


@pytest.mark.parametrize(
    "path", ["x" * 5000 + ".py", "/".join(["x"] * 5000) + ".json", "a\0b.py", "scenes.py/", "/proc/1/x.py"]
)
def test_a_path_that_no_file_can_have_is_refused(tmp_path, monkeypatch, capsys, path):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scenes.py").mkdir()
    assert main([path, "--check"]) == 2
    err = capsys.readouterr().err
    assert err.count("\n") == 1 and len(err) < 1000 and "does not exist, or cannot be read" in err
