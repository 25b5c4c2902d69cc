"""What Taichi 1.7.4 does before it compiles a kernel, sooner. A Taichi without what is replaced here is left alone."""

from functools import lru_cache

import taichi as ti


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
