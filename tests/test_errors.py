"""The errors that a user sees."""

import ast
import difflib
import importlib
import pickle
import random
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

import cartwheel
from cartwheel import similar_names
from cartwheel.codes.wires import PEER_LIMIT
from cartwheel.codes.wires import SLOW_SUBSCRIBER as SLOW
from cartwheel.errors import (
    DescriptionError,
    Diagnostic,
    Origin,
    TimedOutError,
    UnknownNameError,
)
from cartwheel.messages import store
from cartwheel.reporting import Once, Reporter
from cartwheel.similar_names import meant_one

PLACE = Origin(file="a.urdf", line=3)


def warning(name):
    return SLOW.diagnostic(f"{name} reads slowly", values={"name": name})


def test_a_name_of_megabytes_is_cut_and_compared_with_nothing(monkeypatch):
    compared = []
    find = similar_names.most_similar

    def count(word, *given, **options):
        compared.append(len(word))
        return find(word, *given, **options)

    monkeypatch.setattr(similar_names, "most_similar", count)
    error = UnknownNameError("model", "robot" * 1_000_000, ["robot", "post"])
    assert error.values["kind"] == "model"
    assert str(error.values["name"]).startswith("robotrobot")
    assert len(str(error.values["name"])) < 600
    assert len(str(error)) < 1000
    assert error.values["meant"] == ""
    assert meant_one("robot" * 1_000_000, ["robot"], cutoff=0.0) == ""
    assert UnknownNameError("model", "robott", ["robot"]).values["meant"] == "robot"
    assert compared == [len("robott")]


def test_the_most_similar_name_is_that_of_difflib():
    names = [*sorted(store().types)[::5], "", "a", "A", "odom", "odom2", "odometry"]
    asked = ["geometry_msgs/msg/Twst", "gazebo_msgs/Twist", "odo", "odom1", "msg", "", "a", "xyz"]
    for cutoff in (0.0, 0.5, 0.6, 0.75, 1.0):
        for name in (*asked, *random.Random(1).sample(names, 8)):
            (expected,) = difflib.get_close_matches(name, names, 1, cutoff) or (None,)
            assert similar_names.most_similar(name, names, cutoff) == expected, (name, cutoff)


@pytest.mark.wording
def test_an_unknown_name_is_shown_with_those_that_exist():
    error = UnknownNameError("model", "box", ["robot", "post"])
    assert str(error) == 'model "box" does not exist\n  Valid names: post, robot.'
    near = UnknownNameError("model", "robott", ["robot", "post"])
    assert str(near) == 'model "robott" does not exist\n  Did you mean "robot"?'


def test_a_flood_of_warnings_is_shown_at_a_bounded_rate_and_counted(monkeypatch):
    now = [0.0]
    monkeypatch.setattr("time.monotonic_ns", lambda: int(now[0] * 1e9))
    once = Once(5)

    def shown(name):
        diagnostic = once(warning(name))
        return diagnostic and (diagnostic.values["name"], diagnostic.values.get("left_out", 0))

    assert shown("a") == ("a", 0)
    assert shown("a") is None
    flood = [shown(f"name {number}") for number in range(100)]
    assert flood == [*((f"name {number}", 0) for number in range(4)), *[None] * 96]
    now[0] += Once.PAUSE
    assert shown("important") == ("important", 96)
    assert shown("b") is None
    now[0] += 3 * Once.PAUSE
    assert shown("c") == ("c", 1)
    assert shown("d") == ("d", 0)


@pytest.mark.wording
def test_the_last_warning_before_the_bounded_rate_says_so():
    once = Once(1)
    assert str(once(warning("a")).message) == (
        "a reads slowly (from now on, at most one such warning is shown every 10 s)"
    )


def test_warnings_are_the_same_if_code_place_and_values_are():
    once = Once(50)
    first = warning("a")
    assert once(first) is first
    assert once(replace(first, message="in other words")) is None
    assert once(warning("b")) is not None
    assert once(SLOW.diagnostic("a reads slowly", values={"name": "a"}, origin=PLACE)) is not None
    assert once(PEER_LIMIT.diagnostic("a reads slowly", values={"name": "a"})) is not None
    text = Diagnostic(severity="warning", message="without a code")
    assert once(text) is text
    assert once(text) is None
    assert once(replace(text, message="another without a code")) is not None


def test_a_reporter_reports_each_once():
    shown = []
    report = Reporter(shown.append, 50, title="ROS")
    for name in ("a", "a", "b"):
        report(warning(name))
    assert [each.values["name"] for each in shown] == ["a", "b"]
    report.always(warning("a"))
    assert shown[-1] == shown[0]


@pytest.mark.wording
def test_a_reporter_puts_its_title_in_front():
    shown = []
    Reporter(shown.append, 50, title="ROS")(warning("a"))
    assert shown[0].message == "ROS: a reads slowly"


def test_values_in_any_order_are_the_same():
    one = SLOW.diagnostic("m", values={"name": "x", "most": 3})
    other = SLOW.diagnostic("m", values={"most": 3, "name": "x"})
    assert one.sorted_values == other.sorted_values == (("most", 3), ("name", "x"))
    assert one.identity == other.identity


def test_a_cause_without_a_place_gets_that_of_its_element():
    cause = DescriptionError("m", code=PEER_LIMIT, mark="name")
    made = SLOW.because("it failed", cause, origin=PLACE)
    assert (made.origin, made.mark) == (PLACE, "name")
    own = Origin(file="b.urdf")
    placed = DescriptionError("m", code=PEER_LIMIT, origin=own)
    assert SLOW.because("it failed", placed, origin=PLACE).origin == own
    assert SLOW.because("it failed", KeyError("x"), origin=PLACE).origin == PLACE


def test_what_an_error_caused_keeps_its_hint_values_and_code():
    cause = DescriptionError(
        "m", code=PEER_LIMIT, hint="Do it.", values={"name": "x"}, origin=PLACE
    )
    made = SLOW.because("it failed", cause, values={"topic": "/t"})
    assert (made.code, made.hint, made.origin) == (SLOW, cause.hint, PLACE)
    assert made.values == {"name": "x", "topic": "/t", "cause": PEER_LIMIT.number}
    other = SLOW.because("it failed", KeyError("x"))
    assert other.values == {"cause": "KeyError: 'x'"}
    assert SLOW.because("it failed", KeyError("y")).values != other.values


@pytest.mark.wording
def test_logs_have_message_hint_and_code_in_one_line():
    diagnostic = SLOW.diagnostic("it is slow", hint="Wait.", origin=PLACE)
    assert diagnostic.text == f"it is slow. Wait. [{SLOW.number}]"
    assert Diagnostic(severity="info", message="m").text == "m"


def test_a_topic_is_suggested_by_its_last_parts():
    known = ["/a/b/odom", "/base/odom", "/odometry/filtered", "/clock"]
    assert UnknownNameError("topic", "/odom", known).values["meant"] == "/base/odom"
    assert UnknownNameError("topic", "b/odom", known).values["meant"] == "/a/b/odom"
    assert UnknownNameError("topic", "/clack", known).values["meant"] == "/clock"
    assert UnknownNameError("topic", "/", known).values["meant"] == ""


def exception_classes() -> Iterator[tuple[str, str]]:
    """Module and name of each exception class of Cartwheel."""
    root = Path(cartwheel.__file__).parent
    for file in sorted(root.rglob("*.py")):
        for node in ast.parse(file.read_text()).body:
            if isinstance(node, ast.ClassDef) and any(
                ast.unparse(base).endswith(("Error", "Exception", "Pickled")) for base in node.bases
            ):
                yield ".".join(file.relative_to(root.parent).with_suffix("").parts), node.name


def test_a_topic_is_suggested_by_a_similar_last_part():
    topics = ["/part2/base_cmr/cmd_vel", "/part2_cmr/cmd_vel", "/part2_cmr/odom", "/clock"]
    found = [UnknownNameError("topic", name, topics).values["meant"] for name in
             ("/cmd_vl", "/odm", "/dock", "/x/cmd_velo", "cmd_vl")]  # fmt: skip
    assert found == ["/part2_cmr/cmd_vel", "/part2_cmr/odom", "/clock", "/part2_cmr/cmd_vel", ""]


def test_an_exception_reaches_another_process_with_all_attributes():
    classes = [
        getattr(importlib.import_module(module), name) for module, name in exception_classes()
    ]
    assert len(classes) > 40
    wrong = [kind for kind in classes if not is_copied(kind)]
    assert not wrong


def is_copied(kind: type[Exception]) -> bool:
    # Their constructors differ, and none may be needed.
    error = kind.__new__(kind, "words")
    error.args = ("words",)
    error.__dict__.update(message="words", origin=PLACE, hint=None, values={"name": 3}, mark="")
    error.__dict__.update(code=PEER_LIMIT, more=(1.0, "two"))
    error.add_note("a note")
    copy = pickle.loads(pickle.dumps(error))
    # A constructor may have been called, and may have set more.
    attributes = {**vars(copy), **vars(error)}
    return type(copy) is kind and copy.args == error.args and attributes == vars(copy)


def test_an_error_reaches_another_process_as_it_was_raised():
    for error in (
        DescriptionError("m", code=PEER_LIMIT, origin=PLACE, hint="h", values={"a": 1}, mark="x"),
        UnknownNameError("model", "robott", ["robot"]),
        TimedOutError("m", values={"timeout": 3.0}),
    ):
        copy = pickle.loads(pickle.dumps(error))
        assert (type(copy), str(copy), vars(copy)) == (type(error), str(error), vars(error))
