"""Where Taichi keeps compiled kernels: where it always does, or in a temporary folder where that cannot be written.

Taichi 1.7.4 does not bear such a folder, in a container without a home for example: the process ends by a signal.
"""

import os
import tempfile
from pathlib import Path

VARIABLE = "TI_OFFLINE_CACHE_FILE_PATH"
"""By which Taichi is told of another folder."""


def ensure_kernel_cache() -> None:
    """Name a folder that can be written, to Taichi and to child processes, before Taichi is started."""
    folder = Path(os.environ.get(VARIABLE) or Path.home() / ".cache" / "taichi" / "ticache")
    if not _can_be_written(folder):
        os.environ[VARIABLE] = str(_temporary())


def _can_be_written(folder: Path) -> bool:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return True
    except OSError:
        return False


def _temporary() -> Path:
    """A folder of this user's, the same in every run, so that kernels are compiled once; nobody else's is trusted."""
    user = os.getuid() if hasattr(os, "getuid") else 0
    folder = Path(tempfile.gettempdir()) / f"rsmpm_ti_kernels_{user}"
    try:
        folder.mkdir(mode=0o700, exist_ok=True)
        if not folder.is_symlink() and folder.stat().st_uid == user and _can_be_written(folder):
            return folder
    except OSError:
        pass
    return Path(tempfile.mkdtemp(prefix="rsmpm_ti_kernels_"))
