"""Replaces the text of every diagnostic by its code: nothing may depend on its words.

The message becomes the code's number, and the hint a single word. `CARTWHEEL_CODES_ONLY=1 pytest`
uses it in the tests' own process and, through PYTHONPATH, in all programs that they start. Tests of
wording have the mark `wording` and are left out there.
"""

import contextlib
import functools


def _install() -> None:
    from cartwheel import errors

    def coded(code, message):
        return message if code is errors.UNCLASSIFIED else code.number

    def worded(hint):
        return hint and "hint"

    make_diagnostic = errors.Diagnostic.__init__
    make_error = errors.CartwheelError.__init__

    @functools.wraps(make_diagnostic)
    def diagnostic(self, *, message, code=errors.UNCLASSIFIED, hint="", **others):
        make_diagnostic(self, message=coded(code, message), code=code, hint=worded(hint), **others)

    @functools.wraps(make_error)
    def error(self, message, *, code=None, hint=None, **others):
        text = coded(code or type(self).code, message)
        make_error(self, text, code=code, hint=worded(hint), **others)

    errors.Diagnostic.__init__ = diagnostic
    errors.CartwheelError.__init__ = error


def install_services() -> None:
    """Replaces the notes of answers. Only for the tests' own process: it imports much."""
    from cartwheel.gazebo import requests

    make_answer = requests.Answer.__init__

    @functools.wraps(make_answer)
    def answer(self, status="", fields=None, notes=()):
        make_answer(self, status, fields or {}, tuple("note" for _ in notes))

    requests.Answer.__init__ = answer


# Other programs' Python has no Cartwheel.
with contextlib.suppress(ImportError):
    _install()
