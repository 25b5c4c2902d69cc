"""README and docs/: their code runs, what they name is there, and README stays short."""

import importlib
import re
import shlex
import shutil
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from pages import COARSE, ROOT, blocks, run_block
from PIL import Image

from rsmpm_ti import __version__, load_scene
from rsmpm_ti.__main__ import COMMANDS
from rsmpm_ti.scene import build, parser
from rsmpm_ti.spec.library.places import available
from rsmpm_ti.spec.library.rocks import rocks

PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]

README_BYTES, MOVING_BYTES = 9000, 2_000_000


def name_of(page: Path) -> str:
    return page.relative_to(ROOT).as_posix()


def each_page(test):
    return pytest.mark.parametrize("page", PAGES, ids=name_of)(test)


def code_of(page: Path) -> list[str]:
    """Everything that a page sets as code: lines of blocks, comments cut off, and what stands between backticks."""
    text = page.read_text(encoding="utf-8")
    lines = [line for block in re.findall(r"```\w*\n(.*?)```", text, re.DOTALL) for line in block.splitlines()]
    rest = re.sub(r"```.*?```", "", text, flags=re.DOTALL)
    return [line.split(" #")[0].strip() for line in lines] + re.findall(r"`([^`]+)`", rest)


def commands() -> list[tuple[str, str, str]]:
    """(page, module, arguments) of every `python -m rsmpm_ti...` that is written anywhere."""
    found = re.compile(r"python -m (rsmpm_ti[\w.]*)([^|]*)$")
    return [
        (name_of(page), *match.groups())
        for page in PAGES
        for line in code_of(page)
        if (match := found.search(" ".join(line.split())))
    ]


# --- sizes, pictures


def test_readme_is_short():
    assert (ROOT / "README.md").stat().st_size <= README_BYTES


def test_readme_shows_two_pictures_and_one_that_moves():
    pictures = re.findall(r"!\[[^]]*\]\(([^)]+)\)", (ROOT / "README.md").read_text(encoding="utf-8"))
    assert len(pictures) == 3
    moving = [path for path in pictures if Path(path).suffix in (".gif", ".webp")]
    assert len(moving) == 1 and (ROOT / moving[0]).stat().st_size < MOVING_BYTES
    with Image.open(ROOT / moving[0]) as picture:
        assert picture.n_frames > 10
        first = np.asarray(picture.convert("RGB"))
        picture.seek(picture.n_frames - 1)
        assert (np.asarray(picture.convert("RGB")) != first).any(axis=2).mean() > 0.02  # the cracks and the curve


def test_every_picture_of_the_gallery_is_shown():
    shown = "".join(page.read_text(encoding="utf-8") for page in PAGES)
    assert [path.name for path in (ROOT / "renders/gallery").iterdir() if path.name not in shown] == []


# --- links, files, names


@each_page
def test_links_lead_somewhere(page):
    text = page.read_text(encoding="utf-8")
    broken = []
    for link in re.findall(r"\]\(([^)\s]+)\)", text):
        path, _, anchor = link.partition("#")
        target = page if not path else (page.parent / path).resolve()
        if "://" in link:
            continue
        if not target.exists() or (anchor and anchor not in anchors(target)):
            broken.append(link)
    assert not broken


def anchors(page: Path) -> set[str]:
    headings = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


@each_page
def test_files_that_are_named_are_there(page):
    named = re.findall(r"(?:rsmpm_ti|tests|docs|scenes|\.ci)/[\w/]*\w+(?:\.\w+)?", page.read_text(encoding="utf-8"))
    assert sorted({path for path in named if not (ROOT / path).exists()}) == []


def test_every_page_is_reached_from_readme():
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert [name for page in PAGES[1:] if f"({(name := name_of(page))})" not in readme] == []


def test_sections_of_references_that_are_cited_are_there():
    headings = re.findall(r"^## (\d+)\. ", (ROOT / "docs/references.md").read_text(encoding="utf-8"), re.MULTILINE)
    assert headings == [str(k + 1) for k in range(len(headings))]
    files = [*PAGES, *(path for folder in ("rsmpm_ti", "tests", "scenes") for path in (ROOT / folder).rglob("*.py"))]
    cited = re.compile(r"references\.md(?:\]\([^)]*\))?, sections? (\d+)(?: and (\d+))?")
    texts = (" ".join(path.read_text(encoding="utf-8").split()) for path in files)
    missing = {number for text in texts for pair in cited.findall(text) for number in pair if number} - set(headings)
    assert not missing


@each_page
def test_make_targets_are_there(page):
    targets = set(re.findall(r"^([a-z][a-z ]*):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE))
    known = {word for words in targets for word in words.split()}
    used = {match[1] for line in code_of(page) if (match := re.match(r"make ([a-z]+)", line))}
    assert used <= known


def test_citation_is_of_this_version():
    assert f"version: {__version__}\n" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")


# --- commands


def test_commands_are_found():
    assert len(commands()) > 50


@pytest.mark.parametrize("module", sorted({module for _, module, _ in commands()}))
def test_modules_of_commands_are_there(module):
    spec = find_spec(module)
    assert spec is not None
    assert spec.submodule_search_locations is None or find_spec(f"{module}.__main__") is not None


def known_names(module: str) -> set[str]:
    """What may follow a command as a word: cases, studies, measurements, standard tests and their rocks."""
    if module == "rsmpm_ti.bench":
        return {"speed", "passes", "scaling", "fill", "memory", "start", "runs", "error", *available()}
    if find_spec(f"{module}.catalogue") is None:
        return set()
    catalogue = importlib.import_module(f"{module}.catalogue")
    if module == "rsmpm_ti.lab":
        return {*catalogue.TESTS, *rocks()}
    return set(getattr(catalogue, "CASES", None) or catalogue.STUDIES)


def help_of(module: str, words: list[str], capsys) -> str:
    with pytest.raises(SystemExit):
        importlib.import_module(COMMANDS[module.split(".")[1]][0]).main([*words, "--help"])
    return capsys.readouterr().out


WITH_CASES = {f"rsmpm_ti.{name}" for name in COMMANDS if name != "scene"}


@pytest.mark.parametrize("page, module, arguments", [c for c in commands() if c[1] in WITH_CASES])
def test_options_and_names_of_commands_are_known(page, module, arguments, capsys):
    words = arguments.split()
    names = {word for word in words if re.fullmatch(r"[a-z]\w*", word)}
    assert names <= known_names(module)
    options = re.findall(r"--[a-z-]+", arguments)
    text = help_of(module, words[:1] if module == "rsmpm_ti.bench" and names else [], capsys)
    assert [option for option in options if option not in text] == []


@pytest.mark.parametrize("page, module, arguments", [c for c in commands() if c[1] == "rsmpm_ti.scene"])
def test_scenes_are_built_as_commands_say(page, module, arguments):
    """Every option is parsed, every --set is applied; a scene file of the reader's own is not looked for."""
    options = parser().parse_args(shlex.split(arguments))
    if options.scene is not None and not options.scene.endswith((".py", ".json")):
        build(options)


def test_options_named_apart_belong_to_some_command(capsys):
    """`--kept` and the like, where no command is named beside it."""
    known = "".join(help_of(f"rsmpm_ti.{name}", [], capsys) for name in COMMANDS)
    known += "".join(
        help_of("rsmpm_ti.bench", [part], capsys) for part in known_names("rsmpm_ti.bench") - {*available()}
    )
    lines = [
        line for page in PAGES for line in code_of(page) if not re.search(r"ruff|pytest|make|chromium|-march", line)
    ]
    options = {option for line in lines for option in re.findall(r"(?<![\w-])--[a-z][a-z-]+", line)}
    assert sorted(option for option in options if not re.search(rf"{option}\b", known)) == []


@each_page
def test_settings_named_apart_are_fields_of_a_scene(page):
    """`--set schedule.cfl=0.3` and the like, where no scene is named."""
    for line in code_of(page):
        if line.startswith("--set "):
            build(parser().parse_args(["cube", *shlex.split(line)]))


# --- Python snippets


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # what snippets write goes here
    return tmp_path


def test_readme_tests_your_own_rock(folder, capsys):
    (code,) = blocks("README.md")
    assert len(code.strip().splitlines()) <= 15
    left = run_block(folder, code)
    # the granite is four times as strong in tension as the paper's rock, which cracks at 0.98 MPa with finer cells
    assert left["result"].summary["first_failure_mode"] == "tension"
    assert capsys.readouterr().out.strip().endswith("MPa, in tension")
    assert (folder / "renders/granite/summary.png").exists()


def test_page_of_laws_builds_its_rock(folder):
    (code,) = blocks("docs/laws.md")
    assert run_block(folder, code)["rock"].criterion.ucs == pytest.approx(25.52e6, rel=1e-3)


def test_page_of_scenes_runs_and_writes_one(folder):
    run, scene_file, *holes, several = blocks("docs/scenes.md")
    left = run_block(folder, run.replace('out="renders/cube30", ', "").replace(", overwrite=True", ""))
    assert left["result"].fracture.cracks
    (folder / "mine.py").write_text(scene_file, encoding="utf-8")
    shipped = load_scene("intact")
    assert load_scene("mine.py") == shipped
    left = run_block(folder, "\n".join(holes))
    assert all(len(left[name].particles()[0].x) for name in ("pressed", "staged"))
    assert len(run_block(folder, several)["scene"].rocks) == 2


def test_page_of_python_shows_a_result(folder):
    (code,) = blocks("docs/python.md")
    assert "settings={" in code
    left = run_block(folder, code.replace("quick=True, settings={", f"settings={{**{COARSE}, "))
    assert (folder / "curve.png").exists() and (folder / "peak.png").exists()
    assert left["again"].frame().info == pytest.approx(left["picture"].info, nan_ok=True)


def test_page_of_drawings_makes_one_file_of_its_regions(folder):
    for path in (ROOT / "tests/spec/drawings").iterdir():
        shutil.copy(path, folder)
    (folder / "traces.csv").write_text("x1,y1,x2,y2\n10,20,20,26\n22,50,34,58\n")
    left = run_block(folder, "\n".join(blocks("docs/drawings.md")))
    assert left["block"].area == pytest.approx(5e-3 - 0.2e-3 - 0.05e-3)
    assert left["mapped"].traces == tuple(map(pytest.approx, left["traces"].traces))
    assert {len(left[name].bounds()[0]) for name in ("inclined", "quartz", "vein", "granite", "notched")} == {2}
    assert len(left["core"].bounds()[0]) == 3 and left["result"].stopped == ""


def test_page_of_references_computes_its_numbers(folder):
    (code,) = blocks("docs/references.md")
    left = run_block(folder, code)
    assert left["late"] == pytest.approx(0.410, abs=5e-4)
    assert left["delays"] == pytest.approx([1.37, 1.73, 1.73, 2.18], abs=5e-3)
    assert left["overshoot"] == pytest.approx(0.274, abs=5e-4)
