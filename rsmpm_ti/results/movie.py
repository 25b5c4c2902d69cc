"""The movie of a run as a notebook shows it."""

import base64
import html
from pathlib import Path

from rsmpm_ti.errors import SceneError
from rsmpm_ti.results.stored import Stored

MOST_BYTES = 64 * 2**20
"""Of a movie that is put into a page: a third more in letters."""


class Movie:
    """path: of the mp4. A notebook shows it in the page, which keeps it; text is its path alone."""

    def __init__(self, folder: Stored):
        """Raises SceneError where the run has none."""
        names = [name for name in folder.names if name.endswith(".mp4")]
        if not names:
            raise SceneError(f"{folder.path} has no movie; run it with output.movie and output.frames")
        self._folder, self._name = folder, names[-1]

    @property
    def path(self) -> Path:
        return self._folder.path / self._name

    def __repr__(self) -> str:
        return f"Movie({str(self.path)!r})"

    def _repr_html_(self) -> str:
        try:
            letters = base64.b64encode(self._folder.bytes(self._name, MOST_BYTES)).decode("ascii")
        except SceneError as error:
            return f"<p>{html.escape(str(error))}</p>"
        return f'<video controls loop style="max-width:100%" src="data:video/mp4;base64,{letters}"></video>'
