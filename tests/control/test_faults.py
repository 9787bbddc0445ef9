"""Diagnostics cross the control socket whole, and old releases are understood."""

import json

from cartwheel.codes.command import INTERNAL_FAULT, REQUEST_REFUSED
from cartwheel.codes.wires import PEER_LIMIT, SLOW_SUBSCRIBER
from cartwheel.control.faults import packed, refusal, refused, unpacked
from cartwheel.errors import UNCLASSIFIED, DescriptionError, Diagnostic, Origin

PLACE = Origin(file="/ws/a.xacro", line=3, stack=("b.xacro:1 wheel",))


def sent(value):
    return json.loads(json.dumps(value))


def test_a_diagnostic_crosses_whole():
    other = PEER_LIMIT.diagnostic("m", values={"most": 3})
    whole = Diagnostic(
        severity="info",
        message="m",
        code=SLOW_SUBSCRIBER,
        origin=PLACE,
        hint="h",
        values={"name": "x", "count": 1.5, "names": ("a", "b"), "sizes": (1.0, 2.0), "none": None},
        mark="name",
        instead="<a/>",
        place="element",
        also=(other,),
    )
    found = unpacked(sent(packed(whole)))
    assert found == whole
    assert found.code is SLOW_SUBSCRIBER
    assert found.values == whole.values
    assert found.also[0].values == other.values


def test_a_refusal_crosses_with_code_place_hint_and_values():
    error = DescriptionError(
        "m", code=PEER_LIMIT, origin=PLACE, hint="h", values={"name": "x"}, mark="name"
    )
    found = refused(sent(refusal(error)))
    assert found.diagnostic() == error.diagnostic()
    assert (found.code, found.values) == (PEER_LIMIT, {"name": "x"})
    assert refused(sent(refusal(ZeroDivisionError("x")))).code is INTERNAL_FAULT


def test_earlier_releases_and_later_ones_are_understood():
    # They read the text; of theirs, the text alone is known.
    assert refusal(DescriptionError("m", hint="h", origin=PLACE))["error"].startswith("/ws/a.xacro")
    assert refused({"error": "no"}).code is REQUEST_REFUSED
    old = unpacked({"severity": "warning", "message": "m", "file": "a.urdf", "line": 3})
    assert (old.code, old.origin) == (UNCLASSIFIED, Origin(file="a.urdf", line=3))
    later = unpacked({"severity": "error", "message": "m", "code": "CW899", "name": "new"})
    assert str(later.code) == "CW899 new"


def test_what_is_malformed_is_left_out():
    wrong = {"severity": [], "message": 3, "file": {}, "line": "x", "code": 7, "place": "up"}
    wrong |= {"values": {"a": {}, "b": [1, "c"], "d": [[]]}, "also": [3], "stack": "x"}
    found = unpacked(wrong)
    assert found == Diagnostic(severity="error", message="")
    assert found.values == {}
    assert unpacked({"file": "a", "line": -4, "values": []}).origin == Origin(file="a", line=0)


def test_numbers_of_any_size_are_no_fault():
    given = {"message": "m", "values": {"sizes": [10**400, 1], "name": "x"}}
    assert unpacked(sent(given)).values == {"name": "x"}
