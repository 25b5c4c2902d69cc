"""A TOML file of somebody, read with limits: it is data, and each way in which it is none is one line."""

import stat
import sys
from pathlib import Path

from rsmpm_ti.errors import SceneError, reason, short

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

MAX_BYTES = 65_536
"""Of a file."""


def tables_of(path: Path, kind: str, remedy: str, example: str) -> dict:
    """What a file holds. kind: what it should be; remedy: for what is no file; example: a line as it should be.

    Raises SceneError, which does not name the file.
    """
    try:
        if not stat.S_ISREG(path.stat().st_mode):
            raise SceneError(f"it is no regular file; {remedy}")
        if path.stat().st_size > MAX_BYTES:
            raise SceneError(f"it has more than {MAX_BYTES} bytes, which no {kind} has")
        return tomllib.loads(path.read_bytes()[: MAX_BYTES + 1].decode("utf-8"))
    except FileNotFoundError:
        raise SceneError("there is no such file") from None
    except UnicodeDecodeError:
        raise SceneError("it is no text in UTF-8") from None
    except OSError as error:
        raise SceneError(f"it cannot be read: {reason(error)}") from None
    except (ValueError, RecursionError) as error:
        if isinstance(error, SceneError):
            raise
        why = "too deep" if isinstance(error, RecursionError) else short(" ".join(str(error).split()))
        raise SceneError(f"it is no TOML: {why}; texts stand in quotes, {example}") from None
