"""What processes that the product starts see, and what commands do where their output ends."""

import json
import multiprocessing
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from snapshots import snapshot_of
from writer_orders import NO_ROWS, started

from rsmpm_ti.process import no_current_folder

ROOT = Path(__file__).resolve().parent.parent
PLANTED = "json pickle queue threading numpy taichi rsmpm_ti matplotlib multiprocessing struct".split()


@pytest.fixture
def planted(tmp_path, monkeypatch):
    """The current folder, with files that bear the names of modules and leave a mark where they are executed."""
    folder = tmp_path / "planted"
    folder.mkdir()
    for name in PLANTED:
        (folder / f"{name}.py").write_text(f"open({str(tmp_path / 'executed')!r}, 'a').write({name!r})\nraise OSError")
    monkeypatch.chdir(folder)
    return tmp_path


def test_the_process_that_paints_runs_nothing_of_the_current_folder(planted, monkeypatch):
    monkeypatch.setenv("MPLBACKEND", "nonsense")  # nor follows what is meant for windows
    (planted / "out").mkdir()
    writer = started(planted / "out")
    shutil.rmtree(planted / "planted")  # and does not mind that it is gone
    writer.checkpoint({"a": np.zeros(3)})
    writer.close(snapshot_of(np.array([[0.025, 0.05]])), NO_ROWS, [], np.zeros(0))
    assert not (planted / "executed").exists() and (planted / "out" / "summary.png").exists()


@pytest.mark.skipif(
    sys.version_info < (3, 11), reason="Python 3.10 puts the current folder first whoever asks it not to"
)
def test_cases_that_run_in_processes_of_their_own_run_nothing_of_the_current_folder(planted):
    before = dict(os.environ)
    with no_current_folder(), multiprocessing.get_context("spawn").Pool(1) as pool:
        assert pool.apply(os.getpid) != os.getpid()
    assert not (planted / "executed").exists() and dict(os.environ) == before


SEEN = """
import json, sys
seen = lambda: [list(filter(None, sys.path)), list(sys.warnoptions), sys.flags.optimize, sys.flags.utf8_mode,
                sys.flags.dev_mode, sys.pycache_prefix, sys.modules["rsmpm_ti"].__file__]
"""
PARENT = f"""
import sys
sys.path.insert(1, {str(ROOT)!r})
import subprocess
from rsmpm_ti.process import python_command
{SEEN}
child = subprocess.run(python_command({SEEN!r} + "print(json.dumps(seen()))"), capture_output=True, text=True)
print(json.dumps([seen(), json.loads(child.stdout)]))
"""


@pytest.mark.parametrize("flags", [(), ("-O", "-W", "error::UserWarning", "-X", "dev", "-X", "utf8"), ("-I",)])
def test_a_python_that_is_started_sees_what_its_parent_sees(tmp_path, flags):
    environment = os.environ | {"PYTHONPATH": str(tmp_path), "PYTHONPYCACHEPREFIX": str(tmp_path / "compiled")}
    command = [sys.executable, *flags, "-c", PARENT]
    done = subprocess.run(command, env=environment, cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    parent, child = json.loads(done.stdout)
    assert child == parent and child[-1].startswith(str(ROOT))


def test_nobody_starts_a_python_in_another_way():
    for path in sorted((ROOT / "rsmpm_ti").rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        assert "[sys.executable" not in text or path.name == "process.py", path
        assert 'get_context("spawn")' not in text or "no_current_folder()" in text or "get_context('spawn')" in text, (
            path
        )


def shell(line: str, cwd: Path = ROOT, **variables: str) -> subprocess.CompletedProcess:
    environment = os.environ | {"PYTHONPATH": str(ROOT)} | variables
    line = line.replace("PYTHON", sys.executable)
    return subprocess.run(["bash", "-c", line], env=environment, cwd=cwd, capture_output=True, text=True, timeout=60)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
@pytest.mark.parametrize("arguments", ["", "scene --help", "verify --list"])
def test_output_that_is_full_ends_a_command_by_a_line(arguments):
    done = shell(f"PYTHON -m rsmpm_ti {arguments} > /dev/full")
    assert done.returncode == 2
    assert done.stderr == "rsmpm_ti: standard output cannot be written: No space left on device; send it elsewhere\n"
    done = shell(f"PYTHON -m rsmpm_ti {arguments} > /dev/full 2> /dev/full")
    assert done.returncode == 2


@pytest.mark.parametrize("end", [">&-", "<&- >&- 2>&-", "| true"])
def test_output_that_nobody_reads_is_no_failure(end):
    done = shell(f"set -o pipefail; PYTHON -m rsmpm_ti {end}")
    assert (done.returncode, done.stderr) == (0, "")


def test_letters_that_output_does_not_have_are_escaped(tmp_path):
    text = (ROOT / "scenes" / "intact.py").read_text()
    (tmp_path / "mine.py").write_text(text.replace("title=", 'title="岩 " + ', 1), encoding="utf-8")
    done = shell("PYTHON -m rsmpm_ti.scene mine.py --quick --check", tmp_path, PYTHONIOENCODING="ascii")
    assert done.returncode == 0 and "\nscene       \\u5ca9 " in done.stdout, done.stderr
