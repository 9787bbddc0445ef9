"""Replaces the message of every diagnostic by its code: nothing may depend on its words.

`CARTWHEEL_CODES_ONLY=1 pytest` uses it in the tests' own process and, through PYTHONPATH, in all
programs that they start. Tests of wording have the mark `wording` and are left out there.
"""

import contextlib
import functools


def _install() -> None:
    from cartwheel import errors

    def coded(code, message):
        return message if code is errors.UNCLASSIFIED else str(code)

    make_diagnostic = errors.Diagnostic.__init__
    make_error = errors.CartwheelError.__init__

    @functools.wraps(make_diagnostic)
    def diagnostic(self, *, message, code=errors.UNCLASSIFIED, **others):
        make_diagnostic(self, message=coded(code, message), code=code, **others)

    @functools.wraps(make_error)
    def error(self, message, *, code=None, **others):
        make_error(self, coded(code or type(self).code, message), code=code, **others)

    errors.Diagnostic.__init__ = diagnostic
    errors.CartwheelError.__init__ = error


# Other programs' Python has no Cartwheel.
with contextlib.suppress(ImportError):
    _install()
