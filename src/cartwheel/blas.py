"""Threads of OpenBLAS, the library for linear algebra in numpy.

OpenBLAS starts a thread for each processor when numpy is imported. The matrices of a simulation are
too small for more than one, and starting them takes a sixth of a short command's processor time.
"""

from __future__ import annotations

import os

_THREADS = "OPENBLAS_NUM_THREADS"
_OURS = "CARTWHEEL_SET_OPENBLAS_NUM_THREADS"
"""Set if this module has set the other variable, in processes that inherit both."""


def use_one_thread() -> None:
    """Limits this process and those that it starts to one thread, unless the user set a number.

    It has no effect once numpy has been imported.
    """
    if _THREADS not in os.environ:
        os.environ[_THREADS] = os.environ[_OURS] = "1"


def environment_for_others() -> dict[str, str]:
    """The environment variables for a program that is not Cartwheel's, which may need threads."""
    ours = (_THREADS, _OURS) if _OURS in os.environ else ()
    return {name: value for name, value in os.environ.items() if name not in ours}
