"""A case whose process is killed, as by a system that is out of memory."""

import os
import signal

from rsmpm_ti.cases.case import Case


def kill(_: bool):
    os.kill(os.getpid(), signal.SIGKILL)


CASES = {"kills": Case("kills", "a process that is killed", kill)}
