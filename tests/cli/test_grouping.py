"""Many warnings of one kind as one line."""

from dataclasses import replace

import pytest

from cartwheel.cli.commands.check import _alike
from cartwheel.cli.commands.grouping import grouped
from cartwheel.errors import Code, Diagnostic, Origin

MASS = Code("CW998", "odd-mass", "warning", "an odd mass")
NAME = Code("CW999", "odd-name", "warning", "an odd name")


def odd(link="a", line=0, *, code=MASS, file="/ws/a.urdf", severity=None, **values):
    origin = Origin(file=file, line=line) if line else None
    values = {"link": link, **values}
    message = f"link {link} is odd"
    return code.diagnostic(message, origin=origin, severity=severity, values=values)


def lines(*diagnostics):
    return [each.message for each in grouped(diagnostics)]


def test_findings_that_say_the_same_are_shown_together_whatever_the_words():
    def finding(line, **values):
        return odd(line=line, **values)

    one, other = finding(3, mass=1.0), replace(finding(5, mass=1.0), message="in other words")
    ((first, more),) = _alike([one, other])
    assert (first, more) == (one, [other])
    assert len(_alike([one, finding(5, mass=2.0)])) == 2


@pytest.mark.wording
def test_equal_ones_are_one_with_their_places():
    together = grouped([odd(line=line) for line in (3, 5, 8, 9, 12)])
    assert [str(each) for each in together] == [
        "/ws/a.urdf:3: warning: link a is odd (and 4 more: line 5, line 8, line 9, …)"
        " [CW998 odd-mass]"
    ]


@pytest.mark.wording
def test_places_in_other_files_have_their_names():
    together = lines(odd(line=3), odd(line=5, file="/ws/b.xacro"))
    assert together == ["link a is odd (and 1 more: b.xacro:5)"]


@pytest.mark.wording
def test_those_that_differ_in_names_and_numbers_are_one_from_three_on():
    many = [odd(name, n, mass=float(n)) for n, name in enumerate("abc", 1)]
    assert lines(*many[:2]) == ["link a is odd", "link b is odd"]
    assert lines(*many) == ['link a is odd (and 2 more: "b" line 2, "c" line 3)']


@pytest.mark.wording
def test_those_without_a_place_are_counted():
    assert lines(odd(), odd(), odd()) == ["link a is odd (and 2 more)"]
    whole = [
        replace(odd(), origin=Origin(file=f"/ws/{name}.urdf"))  # without a line
        for name in ("a", "a", "b")
    ]
    assert lines(*whole) == ["link a is odd (and 2 more: b.urdf)"]


def test_errors_come_first_then_the_order_of_files_and_lines():
    mixed = [
        odd("c", 9),
        odd("n", 1, severity="info"),
        odd("b", 2, code=NAME, file="/ws/b.urdf"),
        odd("a", 4, code=NAME),
        odd("e", 7, severity="error"),
    ]
    assert [each.values["link"] for each in grouped(mixed)] == ["e", "a", "c", "b", "n"]


def test_codes_severities_and_attributes_are_not_mixed():
    apart = [
        odd(),
        odd(code=NAME),
        odd(severity="error"),
        odd(attribute="effort"),
        odd(attribute="velocity"),
    ]
    assert len(grouped(apart)) == 5


def test_without_a_code_the_message_decides():
    made = [Diagnostic(severity="warning", message=text) for text in "xxyx"]
    assert len(grouped(made)) == 2
