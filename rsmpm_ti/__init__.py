"""rsmpm_ti: a rock-fracture laboratory, the material point method on Taichi.

`load_scene(name, **overrides)` builds a `Scene`; `simulate(scene, out=...)` runs it and returns a `Result`.
Both are loaded on first use, so `import rsmpm_ti` alone pulls in neither Taichi nor a painter.
"""

import os

# Taichi greets on standard output when it is imported; a command's output should hold only its own words
os.environ.setdefault("ENABLE_TAICHI_HEADER_PRINT", "0")
# and without a home, as under cron or a service manager, it ends the process by a signal
os.environ.setdefault("HOME", os.path.expanduser("~"))

__version__ = "0.1.0"
__all__ = ["__version__", "load_scene", "simulate"]


def __getattr__(name: str):
    if name == "load_scene":
        from rsmpm_ti.library import load_scene

        return load_scene
    if name == "simulate":
        from rsmpm_ti.run import simulate

        return simulate
    raise AttributeError(f"module 'rsmpm_ti' has no attribute {name!r}")
