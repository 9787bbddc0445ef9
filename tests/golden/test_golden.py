"""The robots of this repository do what they did before; `python -m tests.golden` says more."""

import copy
import functools
import json

import pytest

from .comparing import differences
from .expected import FILE, brief, subjects
from .plain import output
from .subjects import Subject

EXPECTED = json.loads(FILE.read_text())
POSITION = 2e-3
"""m, rad and parts of a quaternion: contacts amplify the last digits, which differ by processor."""
FEW = 2
"""Messages on topics of contacts, which begin a step earlier or later."""


@functools.cache
def subjects_by_key() -> dict[str, Subject]:
    """Found by the first test, because the search expands all descriptions."""
    return {each.key: each for each in subjects()}


def test_the_same_robots_are_there():
    assert sorted(subjects_by_key()) == sorted(EXPECTED)


@pytest.mark.parametrize("key", EXPECTED)
def test_a_robot_does_what_it_did(key):
    now, before = brief(subjects_by_key()[key]), EXPECTED[key]
    for name in ("error", "services", "actions", "diagnostics", "refused", "faults"):
        assert now[name] == before[name], name
    for name in ("models", "joints"):
        assert list(now[name]) == list(before[name])
        for each, values in before[name].items():
            assert now[name][each] == pytest.approx(values, abs=POSITION), (name, each)
    assert list(now["counts"]) == list(before["counts"])
    for topic, count in before["counts"].items():
        assert abs(now["counts"][topic] - count) <= FEW, topic


def record(**more):
    number = {"decimal": [0.5], "hex": [(0.5).hex()]}
    subject = {"state": {"links": {"a": number}}, "diagnostics": [{"code": "CW204"}], **more}
    return {"subjects": {"cart": subject}}


def test_equal_records_have_no_differences():
    assert list(differences(record(), record())) == []


def test_a_number_that_differs_in_its_last_bit_is_a_difference():
    other = copy.deepcopy(record())
    other["subjects"]["cart"]["state"]["links"]["a"]["hex"] = ["0x1.0000000000001p-1"]
    ((key, kind, text),) = differences(record(), other)
    assert (key, kind) == ("cart", "state")
    assert text.startswith("links > a: differs by up to 1.11e-16:")


@pytest.mark.parametrize(
    ("change", "kind"),
    [
        ({"diagnostics": []}, "diagnostics"),
        ({"diagnostics": [{"code": "CW205"}]}, "diagnostics"),
        ({"topics": {"/odom": {"count": 5}}}, "topics"),
        ({"error": {"code": "CW100"}}, "error"),
    ],
)
def test_differences_are_named_by_kind(change, kind):
    found = list(differences(record(), record(**change)))
    assert [(key, name) for key, name, _ in found] == [("cart", kind)]


def test_a_subject_of_one_record_only_is_a_difference():
    empty = {"subjects": {}}
    assert [each[:2] for each in differences(record(), empty)] == [("cart", "subject")]


@pytest.mark.parametrize(
    ("one", "other", "live"),
    [
        ("1 passed in 9.95s", "1 passed in 12s", False),
        ("simulated 5.000 s in 0.5 s", "simulated 5.000 s in 1.25 s", False),
        ("cart  yes  695x  2", "cart yes 1.2e+03x 2", False),
        ("open http://localhost:8080", "open http://localhost:41231", False),
        ("min: 0.030s window: 10", "min: 0.031s window: 9", True),
        ("in /somewhere/a.urdf", "in <folder>/a.urdf", False),
    ],
)
def test_times_ports_and_folders_are_no_differences(one, other, live):
    places = {"/somewhere": "<folder>"}
    assert output(one, places, live=live) == output(other, places, live=live)


def test_other_numbers_are_differences():
    assert output("mass 7.2 kg", {}, live=False) != output("mass 7.3 kg", {}, live=False)
    assert output("state: on", {}, live=True) != output("state: off", {}, live=True)
