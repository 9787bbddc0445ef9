"""Forms: the message that is made of values, and its bytes without the message."""

import random
from typing import Any

import numpy as np
import pytest
from tests.coded import raises
from tests.messages.cdr.test_cdr import bundled_types, grown

from cartwheel.codes.graph import MESSAGE_NOT_ENCODABLE
from cartwheel.errors import UnknownNameError
from cartwheel.messages import Form, encode_cdr, from_dict, header, message_class, zero
from cartwheel.messages.cdr.places import cdr_places
from cartwheel.messages.cdr.reading import has_wide_text
from cartwheel.messages.places import Place
from cartwheel.messages.ros1 import encode_ros1
from cartwheel.messages.ros1.types import ros1_store

ODOMETRY, JOINTS, TF = (
    "nav_msgs/msg/Odometry",
    "sensor_msgs/msg/JointState",
    "tf2_msgs/msg/TFMessage",
)


def value(place: Place, chance: random.Random) -> Any:
    """A value by chance for a number or an array."""
    one = {"?": [False, True], "f": [0.5, -2.0], "d": [0.1, -1e30]}.get(place.code, [0, 7])
    if place.count is None:
        return chance.choice(one)
    return np.array(chance.choices(one, k=place.count), dtype=np.dtype(place.code))


def test_the_bytes_are_those_of_the_message() -> None:
    known = ros1_store().fielddefs
    names = [name for name in bundled_types() if not has_wide_text(name)]
    for name in names:
        check_bytes(name, ros1=name in known)


def test_types_that_ros1_does_not_have_are_refused() -> None:
    known = ros1_store().fielddefs
    # To find the similar name in the error takes longer than all the rest.
    for name in [each for each in bundled_types() if each not in known][::40]:
        for _ in range(2):
            with pytest.raises(UnknownNameError):
                encode_ros1(zero(name), seq=5)
            with pytest.raises(UnknownNameError):
                Form(zero(name)).encode_ros1((), seq=5)


def check_bytes(name: str, *, ros1: bool) -> None:
    chance = random.Random(name)
    template = grown(name, chance)
    places = cdr_places(template)
    varying = chance.sample(places, chance.randint(0, len(places)))
    form = Form(template, *(place.path for place in varying))
    for _ in range(2):
        values = [value(place, chance) for place in varying]
        message = form.message(values)
        assert form.encode(values) == encode_cdr(message), name
        for place, given in zip(varying, values, strict=True):
            assert np.array_equal(at(message, place.path), given), (name, place.path)
        if not ros1:
            continue
        try:
            expected = encode_ros1(message, seq=5)
        except UnknownNameError:
            with pytest.raises(UnknownNameError):
                form.encode_ros1(values, seq=5)
        else:
            assert form.encode_ros1(values, seq=5) == expected, name


def at(message: Any, path: str) -> Any:
    for step in path.split("."):
        message = message[int(step)] if step.isdecimal() else getattr(message, step)
    return message


def odometry() -> Form:
    template = from_dict(ODOMETRY, {"header": {"frame_id": "odom"}, "child_frame_id": "base"})
    return Form(
        template, "header.stamp", "pose.pose.position", "pose.pose.orientation", "pose.covariance"
    )


def test_values_are_times_vectors_and_arrays() -> None:
    form, turned = odometry(), (0.1, 0.2, 0.3, 0.9)
    values = (12_000_000_034, (1.0, 2.0, 3.0), turned, np.arange(36.0))
    made = from_dict(
        ODOMETRY,
        {
            "header": {"stamp": {"sec": 12, "nanosec": 34}, "frame_id": "odom"},
            "child_frame_id": "base",
            "pose": {
                "pose": {
                    "position": {"x": 1.0, "y": 2.0, "z": 3.0},
                    "orientation": dict(zip("xyzw", turned, strict=True)),
                },
                "covariance": list(range(36)),
            },
        },
    )
    assert encode_cdr(form.message(values)) == encode_cdr(made)
    assert form.encode(values) == encode_cdr(made)
    assert form.encode_ros1(values, seq=1 << 32 | 9) == encode_ros1(made, seq=9)
    # Headers of the same time and frame are shared, as those of `header`.
    assert form.message(values).header is header(12_000_000_034, "odom")


def test_messages_of_a_list_with_a_common_time() -> None:
    stamped = {"header": {"frame_id": "base"}, "transform": {"rotation": {"w": 1.0}}}
    sent = [stamped | {"child_frame_id": name} for name in ("left", "right wheel")]
    form = Form(
        from_dict(TF, {"transforms": sent}),
        ("transforms.0.header.stamp", "transforms.1.header.stamp"),
        "transforms.1.transform.translation",
    )
    made = form.message((5, (1.0, 2.0, 3.0)))
    assert [each.header.stamp.nanosec for each in made.transforms] == [5, 5]
    assert made.transforms[0].header is made.transforms[1].header
    assert [each.child_frame_id for each in made.transforms] == ["left", "right wheel"]
    assert [each.transform.translation.x for each in made.transforms] == [0.0, 1.0]
    assert form.encode((5, (1.0, 2.0, 3.0))) == encode_cdr(made)
    assert form.encode_ros1((5, (1.0, 2.0, 3.0))) == encode_ros1(made)


def test_headers_of_two_times_in_turns_are_shared() -> None:
    """The transforms of wheels have other times than the other messages of their frame."""
    form = Form(message_class(JOINTS)(header(0, "wheel")), "header.stamp")
    one, other = form.message((7,)).header, form.message((8,)).header
    for _ in range(2):
        assert form.message((7,)).header is one is header(7, "wheel")
        assert form.message((8,)).header is other is header(8, "wheel")
    assert (one.stamp.nanosec, other.stamp.nanosec) == (7, 8)


def test_forms_with_the_same_texts_share_their_function() -> None:
    def made(frame: str, names: list[str] | None = None) -> Any:
        template = zero(TF if names is None else JOINTS)
        if names is None:
            template.transforms = [from_dict("geometry_msgs/msg/TransformStamped", {})]
            template.transforms[0].header.frame_id = frame
            return Form(template, "transforms.0.header.stamp", "transforms.0.transform.rotation")
        template.name = names
        return Form(template, "header.stamp")

    def fields(form: Form) -> Any:
        return form.message((7, (0.0, 0.0, 0.0, 1.0))).transforms[0]

    assert fields(made("odom")).header.frame_id == "odom"
    assert fields(made("map")).header.frame_id == "map"
    assert made("odom", ["a"]).message((7,)).name == ["a"]
    assert made("odom", ["b"]).message((7,)).name == ["b"]


@pytest.mark.parametrize(
    "values",
    [
        (0, (1.0, 2.0), (0.0, 0.0, 0.0, 1.0), np.zeros(36)),
        (0, (1.0, 2.0, 3.0), (0.0, 0.0, 1.0), np.zeros(36)),
        (0, (1.0, 2.0, "3"), (0.0, 0.0, 0.0, 1.0), np.zeros(36)),
        (0, (1.0, 2.0, 3.0), (0.0, 0.0, 0.0, 1.0), np.zeros(35)),
        (0, (1.0, 2.0, 3.0), (0.0, 0.0, 0.0, 1.0), [0.0] * 36),
        (1 << 80, (1.0, 2.0, 3.0), (0.0, 0.0, 0.0, 1.0), np.zeros(36)),
        (0, (1.0, 2.0, 3.0), (0.0, 0.0, 0.0, 1.0)),
    ],
)
def test_values_that_do_not_fit(values: tuple[Any, ...]) -> None:
    with raises(MESSAGE_NOT_ENCODABLE, type=ODOMETRY):
        odometry().encode(values)
    with raises(MESSAGE_NOT_ENCODABLE, type=ODOMETRY):
        odometry().encode_ros1(values)


_MISSING = ("header.time", "transforms.0", "pose.pose.position.w")
_NO_NUMBERS = ("child_frame_id", "header", "pose.pose")


@pytest.mark.parametrize("path", [*_MISSING, *_NO_NUMBERS])
def test_fields_that_do_not_exist_or_do_not_consist_of_numbers(path: str) -> None:
    for form in (Form(zero(ODOMETRY), path), Form(lambda: zero(ODOMETRY), path)):
        with pytest.raises(ValueError, match=path):
            form.message((1.0,))
        with pytest.raises(ValueError, match=path):
            form.cdr(1.0)


def test_an_array_keeps_its_length() -> None:
    form = Form(zero(JOINTS), "position")
    assert form.encode([np.zeros(0)]) == encode_cdr(zero(JOINTS))
    with raises(MESSAGE_NOT_ENCODABLE, type=JOINTS):
        form.encode([np.zeros(1)])


def test_empty_arrays_and_names_stay_those_of_the_template() -> None:
    template = message_class(JOINTS)(header(0, ""), ["a", "b"], np.zeros(2))
    form = Form(template, "header.stamp", "position")
    made = form.message((7, np.array([1.0, 2.0])))
    assert made.name is template.name
    assert (made.position.tolist(), made.velocity.size) == ([1.0, 2.0], 0)
    assert form.encode((7, made.position)) == encode_cdr(made)
