"""What Taichi would do by itself: follow variables of the environment, tell its makers, need a home and a folder."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]

SCRIPT = """
import json, os, pwd, sys, time, warnings


def unknown(user):
    raise KeyError(user)


pwd.getpwuid = unknown
from rsmpm_ti.backend.start import start_taichi

import taichi as ti  # NumPy 2.5 is not imported from a folder that is gone

gone = os.path.join(sys.argv[1], "gone")
os.mkdir(gone)
os.chdir(gone)
os.rmdir(gone)

with warnings.catch_warnings(record=True) as said:
    warnings.simplefilter("always")
    start_taichi("f64", "cpu", 1)

runtime, config = ti.lang.impl.get_runtime(), ti.lang.impl.current_cfg()
field = ti.field(int, 4)
field.fill(1)
time.sleep(0.2)  # what a thread would have written meanwhile
files = [name for _, _, names in os.walk(sys.argv[1]) for name in names if "version" in name]
said = [str(w.message) for w in said if "Rock" in w.category.__name__]
print(json.dumps({
    "settings": [str(config.arch), str(runtime.default_ip), bool(config.debug)], "files": files,
    "home": os.environ["HOME"], "sum": int(field.to_numpy().sum()), "said": said,
}))
"""

VARIABLES = {
    "PYTHONWARNINGS": "error",
    "TI_ARCH": "nonsense",
    "TI_DEFAULT_IP": "64",
    "TI_DEBUG": "yes",
    "TI_OFFLINE_CACHE": "yes",
}


@pytest.mark.parametrize("home", ["a home", "no home"])
def test_taichi_follows_arguments_alone_and_tells_nobody(tmp_path, home):
    """Without a home, and by a user whom the system does not know; the current folder has been deleted."""
    kept = {name: value for name, value in os.environ.items() if name not in ("HOME", "TI_SKIP_VERSION_CHECK")}
    environment = kept | VARIABLES | {"PYTHONPATH": str(ROOT), "TI_OFFLINE_CACHE_FILE_PATH": str(tmp_path / "kernels")}
    environment |= {"HOME": str(tmp_path)} if home == "a home" else {}
    command = [sys.executable, "-c", SCRIPT, str(tmp_path)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=120, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert found["settings"] == ["Arch.x64" if "x86" in os.uname().machine else "Arch.arm64", "i32", False]
    assert found["files"] == [] and found["sum"] == 4, "the file in which Taichi keeps the id that it sends"
    assert found["home"] == (str(tmp_path) if home == "a home" else os.devnull)
    (sentence,) = found["said"]
    assert sentence.startswith(
        "TI_ARCH, TI_DEBUG, TI_DEFAULT_IP, TI_OFFLINE_CACHE: variables for Taichi are not followed"
    )


@pytest.mark.parametrize(
    "name, words",
    [
        ("TI_LOG_LEVEL", "must be trace, debug, info"),
        ("TI_ENABLE_PYBUF", "must be 0 or 1"),
        ("LC_ALL", "must be a locale of this system"),
    ],
)
def test_a_variable_that_taichi_cannot_read_on_import_is_refused_in_a_line(name, words):
    command = [sys.executable, "-m", "rsmpm_ti.scene", "--list"]
    environment = os.environ | {name: "loud", "PYTHONPATH": str(ROOT)}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=60, cwd=ROOT)
    assert done.returncode == 2 and done.stderr.count("\n") == 1
    assert f"{name} = 'loud' is refused" in done.stderr and words in done.stderr
