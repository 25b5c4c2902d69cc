"""Start Taichi: the one place that does."""

import contextlib
import gc
import io
import os

from rsmpm_ti.backend.kernel_cache import ensure_kernel_cache
from rsmpm_ti.errors import SceneError


def start_taichi(precision: str, arch: str, threads: int | None):
    import taichi as ti

    from rsmpm_ti.backend.field_memory import use_field_memory
    from rsmpm_ti.backend.taichi_patches import hasten_compiling

    ensure_kernel_cache()
    hasten_compiling()
    use_field_memory()
    _forget_earlier_fields()
    real = ti.f64 if precision == "f64" else ti.f32
    # never ti.gpu: it crashes without Vulkan, or runs silently on a software Vulkan with wrong numbers
    wanted = [ti.cuda, ti.cpu] if arch == "cuda" else ti.cpu
    with contextlib.redirect_stdout(io.StringIO()):  # it announces its backend there
        try:
            ti.init(
                arch=wanted, default_fp=real, cpu_max_num_threads=threads or os.cpu_count() or 1, log_level=ti.ERROR,
                cfg_optimization=False,  # LLVM does the same; its time outgrows the kernel: 20 s for one of 6 s
            )  # fmt: skip
        except RuntimeError as error:  # it reserves a GiB of addresses, for example
            raise SceneError(f"Taichi cannot be started: {error}; give this process more memory") from None
    if arch == "cuda" and ti.lang.impl.current_cfg().arch != ti.cuda:
        raise SceneError("arch = 'cuda' is refused: no usable CUDA device was found; use --arch cpu")
    return real, arch == "cuda"


def _forget_earlier_fields() -> None:
    """Free what the fields of earlier runs hold in this process, just before `ti.init` ends their life.

    They hang in cycles, and Taichi 1.7.4 keeps them as keys among the arguments that its kernels have seen.
    """
    import taichi as ti

    for kernel in getattr(ti.lang.impl.get_runtime(), "kernels", ()):
        getattr(getattr(kernel, "mapper", None), "mapping", {}).clear()
    gc.collect()
