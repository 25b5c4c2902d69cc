"""Start Taichi: the one place that does."""

import contextlib
import gc
import io
import warnings

from rsmpm_ti.backend.forks import is_fork, runtime
from rsmpm_ti.backend.kernel_cache import ensure_kernel_cache
from rsmpm_ti.backend.threads import check_run_threads, cores
from rsmpm_ti.errors import RockWarning, SceneError

_ours: object = None
"""The runtime of Taichi that was started here; a user may have started another."""


def start_taichi(precision: str, arch: str, threads: int | None):
    check_process()
    check_run_threads(threads, writes=False)
    import taichi as ti

    from rsmpm_ti.backend.field_memory import use_field_memory
    from rsmpm_ti.backend.taichi_patches import by_arguments_alone, hasten_compiling

    global _ours
    ensure_kernel_cache()
    hasten_compiling()
    use_field_memory()
    _forget_earlier_fields()
    real = ti.f64 if precision == "f64" else ti.f32
    # never ti.gpu: it crashes without Vulkan, or runs silently on a software Vulkan with wrong numbers
    wanted = [ti.cuda, ti.cpu] if arch == "cuda" else ti.cpu
    # it announces its backend on standard output
    with contextlib.redirect_stdout(io.StringIO()), by_arguments_alone() as ignored:
        try:
            ti.init(
                arch=wanted, default_fp=real, cpu_max_num_threads=threads or cores(), log_level=ti.ERROR,
                cfg_optimization=False,  # LLVM does the same; its time outgrows the kernel: 20 s for one of 6 s
            )  # fmt: skip
        except RuntimeError as error:  # it reserves a GiB of addresses, for example
            raise SceneError(f"Taichi cannot be started: {error}; give this process more memory") from None
    _ours = ti.lang.impl.get_runtime()
    if ignored:
        warnings.warn(
            f"{', '.join(ignored)}: variables for Taichi are not followed; precision, arch and threads are arguments",
            RockWarning,
            stacklevel=2,
        )
    if arch == "cuda" and ti.lang.impl.current_cfg().arch != ti.cuda:
        raise SceneError("arch = 'cuda' is refused: no usable CUDA device was found; use --arch cpu")
    return real, arch == "cuda"


def check_process() -> None:
    """Raises SceneError where starting Taichi would never end, or take memory away that others use."""
    if is_fork():
        raise SceneError(
            "this process is the fork of one in which Taichi ran, and Taichi does not survive a fork: start it anew, "
            "by multiprocessing.get_context('spawn')"
        )
    found = runtime()
    # fields that wait for their memory, and pieces of memory that have been given to fields
    if found not in (None, _ours) and (found.global_vars or found.prog.get_snode_tree_size()):
        raise SceneError(
            "Taichi holds fields of your own in this process, and a run frees them: call ti.reset() if they are not "
            "needed any more, or run in a process of its own, by multiprocessing.get_context('spawn')"
        )


class Freed:
    """What a field becomes when its memory is gone: to use it would end the process by a signal."""

    def __getattribute__(self, name: str):
        if name.startswith("__"):
            return object.__getattribute__(self, name)
        raise RuntimeError(
            "this Taichi field is gone: a run started Taichi anew; make it after the run, or copy it out"
        )

    def __getitem__(self, key):
        return self.gone

    def __setitem__(self, key, value):
        return self.gone


def _forget_earlier_fields() -> None:
    """Free what the fields of earlier runs hold in this process, just before `ti.init` ends their life.

    They hang in cycles, and Taichi 1.7.4 keeps them as keys among the arguments that its kernels have seen. Those that
    somebody still holds raise from now on.
    """
    import taichi as ti

    for kernel in getattr(ti.lang.impl.get_runtime(), "kernels", ()):
        getattr(getattr(kernel, "mapper", None), "mapping", {}).clear()
    gc.collect()
    for thing in gc.get_objects():
        if issubclass(type(thing), ti.Field | ti.Ndarray):
            thing.__class__ = Freed
