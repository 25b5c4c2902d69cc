"""What this machine is, for the record, and what it has left for a run: memory and disk, also where a container or the
shell allows less."""

import math
import os
import shutil
import sys
from pathlib import Path

PROC = Path("/proc")
CGROUPS = Path("/sys/fs/cgroup")


def machine() -> dict[str, str]:
    """Versions and machine, for the record; no host name."""
    import importlib.metadata
    import platform

    packages = ("taichi", "numpy", "scipy", "shapely", "meshio", "pillow", "matplotlib", "imageio")
    versions = {}
    for name in packages:
        try:
            versions[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:  # a movie is not written without imageio, but a run goes on
            versions[name] = "not installed"
    return {"python": sys.version.split()[0], **versions, "system": platform.system(), "machine": platform.machine()}


def free_memory() -> float:
    """Bytes that all processes together may still take, of the machine and of the containers around this one."""
    return min(_available(), *_left_in_groups(), math.inf)


def address_space() -> float:
    """Bytes by which this process may grow, by its limits of memory (`ulimit -v`, `ulimit -d`); a child likewise has
    so many."""
    try:
        import resource
    except ImportError:  # no Unix
        return math.inf
    limits = [resource.getrlimit(kind)[0] for kind in (resource.RLIMIT_AS, resource.RLIMIT_DATA)]
    return float(min((limit for limit in limits if limit != resource.RLIM_INFINITY), default=math.inf))


def free_disk(folder: Path) -> float:
    """Bytes of the disk of a folder that may not be there yet."""
    try:
        there = next((path for path in (folder, *folder.absolute().parents) if path.is_dir()), None)
        return math.inf if there is None else float(shutil.disk_usage(there).free)
    except (OSError, ValueError):  # a name that no file can have: who makes the folder says so
        return math.inf


def _available() -> float:
    """Memory that is free, or can be had back from files that were read."""
    for line in _lines(PROC / "meminfo"):
        name, _, size = line.partition(":")
        if name == "MemAvailable":
            return 1024.0 * float(size.split()[0])
    try:
        return float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    except (AttributeError, OSError, ValueError):
        return math.inf


def _left_in_groups() -> list[float]:
    """What every control group (a container, a service, a batch job) leaves to this process and those beside it."""
    left = []
    for line in _lines(PROC / "self" / "cgroup"):
        _, kinds, path = line.split(":", 2)
        names = ("memory.limit_in_bytes", "memory.usage_in_bytes") if kinds else ("memory.max", "memory.current")
        if kinds and "memory" not in kinds.split(","):
            continue
        root = CGROUPS / "memory" if kinds else CGROUPS
        group = root / path.lstrip("/")
        for folder in (group, *group.parents):
            most, used = (_number(folder / name) for name in names)
            if math.isfinite(most):
                left.append(most - (used if math.isfinite(used) else 0.0) + _cached(folder))
            if folder == root:
                break
    return left


def _cached(group: Path) -> float:
    """Of what a group uses, files that were read: they give way."""
    sizes = dict(line.split(" ", 1) for line in _lines(group / "memory.stat") if " " in line)
    return float(sizes.get("inactive_file", sizes.get("total_inactive_file", 0)))


def _number(path: Path) -> float:
    """Of a file of one number; infinite where it says 'max', or nothing."""
    lines = _lines(path)
    return float(lines[0]) if lines and lines[0].isdigit() else math.inf


def _lines(path: Path) -> list[str]:
    try:
        return path.read_text().splitlines()
    except (OSError, ValueError):
        return []
