"""What is free: of the machine, of the containers around a process, and of what the shell allows."""

import resource
import subprocess
import sys

import pytest

from rsmpm_ti.spec.review import machine

MEMINFO = "MemTotal: 24000000 kB\nMemFree: 100 kB\nMemAvailable: 8000000 kB\n"


@pytest.fixture
def system(tmp_path, monkeypatch):
    """system({file: text}): a Linux of these files."""
    proc, groups = tmp_path / "proc", tmp_path / "cgroup"
    monkeypatch.setattr(machine, "PROC", proc)
    monkeypatch.setattr(machine, "CGROUPS", groups)

    def make(files: dict[str, str]) -> None:
        for name, text in ({"proc/meminfo": MEMINFO} | files).items():
            path = tmp_path / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)

    return make


def test_memory_that_files_hold_is_free_and_no_limit_is_none(system):
    system({"proc/self/cgroup": "0::/a/b\n", "cgroup/a/memory.max": "max\n"})
    assert machine.free_memory() == 8000000 * 1024


@pytest.mark.parametrize(
    "files",
    [
        {"proc/self/cgroup": "0::/a/b\n", "cgroup/a/b/memory.max": "max\n", "cgroup/a/memory.max": "3000\n",
         "cgroup/a/memory.current": "1500\n", "cgroup/a/memory.stat": "anon 5\ninactive_file 500\n"},
        {"proc/self/cgroup": "4:cpu:/x\n3:memory,x:/a\n", "cgroup/memory/a/memory.limit_in_bytes": "3000\n",
         "cgroup/memory/a/memory.usage_in_bytes": "1500\n", "cgroup/memory/a/memory.stat": "total_inactive_file 500\n"},
        # within a container its own group is the root, and the path that is told is of the machine outside
        {"proc/self/cgroup": "0::/docker/1234\n", "cgroup/memory.max": "2000\n"},
    ],
    ids=["second version, a parent's", "first version", "seen from inside"],
)  # fmt: skip
def test_a_container_leaves_what_it_has_not_used(system, files):
    system(files)
    assert machine.free_memory() == 2000


def test_a_system_that_says_nothing_has_what_it_is_built_with(system):
    system({"proc/meminfo": "nothing\n"})
    assert machine.free_memory() > 1e8


REFUSED = """
import resource, sys
resource.setrlimit(resource.RLIMIT_AS, (1_500_000_000, resource.RLIM_INFINITY))
from rsmpm_ti.scene import main
sys.exit(main(["cube", "--quick", "--out", sys.argv[1]]))
"""


@pytest.mark.skipif(sys.platform != "linux", reason="other systems do not keep this limit")
def test_what_ulimit_does_not_allow_is_refused_before_anything_is_made(tmp_path):
    done = subprocess.run([sys.executable, "-c", REFUSED, str(tmp_path / "out")], capture_output=True, text=True)
    assert done.returncode == 2 and "1.5 GB that ulimit leaves to a process" in done.stderr
    assert len(done.stderr.splitlines()) == 1 and not (tmp_path / "out").exists()


def test_no_limit_is_none():
    if resource.getrlimit(resource.RLIMIT_AS)[0] == resource.RLIM_INFINITY:
        assert machine.address_space() > 1e15


def test_a_folder_to_come_is_on_the_disk_of_the_one_above(tmp_path):
    assert 0 < machine.free_disk(tmp_path / "a" / "b") < float("inf")
