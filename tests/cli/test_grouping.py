"""Many warnings of one kind as one line."""

from cartwheel.cli.commands.grouping import grouped
from cartwheel.errors import Diagnostic, Origin


def told(message, line=0, *, file="/ws/a.urdf", severity="warning"):
    origin = Origin(file=file, line=line) if line else None
    return Diagnostic(severity=severity, message=message, origin=origin)


def lines(*diagnostics):
    return [each.message for each in grouped(diagnostics)]


def test_equal_messages_are_one_with_their_places():
    found = grouped([told("x is odd", line) for line in (3, 5, 8, 9, 12)])
    assert [str(each) for each in found] == [
        "/ws/a.urdf:3: warning: x is odd. 4 more like it: :5, :8, :9, …"
    ]


def test_places_in_other_files_bear_their_names():
    found = lines(told("x is odd", 3), told("x is odd", 5, file="/ws/b.xacro"))
    assert found == ["x is odd. 1 more like it: b.xacro:5"]


def test_messages_that_differ_in_names_and_numbers_are_one_from_three_on():
    odd = [told(f'link "{name}" has the mass {n}', n) for n, name in enumerate("abc", 1)]
    assert lines(*odd[:2]) == ['link "a" has the mass 1', 'link "b" has the mass 2']
    assert lines(*odd) == ['link "a" has the mass 1. 2 more like it: "b" :2, "c" :3']


def test_where_something_was_searched_makes_no_difference():
    searched = [told(f'no "{n}". Searched: /{n}/x, /y', i) for i, n in enumerate("abc", 1)]
    assert lines(*searched) == ['no "a". Searched: /a/x, /y. 2 more like it: "b" :2, "c" :3']


def test_what_has_no_place_is_counted():
    assert lines(told("x"), told("x"), told("x")) == ["x. 2 more like it"]


def test_the_gravest_comes_first_and_all_else_keeps_its_order():
    mixed = [told("b", 1), told("n", severity="info"), told("a", 2), told("e", severity="error")]
    assert lines(*mixed) == ["e", "b", "a", "n"]


def test_severities_are_not_mixed():
    assert lines(told("x"), told("x", severity="error")) == ["x", "x"]
