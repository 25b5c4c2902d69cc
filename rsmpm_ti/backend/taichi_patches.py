"""What Taichi 1.7.4 does before it compiles a kernel, sooner. A Taichi without what is replaced here is left alone."""

import contextlib
import os
from collections.abc import Iterator
from functools import lru_cache

import taichi as ti

FOLLOWED = ("TI_OFFLINE_CACHE", "TI_OFFLINE_CACHE_FILE_PATH")
"""Variables of the environment that concern no number of a run."""


class WholeLines:
    """In place of `textwrap.TextWrapper`: a line of source stays one line."""

    def __init__(self, width: int):
        """width: taken and not used, as the original is called."""

    def wrap(self, text: str) -> list[str]:
        return [text.rstrip()] if text.strip() else []


def hasten_compiling() -> None:
    """Spare Taichi work that is done for every use of a function, in every run, whether kernels are kept or not.

    For each name and operator of a kernel it prepares the message that it would print if just there were an error, and
    wraps it to 80 columns: a fifth of the time from Python to the first step. Messages have the same words without. And
    it looks up a function's source each time that a kernel calls it.
    """
    builder, kernels = getattr(ti.lang.ast, "ast_transformer_utils", None), ti.lang.kernel_impl
    if hasattr(builder, "TextWrapper"):
        builder.TextWrapper = WholeLines
    look_up = getattr(kernels, "getsourcelines", None)
    if look_up is not None and not hasattr(look_up, "cache_info"):
        kernels.getsourcelines = lru_cache(maxsize=1024)(look_up)


class System:
    """In place of the module `os` where Taichi is started: no variables but some, and any current folder."""

    def __init__(self, environ: dict[str, str]):
        self.environ = environ

    def __getattr__(self, name: str):
        return getattr(os, name)

    def getcwd(self) -> str:
        """Of a folder that has been deleted meanwhile there is no name, and none is needed."""
        with contextlib.suppress(FileNotFoundError):
            return os.getcwd()
        return ""

    def chdir(self, path: str) -> None:
        if path:
            os.chdir(path)


class NoVersionCheck:
    """In place of the module by which every day's first start tells Taichi's makers version, platform and an id that
    stays."""

    @staticmethod
    def start_version_check_thread() -> None:
        pass


@contextlib.contextmanager
def by_arguments_alone() -> Iterator[list[str]]:
    """Within it `ti.init` follows its arguments and no variables such as TI_ARCH or TI_DEBUG, and sends nothing.

    Gives the names of those that it would have followed. A user's own `ti.init` is as it always was.
    """
    place, config = ti.lang.misc, ti.lang.impl.default_cfg()
    named = ("TI_ARCH", "TI_DEFAULT_FP", "TI_DEFAULT_IP")
    heard = {name for name in os.environ if name in named or hasattr(config, name.removeprefix("TI_").lower())}
    heard = {name for name in heard if name.startswith("TI_") and name not in FOLLOWED}
    if not (os.environ.get("TI_OFFLINE_CACHE") or "0").isdigit():
        heard.add("TI_OFFLINE_CACHE")
    before = {name: getattr(place, name) for name in ("os", "_version_check") if hasattr(place, name)}
    known = {name: value for name, value in os.environ.items() if not name.startswith("TI_") or name in FOLLOWED}
    for name in heard:
        known.pop(name, None)
    place.os, place._version_check = System(known), NoVersionCheck
    try:
        yield sorted(heard)
    finally:
        for name, module in before.items():
            setattr(place, name, module)
