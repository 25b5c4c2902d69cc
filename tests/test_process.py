"""What processes that the product starts see, and what commands do where their output ends."""

import contextlib
import json
import multiprocessing
import os
import shutil
import signal
import subprocess
import sys
import time
import zipapp
from pathlib import Path

import numpy as np
import pytest
from snapshots import snapshot_of
from writer_orders import NO_ROWS, started

from rsmpm_ti.__main__ import COMMANDS
from rsmpm_ti.ctrl_c import module_of
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


def test_cases_that_run_in_processes_of_their_own_run_nothing_of_the_current_folder(planted):
    with no_current_folder():
        with multiprocessing.get_context("spawn").Pool(1) as pool:
            assert pool.apply(os.getpid) != os.getpid()
            assert pool.apply(os.getcwd) == str(planted / "planted")
    assert not (planted / "executed").exists()


CASES = """
import sys
sys.path[:] = [{root!r}, *sys.path[1:]]
from pathlib import Path
from rsmpm_ti.cases.running import run_cases
if __name__ == "__main__":
    (finished,) = run_cases("rsmpm_ti.verify.catalogue", ["none"], False, Path("out"), 1, 1)
    print(finished.problem)
"""


def test_a_case_runs_nothing_of_the_current_folder(planted):
    """As of the console command, which does not look there either. There is no such case, so it ends at once."""
    (planted / "program.py").write_text(CASES.format(root=str(ROOT)))
    done = shell(f"PYTHON {planted / 'program.py'}", planted / "planted", PYTHONPATH="")
    assert done.stdout == "KeyError: 'none'\n", done.stderr
    assert not (planted / "executed").exists()


HEARS = """
import multiprocessing, os, signal, sys
sys.path.insert(0, {root!r})
from pathlib import Path
from rsmpm_ti.process import no_current_folder, without_ctrl_c
def blocked():
    return signal.SIGINT in signal.pthread_sigmask(signal.SIG_BLOCK, [])
if __name__ == "__main__":
    with no_current_folder():
        with without_ctrl_c():
            pool = multiprocessing.get_context("spawn").Pool(1, maxtasksperchild=1)
        with pool:
            print(blocked(), [pool.apply(blocked) for _ in range(2)])
"""


@pytest.mark.skipif(not hasattr(signal, "pthread_sigmask"), reason="no signals for groups of processes")
def test_ctrl_c_is_for_the_process_that_waits_for_others(tmp_path):
    (tmp_path / "program.py").write_text(HEARS.format(root=str(ROOT)))
    assert shell("PYTHON program.py", tmp_path).stdout == "False [True, True]\n"


@pytest.mark.skipif(not hasattr(signal, "pthread_sigmask"), reason="no signals for groups of processes")
def test_ctrl_c_ends_a_command_that_spreads_cases_at_once(tmp_path):
    """More cases than run at a time: those that wait do not begin."""
    command = [sys.executable, "-m", "rsmpm_ti.verify", "--jobs", "1", "--out", str(tmp_path)]
    environment = os.environ | {"PYTHONPATH": str(ROOT), "PYTHONUNBUFFERED": "1"}
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen(command, env=environment, cwd=tmp_path, start_new_session=True, **pipes) as run:
        assert run.stdout.readline()
        time.sleep(0.5)
        os.killpg(run.pid, signal.SIGINT)
        try:
            said = run.communicate(timeout=10)[1]
        finally:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(run.pid, signal.SIGKILL)
    assert (run.returncode, said) == (130, "rsmpm_ti: stopped by Ctrl-C; what is complete is kept\n")


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL])
def test_cases_end_with_their_command(tmp_path, number):
    """Whoever kills a command by its number alone leaves nothing behind that goes on computing."""
    command = [sys.executable, "-m", "rsmpm_ti.verify", "lab_residual", "--full", "--out", str(tmp_path)]
    with subprocess.Popen(command, env=os.environ | {"PYTHONPATH": str(ROOT)}, stdout=subprocess.DEVNULL) as run:
        until = time.monotonic() + 30.0
        while len(children(run.pid)) < 2:  # the case, of minutes, and what keeps count of semaphores
            assert run.poll() is None and time.monotonic() < until
            time.sleep(0.05)
        begun = children(run.pid)
        run.send_signal(number)
        run.wait(timeout=10)
    until = time.monotonic() + 10.0
    while any(map(is_running, begun)):
        assert time.monotonic() < until, "cases go on"
        time.sleep(0.05)


def children(process: int) -> list[int]:
    """Of all of its threads."""
    found = []
    for thread in Path(f"/proc/{process}/task").glob("*/children"):
        with contextlib.suppress(OSError):
            found += [int(pid) for pid in thread.read_text().split()]
    return found


def is_running(process: int) -> bool:
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


SEEN = """
import json, sys
seen = lambda: [list(filter(None, sys.path)), list(sys.warnoptions), sys.flags.optimize, sys.flags.utf8_mode,
                sys.flags.dev_mode, sys.pycache_prefix, sys.modules["rsmpm_ti"].__file__]
"""
PARENT = f"""
import sys
import zipapp
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


IMPORTING = """
import os, signal
from rsmpm_ti.process import command
{first}
@command
def main():
    {then}
sys.exit(main())
"""
NOW = "os.kill(os.getpid(), signal.SIGINT)"
LOST = """
    try:
        os.kill(os.getpid(), signal.SIGINT)
    except KeyboardInterrupt:
        raise ImportError("initialization failed")
"""


@pytest.mark.parametrize("first, then", [(NOW, "pass"), ("", NOW), ("", LOST)], ids=["imports", "main", "C module"])
def test_ctrl_c_at_any_moment_of_a_command_is_a_line_and_a_status(tmp_path, first, then):
    (tmp_path / "rsmpm_ti.py").write_text("import sys\ndel sys.path[0]\n" + IMPORTING.format(first=first, then=then))
    done = shell("PYTHON rsmpm_ti.py; exit $?", tmp_path)
    assert (done.returncode, done.stderr) == (130, "rsmpm_ti: stopped by Ctrl-C; what is complete is kept\n")


def test_ctrl_c_while_a_command_is_imported_is_a_line_and_a_status(tmp_path):
    """Sent by the first module that is imported after the package itself."""
    (tmp_path / "lazy_loader.py").write_text(f"import os, signal\n{NOW}\nimport time; time.sleep(9)")
    for name in COMMANDS:
        done = shell(f"PYTHON -m rsmpm_ti.{name}; exit $?", tmp_path, PYTHONPATH=f"{tmp_path}:{ROOT}")
        assert (done.returncode, done.stderr) == (130, "rsmpm_ti: stopped by Ctrl-C; what is complete is kept\n")


@pytest.mark.parametrize("how", ["zipapp", "path"])
def test_a_package_within_an_archive_says_that_it_must_be_files(tmp_path, how):
    shutil.copytree(ROOT / "rsmpm_ti", tmp_path / "all" / "rsmpm_ti", ignore=shutil.ignore_patterns("__pycache__"))
    zipapp.create_archive(tmp_path / "all", tmp_path / "x.pyz", main="rsmpm_ti.__main__:main")
    line, path = ("PYTHON x.pyz", "") if how == "zipapp" else ("PYTHON -m rsmpm_ti.scene --list", tmp_path / "x.pyz")
    done = shell(line, tmp_path, PYTHONPATH=str(path))
    assert (done.returncode, done.stdout) == (2, "")
    said = f"rsmpm_ti cannot run from within {tmp_path / 'x.pyz'}: it must be installed as files, by `pip install "
    assert done.stderr == f"{said}rsmpm_ti`\n"


@pytest.mark.parametrize(
    "words, module",
    [
        ("-m rsmpm_ti.scene cube", "rsmpm_ti.scene"),
        ("-mrsmpm_ti.scene cube", "rsmpm_ti.scene"),
        ("-um rsmpm_ti.scene cube -m other", "rsmpm_ti.scene"),
        ("-X dev -W error -umrsmpm_ti", "rsmpm_ti"),
        ("-Xdev -Werror -m rsmpm_ti", "rsmpm_ti"),
        ("--check-hash-based-pycs always -m rsmpm_ti", "rsmpm_ti"),
        ("prog.py -m rsmpm_ti", ""),
        ("-c pass -m rsmpm_ti", ""),
        ("-uc pass -m rsmpm_ti", ""),
        ("- -m rsmpm_ti", ""),
        ("-W m rsmpm_ti", ""),
        ("-m pytest -m rsmpm_ti", "pytest"),
        ("", ""),
    ],
)
def test_only_what_python_was_asked_to_run_makes_a_command(words, module):
    """A program that imports the package keeps its own Ctrl-C, whatever its arguments."""
    assert module_of(words.split()) == module
