"""The program: runs a command, and converts errors to messages and an exit status.

Status 0 is success; 1 is an internal error of Cartwheel; 2 is an error that the user can correct;
128 plus the signal's number means that a command was interrupted before it finished.
"""

from __future__ import annotations

import errno
import gc
import os
import sys
import traceback

from cartwheel import blas
from cartwheel.cli import gazebo, interrupts
from cartwheel.codes.command import FILE_TOO_DEEP, INTERNAL_FAULT, SYSTEM_LIMIT
from cartwheel.errors import CartwheelError, Diagnostic
from cartwheel.options import Caller, set_caller


def main() -> None:
    """The entry point of ``cartwheel``."""
    # With Python's own thresholds, looking for garbage takes a tenth of a short command's time.
    gc.set_threshold(10_000, 20, 10)
    blas.use_one_thread()
    _open_streams()
    set_caller(Caller.COMMAND_LINE)
    interrupts.install()
    status = run()
    if status not in (0, 130) and interrupts.came():
        # It was raised within something that made another error of it.
        status = 128 + interrupts.last_signal()
    interrupts.leave(status)


def run() -> int:
    """Runs the command in the arguments; returns the status."""
    try:
        if gazebo.is_program(name := (sys.argv[1:2] or [""])[0]):
            gazebo.start(name, sys.argv[2:])
            return 0
        # Imported only now, so that a signal in the meantime finds its handler.
        from cartwheel.cli.app import named

        app = named(sys.argv[1:])
        return _status(app(prog_name="cartwheel", standalone_mode=False))
    except interrupts.Interrupted as interrupted:
        return 128 + interrupted.number
    except CartwheelError as error:
        if not interrupts.came():
            _print(error.diagnostic())
        return 2
    except BrokenPipeError:
        # The reader of the output has closed it, as `head` does.
        _drop_output()
        return 0
    except SystemExit as done:
        return done.code if isinstance(done.code, int) else 0
    except RecursionError:
        _print(FILE_TOO_DEEP.diagnostic("the file is nested too deeply"))
        return 2
    except Exception as error:  # noqa: BLE001 - the last resort
        from cartwheel.cli import usage

        if usage.is_wrong(error):
            return usage.report(error)
        remedy = _remedy(error)
        if remedy:
            _print(SYSTEM_LIMIT.diagnostic(str(error), hint=remedy))
            return 2
        if not interrupts.came():
            _report(error)
        return 1


_REMEDIES = {
    errno.EMFILE: "Raise the limit of open files: ulimit -n 1024",
    errno.ENFILE: "The system has too many open files. Close other programs.",
    errno.ENOMEM: "Free memory, or raise the limit: ulimit -v unlimited",
    errno.EFBIG: "Raise the limit of file sizes: ulimit -f unlimited",
    errno.ENOSPC: "Free space on the disk.",
    errno.EDQUOT: "Free space on the disk.",
    errno.EAGAIN: "Raise the limit of processes: ulimit -u unlimited",
}


def _remedy(error: Exception) -> str:
    """A remedy if the system refused a required resource; empty for other errors."""
    return _REMEDIES.get(error.errno or 0, "") if isinstance(error, OSError) else ""


def _open_streams() -> None:
    """Opens standard streams that were closed when the process started.

    Otherwise a socket or a recording would get their number and receive printed output.
    """
    for number, mode in ((0, "r"), (1, "w"), (2, "w")):
        try:
            os.fstat(number)
        except OSError:
            # The lowest free number is the missing one.
            os.open(os.devnull, os.O_RDWR)
            stream = open(number, mode, closefd=False)  # noqa: SIM115 - for the whole process
            setattr(sys, ("stdin", "stdout", "stderr")[number], stream)


def _report(error: Exception) -> None:
    if "--verbose" in sys.argv:
        traceback.print_exc()
    _print(
        INTERNAL_FAULT.because(
            "unexpected error in Cartwheel",
            error,
            hint="Please report this error with the output of the same command with --verbose.",
        )
    )


def _print(diagnostic: Diagnostic) -> None:
    from cartwheel.cli.showing import print_diagnostic

    print_diagnostic(diagnostic)


def _status(result: object) -> int:
    return result if isinstance(result, int) else 0


def _drop_output() -> None:
    """Prevents writes to a closed pipe at exit."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


if __name__ == "__main__":
    main()
