"""Blocks of code of the pages, and how tests run them."""

import re
import runpy
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent

COARSE = {
    "dx": "0.002", "flaw_width": "0.006", "strain_end": "2e-4", "shape": "Linear", "schedule.rows": "50",
    "output.frames": "2", "output.movie": "false", "output.vtu": "1",
}  # fmt: skip
"""Settings by which a snippet's `cube` runs in a second: few cells, a wide flaw, and what compiles fastest."""


def blocks(page: str, language: str = "python") -> list[str]:
    """Code blocks of a page, in order."""
    return re.findall(rf"```{language}\n(.*?)```", (ROOT / page).read_text(encoding="utf-8"), re.DOTALL)


def run_block(folder: Path, code: str) -> dict:
    """What a block leaves behind. Taichi reads kernels from files, so it is one."""
    path = folder / "snippet.py"
    path.write_text(code.replace("quick=True", f"quick=True, settings={COARSE}"), encoding="utf-8")
    return runpy.run_path(str(path))
