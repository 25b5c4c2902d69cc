"""Names of runs: each one part of a path, which no system takes for another or for a way out of a folder."""

import os
import unicodedata
from pathlib import Path

MAX_LETTERS, MAX_BYTES = 100, 200
"""Of a name: with what is added to it, such as `.part.mp4`, it stays below the 255 bytes that a file name may have."""

ALLOWED = f"a file name of 1 to {MAX_LETTERS} letters, digits, '_', '-' and '.', no '.' first"


def run_name(scene: str) -> str:
    """The name under which the run of a scene is filed, given its name or path; of a recorded scene.json the name of
    the folder that it lies in."""
    try:
        path = Path(os.path.abspath(scene))
    except OSError:  # the current folder has been deleted
        path = Path(scene)
    text = path.parent.name if path.name == "scene.json" else path.name
    return made_name(text.removesuffix(".py").removesuffix(".json"))


def made_name(text: str) -> str:
    """Any text as a name: what is not allowed becomes '_'."""
    text = "".join(c if c.isalnum() or c in "_-." else "_" for c in unicodedata.normalize("NFC", text))
    text = text.lstrip(".")[:MAX_LETTERS]
    while len(text.encode()) > MAX_BYTES:
        text = text[:-1]
    return text or "scene"


def is_name(text: object) -> bool:
    return isinstance(text, str) and text == made_name(text)
