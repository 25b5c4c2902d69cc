"""python -m rsmpm_ti, or the console command rsmpm_ti: lists the commands, or runs one, `rsmpm_ti scene cube`."""

import importlib
import sys

from rsmpm_ti.process import command, tell

COMMANDS = {
    "scene": ("rsmpm_ti.scene", "load a rock specimen, break it, and write pictures, curve, events and particle data"),
    "lab": ("rsmpm_ti.lab.__main__", "a standard test of a rock: specimens are run, and a report is written"),
    "verify": ("rsmpm_ti.verify.__main__", "hold the solver against exact solutions, finite elements, published data"),
    "hardcases": (
        "rsmpm_ti.hardcases.__main__",
        "what usually breaks material point codes: crossing, impact, collapse",
    ),
    "study": ("rsmpm_ti.study.__main__", "families of runs against theory: grids, flaw angles, fracture energy"),
    "calibrate": ("rsmpm_ti.calibrate.__main__", "fit a rock to measured numbers and curves, by tests of the lab"),
    "validate": ("rsmpm_ti.validate.__main__", "hold predictions against experiments on rock: measured distances"),
    "bench": ("rsmpm_ti.bench.__main__", "measure speed, alone and against error"),
}
"""Command -> the module whose `main(arguments)` it is, which `python -m rsmpm_ti.COMMAND` runs too; what it does."""


def listing() -> str:
    lines = [f"  {name:<11}{about}" for name, (_, about) in COMMANDS.items()]
    head = "rsmpm_ti COMMAND ..., or python -m rsmpm_ti.COMMAND ...; --help after a command tells more"
    return "\n".join([head, "", *lines])


@command
def main(arguments: list[str] | None = None) -> int:
    """Exit status of the command; 0 for the list, 2 for a command that there is not."""
    arguments = sys.argv[1:] if arguments is None else arguments
    if not arguments or arguments[0] in ("-h", "--help", "help"):
        print(listing())
        return 0
    if arguments[0] == "--version":
        from rsmpm_ti import __version__

        print(f"rsmpm_ti {__version__}")
        return 0
    if arguments[0] not in COMMANDS:
        known = f"there are {', '.join(COMMANDS)}; a scene is run by `rsmpm_ti scene NAME`"
        tell(f"rsmpm_ti: there is no command {arguments[0]!r}; {known}")
        return 2
    return importlib.import_module(COMMANDS[arguments[0]][0]).main(arguments[1:])


if __name__ == "__main__":
    sys.exit(main())
