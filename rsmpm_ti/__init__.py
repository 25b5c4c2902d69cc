"""rsmpm_ti: a rock-fracture laboratory, the material point method on Taichi.

`load_scene(name, **overrides)` builds a `Scene`; `simulate(scene, out=...)` runs it and returns a `Result`. Every
public name is imported from here, `from rsmpm_ti import Scene, Body, Box, MPa`; `__init__.pyi` lists them. They are
loaded on first use, so `import rsmpm_ti` alone pulls in neither Taichi nor a painter.
"""

import locale
import os
import sys
import warnings
from importlib.util import find_spec

import rsmpm_ti.backend.forks  # noqa: F401  (a fork from here on is known to be one)
from rsmpm_ti.ctrl_c import leave_in_a_line, module_of

__version__ = "0.1.0"

NEEDED = (
    "taichi numpy scipy matplotlib cmcrameri PIL fpng meshio rich jinja2 lazy_loader pydantic annotated_types pint"
).split()
NEEDED += ["tomli"] if sys.version_info < (3, 11) else []
"""Modules without which no command works; they are those of pyproject.toml but for those of movies and of outlines."""


def _is_command() -> bool:
    """Whether this process is `python -m rsmpm_ti...` or the console command, and no program that imports us."""
    program = [os.path.splitext(os.path.basename(word))[0] for word in getattr(sys, "argv", [])[:1]]
    archive = os.path.dirname(os.path.dirname(__file__))  # by `python -m zipapp`: a program that is run as it is
    named = module_of(sys.orig_argv[1:]).split(".")[0] == "rsmpm_ti" or program == ["rsmpm_ti"]
    return named or os.path.isfile(archive) and os.path.abspath(sys.argv[0]) == os.path.abspath(archive)


def _end(line: str) -> None:
    """Raise ImportError, or end a command by one line."""
    if _is_command():
        print(line, file=sys.stderr)
        raise SystemExit(2)
    raise ImportError(line)


def _say_that_it_is_no_folder() -> None:
    """Taichi reads the source of kernels from files, and so do we what ships beside them."""
    if not os.path.isfile(__file__):
        place = os.path.dirname(os.path.dirname(__file__))
        _end(f"rsmpm_ti cannot run from within {place}: it must be installed as files, by `pip install rsmpm_ti`")


def _say_what_is_missing() -> None:
    """Where a package that everything needs is not installed."""
    missing = [name for name in NEEDED if find_spec(name) is None]
    if missing:
        _end(
            f"rsmpm_ti needs {', '.join(missing)}, which {sys.executable} does not have: use .venv/bin/python, which "
            f"`make` builds in a checkout, or `pip install rsmpm_ti`"
        )


def _say_what_cannot_start() -> None:
    """NumPy takes its threads when it is imported, and where it gets none ends a command as Ctrl-C does."""
    from rsmpm_ti.backend.threads import blas_threads, check_threads

    try:
        check_threads(blas_threads(), "; or set OPENBLAS_NUM_THREADS=1 in the environment")
    except ValueError as error:
        _end(f"rsmpm_ti: {error}")


LEVELS = "trace debug info warn error critical off".split()
SWITCHES = "TI_ENABLE_PYBUF TI_ENABLE_TORCH TI_ENABLE_PADDLE".split()


def _say_what_taichi_cannot_read() -> None:
    """Variables of the environment that it reads when it is imported, and does not bear otherwise."""
    if os.environ.get("TI_LOG_LEVEL", "off") not in ("", *LEVELS):
        _end(f"rsmpm_ti: TI_LOG_LEVEL = {os.environ['TI_LOG_LEVEL']!r} is refused: it must be {', '.join(LEVELS)}")
    for name in SWITCHES:
        if os.environ.get(name, "") not in ("", "0", "1"):
            _end(f"rsmpm_ti: {name} = {os.environ[name]!r} is refused: it must be 0 or 1")
    # what it does that will be no more is not ours to mend, and ends it where warnings are errors
    warnings.filterwarnings("ignore", category=DeprecationWarning, module=r".*\btaichi\b")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            locale.getdefaultlocale()
    except ValueError:  # LC_CTYPE=UTF-8, as some terminals hand on to another machine
        given = next(name for name in ("LC_ALL", "LC_CTYPE", "LANG", "LANGUAGE") if os.environ.get(name))
        _end(f"rsmpm_ti: {given} = {os.environ[given]!r} is refused: it must be a locale of this system, as C.UTF-8 is")


if _is_command():
    leave_in_a_line()
_say_that_it_is_no_folder()
_say_what_is_missing()
_say_what_taichi_cannot_read()
if _is_command():
    _say_what_cannot_start()
# Taichi greets on standard output when it is imported; a command's output should hold only its own words
os.environ.setdefault("ENABLE_TAICHI_HEADER_PRINT", "0")
# and without a home, as under cron or a service manager, it ends the process by a signal
_home = os.path.expanduser("~")
os.environ.setdefault("HOME", os.devnull if _home == "~" else _home)  # "~": of a user whom the system does not know

import lazy_loader  # noqa: E402  (known to be there only now)

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
