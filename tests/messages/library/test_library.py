"""Message types from the packages of a workspace."""

import math
import os
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from tests.coded import raises
from tests.message_packages import MY_MSGS, NEITHER, ROS1, ROS2, write_package

from cartwheel.codes.graph import (
    FIELD_VALUE_INVALID,
    MESSAGE_DEFINITION_INVALID,
    MESSAGE_DEFINITIONS_DIFFER,
    MESSAGE_NOT_ENCODABLE,
    MESSAGE_TYPE_BUILT_IN,
    MESSAGE_TYPE_IN_USE,
    MESSAGE_TYPE_UNKNOWN,
)
from cartwheel.errors import Diagnostic, GraphError, UnknownNameError
from cartwheel.messages import decode_cdr, encode_cdr, from_dict, message_class, to_dict, zero
from cartwheel.messages.library.library import BUNDLED, TypeLibrary
from cartwheel.messages.ros1 import decode_ros1, encode_ros1, ros1_service, ros1_type
from cartwheel.messages.ros2.definitions import ros2_definition, ros2_hash
from cartwheel.messages.ros2.type_descriptions import type_description
from cartwheel.messages.ros2.types import ros2_service
from cartwheel.messages.store import finding_with, store


class Folders:
    """Packages in a folder, counting the searches."""

    def __init__(self, *roots: Path) -> None:
        self.roots = roots
        self.searched: list[str] = []

    def folders(self, package: str) -> Iterator[Path]:
        self.searched.append(package)
        yield from (root / package for root in self.roots if (root / package).is_dir())

    def may_read(self, path: Path, folder: Path) -> bool:
        return path.resolve().is_relative_to(folder.resolve())


@pytest.fixture
def package(request: pytest.FixtureRequest) -> str:
    """A package name that no other test uses, because a name has one meaning per process."""
    return f"p{abs(hash(request.node.nodeid)):x}_msgs"


def library(*roots: Path) -> tuple[TypeLibrary, list[Diagnostic]]:
    reported: list[Diagnostic] = []
    return TypeLibrary(Folders(*roots), reported.append), reported


def one(tmp_path: Path, package: str, text: str | bytes, manifest: str = ROS2) -> TypeLibrary:
    write_package(tmp_path / package, {"msg/One.msg": text}, manifest=manifest)
    return library(tmp_path)[0]


def test_a_type_with_nested_types_is_found_when_it_is_named(tmp_path: Path, package: str) -> None:
    write_package(tmp_path / package, MY_MSGS)
    types, reported = library(tmp_path)
    assert types.find(f"{package}/msg/WheelLoads")
    made = from_dict(f"{package}/msg/WheelLoads", {"wheels": [{"side": 1, "load": 2.5}]})
    again = decode_cdr(encode_cdr(made), f"{package}/msg/WheelLoads")
    assert to_dict(again) == to_dict(made)
    assert message_class(f"{package}/msg/Wheel").RIGHT == 1
    assert message_class(f"{package}/msg/Wheel").UNIT == "newton"
    assert not reported


def test_nothing_is_searched_for_cartwheels_own_types(tmp_path: Path) -> None:
    folders = Folders(tmp_path)
    types = TypeLibrary(folders)
    for name in ("sensor_msgs/msg/Image", "gazebo_msgs/srv/SpawnModel"):
        types.note(name)
    assert folders.searched == []


def test_the_packages_without_a_search_are_those_that_cartwheel_contains() -> None:
    contained = {name.partition("/")[0] for name in store().fielddefs}
    assert contained >= BUNDLED


def test_a_missing_type_is_searched_once(tmp_path: Path) -> None:
    folders = Folders(tmp_path)
    types = TypeLibrary(folders)
    assert not types.find("absent_msgs/msg/One")
    assert not types.find("absent_msgs/msg/One")
    assert folders.searched == ["absent_msgs"]
    types.forget_missing()
    assert not types.find("absent_msgs/msg/One")
    assert folders.searched == ["absent_msgs"] * 2


def test_message_class_finds_types_only_in_the_own_simulation(tmp_path: Path, package: str) -> None:
    types = one(tmp_path, package, "int8 x\n")
    with raises(MESSAGE_TYPE_UNKNOWN, UnknownNameError):
        message_class(f"{package}/One")
    with finding_with(types):
        assert message_class(f"{package}/One")(x=3).x == 3


def test_another_simulation_does_not_see_the_type(tmp_path: Path, package: str) -> None:
    types = one(tmp_path, package, "int8 x\n")
    assert types.find(f"{package}/msg/One")
    assert not TypeLibrary(Folders()).find(f"{package}/msg/One")


def test_other_fields_of_the_same_name_in_one_process_are_an_error(
    tmp_path: Path, package: str
) -> None:
    assert one(tmp_path / "a", package, "int8 x\n").find(f"{package}/msg/One")
    assert one(tmp_path / "b", package, "int8 x # equal\n").find(f"{package}/msg/One")
    with raises(MESSAGE_TYPE_IN_USE, GraphError) as caught:
        one(tmp_path / "c", package, "int16 x\n").find(f"{package}/msg/One")
    assert caught.value.values["other"] == str(tmp_path / "a" / package / "msg/One.msg")


# -- ROS 1


def test_md5_sums_and_definitions_are_those_of_genmsg(tmp_path: Path) -> None:
    # The md5 sums are those of genmsg 0.6 for these files.
    write_package(tmp_path / "md5_msgs", MY_MSGS, manifest=ROS1)
    types, _ = library(tmp_path)
    types.find("md5_msgs/msg/WheelLoads")
    types.find("md5_msgs/srv/Calibrate")
    types.find("md5_msgs/action/Dock")
    known = ros1_type("md5_msgs/WheelLoads")
    assert known.name == "md5_msgs/WheelLoads"
    assert known.md5 == "0b24b21d6403bfab16631035cb454641"
    assert known.definition.startswith(MY_MSGS["msg/WheelLoads.msg"])
    assert f"MSG: md5_msgs/Wheel\n{MY_MSGS['msg/Wheel.msg']}" in known.definition
    assert ros1_service("md5_msgs/Calibrate").md5 == "c479eeb89589bbe7170f8f6083ccd090"
    assert ros1_type("md5_msgs/DockActionGoal").md5 == "a64068b2e17e1800954fe4e25b4ce104"


def test_the_dialect_of_ros1(tmp_path: Path, package: str) -> None:
    types = one(
        tmp_path,
        package,
        "string NOTE=  a # no comment\nint8 A=-1#one\nHeader header\ntime t\nduration[2] d\n"
        "byte b\nchar c\nfloat32[] Values\n",
        ROS1,
    )
    types.find(f"{package}/msg/One")
    made = from_dict(f"{package}/One", {"b": -1, "c": 200, "Values": [1.5], "t": {"secs": 3}})
    assert type(made).NOTE == "a # no comment"
    assert type(made).A == -1
    data = encode_ros1(made, seq=7)
    again = decode_ros1(data, f"{package}/One")
    assert to_dict(again) == to_dict(made)
    # seq, stamp, frame, t, d, b, c, values
    assert len(data) == 4 + 8 + 4 + 8 + 16 + 1 + 1 + 4 + 4
    assert "time t\n" in ros1_type(f"{package}/One").definition
    text = ros2_definition(f"{package}/One")
    assert text.startswith('string NOTE="a # no comment"\nint8 A=-1\nstd_msgs/Header header\n')
    assert "builtin_interfaces/Time t\nbuiltin_interfaces/Duration[2] d\nbyte b\n" in text
    assert decode_cdr(encode_cdr(made), f"{package}/One").b == -1


def test_bounds_do_not_exist_in_ros1_but_the_type_does(tmp_path: Path, package: str) -> None:
    types = one(
        tmp_path, package, 'string<=5 text "abc"\nint8[<=3] xs\nbuiltin_interfaces/Time t\n'
    )
    types.find(f"{package}/msg/One")
    assert ros1_type(f"{package}/One").definition == "string text\nint8[] xs\ntime t\n"
    made = zero(f"{package}/One")
    assert decode_ros1(encode_ros1(made), f"{package}/One").text == "abc"


def test_wide_strings_do_not_exist_in_ros1(tmp_path: Path, package: str) -> None:
    one(tmp_path, package, "wstring text\n").find(f"{package}/msg/One")
    with raises(MESSAGE_TYPE_UNKNOWN, UnknownNameError):
        ros1_type(f"{package}/One")


# -- ROS 2


def test_defaults_fill_omitted_fields(tmp_path: Path, package: str) -> None:
    types = one(
        tmp_path,
        package,
        "float64 a -1.5\nstring b 'it''s' # c\nint32[3] c [1, 2, 0x10]\nstring[] d [\"#\", 'y']\n"
        'bool e true\nstring f "a # b"\n'.replace("'it''s'", "'its'"),
    )
    types.find(f"{package}/msg/One")
    made = zero(f"{package}/One")
    assert to_dict(made) == {
        "a": -1.5, "b": "its", "c": [1, 2, 16], "d": ["#", "y"], "e": True, "f": "a # b"
    }  # fmt: skip
    described = type_description(f"{package}/msg/One").type_description.fields
    assert [field.default_value for field in described][:2] == ["-1.5", "'its'"]
    # Each message has its own list.
    made.d.append("z")
    assert zero(f"{package}/One").d == ["#", "y"]


def test_bounds_are_checked(tmp_path: Path, package: str) -> None:
    one(tmp_path, package, "string<=3 text\nint8[<=2] xs\nstring<=2[<=2] texts\n").find(
        f"{package}/msg/One"
    )
    name = f"{package}/One"
    for field, value in (("text", "abcd"), ("xs", [1, 2, 3]), ("texts", ["abc"])):
        with raises(FIELD_VALUE_INVALID, GraphError):
            from_dict(name, {field: value})
    made = zero(name)
    made.xs = np.zeros(3, np.int8)
    with raises(MESSAGE_NOT_ENCODABLE, GraphError):
        encode_cdr(made)


def test_wide_strings_have_four_bytes_per_unit(tmp_path: Path, package: str) -> None:
    one(tmp_path, package, "uint8 n\nwstring text\nwstring[] more\nuint8 m\n").find(
        f"{package}/msg/One"
    )
    made = from_dict(f"{package}/One", {"n": 1, "text": "aü😀", "more": ["", "b"], "m": 2})
    data = encode_cdr(made)
    assert data[:8] == b"\0\1\0\0\1\0\0\0"
    assert data[8:12] == b"\4\0\0\0"
    assert data[12:20] == b"a\0\0\0\xfc\0\0\0"
    assert to_dict(decode_cdr(data, f"{package}/One")) == to_dict(made)
    for size in range(len(data)):
        with pytest.raises(GraphError):
            decode_cdr(data[:size], f"{package}/One")


def test_hashes_are_those_of_rosidl(tmp_path: Path) -> None:
    """A copy of a type with a known hash has this hash, apart from its name."""
    import hashlib
    import json

    write_package(
        tmp_path / "hash_msgs", {"msg/One.msg": "byte[<=3] b\nwstring<=5 w\nstring<=4[2] s 	\n"}
    )
    library(tmp_path)[0].find("hash_msgs/msg/One")

    def field(name: str, number: int, capacity: int, longest: int) -> object:
        # Numbers from FieldType.msg: BYTE 16, BOUNDED_WSTRING 22, BOUNDED_STRING 21.
        return {
            "name": name,
            "type": {
                "type_id": number,
                "capacity": capacity,
                "string_capacity": longest,
                "nested_type_name": "",
            },
        }

    whole = {
        "type_description": {
            "type_name": "hash_msgs/msg/One",
            "fields": [field("b", 16 + 96, 3, 0), field("w", 22, 0, 5), field("s", 21 + 48, 2, 4)],
        },
        "referenced_type_descriptions": [],
    }
    expected = hashlib.sha256(json.dumps(whole).encode()).hexdigest()
    assert ros2_hash("hash_msgs/One") == f"RIHS01_{expected}"


def test_services_and_actions_have_hashes(tmp_path: Path, package: str) -> None:
    write_package(tmp_path / package, MY_MSGS)
    types, _ = library(tmp_path)
    assert types.find(f"{package}/srv/Calibrate")
    assert types.find(f"{package}/action/Dock")
    assert ros2_service(f"{package}/srv/Calibrate").hash.startswith("RIHS01_")
    assert ros2_service(f"{package}/action/Dock_SendGoal").hash.startswith("RIHS01_")
    assert zero(f"{package}/action/Dock_FeedbackMessage").feedback.distance == 0
    assert zero(f"{package}/DockActionResult").result.docked is False


def test_fields_may_have_the_names_of_python_keywords(tmp_path: Path, package: str) -> None:
    one(tmp_path, package, "bool from\nint8 lambda\nwstring is\n").find(f"{package}/msg/One")
    made = from_dict(f"{package}/One", {"from": True, "lambda": 3, "is": "a"})
    assert to_dict(decode_cdr(encode_cdr(made), f"{package}/One")) == {
        "from": True, "lambda": 3, "is": "a"
    }  # fmt: skip


def test_constants_cannot_inject_code(tmp_path: Path, package: str) -> None:
    text = "string A=x'''\\n\"\"\"+__import__('os')\nfloat32 B=inf\nfloat64 C=nan\nint8 x\n"
    one(tmp_path, package, text, NEITHER).find(f"{package}/msg/One")
    made = message_class(f"{package}/One")
    assert made.A.startswith("x'''")
    assert math.isinf(made.B)
    assert math.isnan(made.C)


# -- which definition is used


def test_a_built_in_type_wins_with_a_warning(tmp_path: Path) -> None:
    write_package(
        tmp_path / "geometry_msgs",
        {
            "msg/Point.msg": "float64 x\nfloat64 y\n",
            "msg/Quaternion.msg": "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n",
        },
    )
    types, reported = library(tmp_path)
    types.named("geometry_msgs/msg/Quaternion")
    assert not reported
    types.named("geometry_msgs/msg/Point")
    types.named("geometry_msgs/msg/Point")
    (warning,) = reported
    assert warning.code is MESSAGE_TYPE_BUILT_IN
    assert warning.origin is not None
    assert warning.origin.file == str(tmp_path / "geometry_msgs/msg/Point.msg")
    assert zero("geometry_msgs/msg/Point").z == 0


def test_types_of_ros1_with_the_same_fields_are_equal_to_the_built_in_ones(tmp_path: Path) -> None:
    write_package(
        tmp_path / "std_msgs",
        {
            "msg/Header.msg": "uint32 seq\ntime stamp\nstring frame_id\n",
            "msg/Byte.msg": "byte data",
        },
        manifest=ROS1,
    )
    types, reported = library(tmp_path)
    types.named("std_msgs/msg/Header")
    types.named("std_msgs/msg/Byte")
    assert not reported


def test_a_package_that_cartwheel_contains_may_have_more_types(tmp_path: Path) -> None:
    write_package(tmp_path / "sensor_msgs", {"msg/TyrePressure.msg": "float64 pressure\n"})
    types, reported = library(tmp_path)
    types.named("sensor_msgs/msg/TyrePressure")
    assert zero("sensor_msgs/TyrePressure").pressure == 0
    assert not reported


def test_the_first_package_wins_and_the_other_is_reported(tmp_path: Path, package: str) -> None:
    for root, text in (("a", "int8 x\n"), ("b", "int8 x\n# equal\n"), ("c", "int16 x\n")):
        write_package(tmp_path / root / package, {"msg/One.msg": text})
    types, reported = library(tmp_path / "a", tmp_path / "b", tmp_path / "c")
    assert types.find(f"{package}/msg/One")
    (warning,) = reported
    assert warning.code is MESSAGE_DEFINITIONS_DIFFER
    assert warning.values["other"] == str(tmp_path / "c" / package / "msg/One.msg")


# -- malformed files


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("int8 x\nnonsense\n", 2),
        ("int8\n", 1),
        ("int8 x\n\n# c\nint8 x\n", 4),
        ("int8 9x\n", 1),
        ("int8 A=128\n", 1),
        ("int8 A=one\n", 1),
        ("uint8 a -1\n", 1),
        ("int8[2] a [1]\n", 1),
        ("int8[] a 1\n", 1),
        ("string<=2 a 'abc'\n", 1),
        ("int8<=2 a\n", 1),
        ("int8[0] a\n", 1),
        ("int8[99999999999] a\n", 1),
        ("int8[1000000000] a\n", 1),
        ("string[10001] a\n", 1),
        ("int8 x\nNothing there\n", 2),
        ("nowhere_msgs/Nothing there\n", 1),
        ("../../etc/passwd x\n", 1),
        ("One x\n", 1),
        ("int8 a\nOne[] x\n", 2),
        ("time t\n", 1),
        ("int8 __msgtype__\n", 1),
        ("int8 [] x\n", 1),
        (b"int8 x\n# \xff\n", 2),
        (b"int8 \0x\n", 1),
        ("int8[16000000] a\nint8[16000000] b\nint8[16000000] c\n", 1),
        ("".join(f"int8 x{number}\n" for number in range(2002)), 2001),
        ("x" * 100_000, 1),
    ],
)
def test_a_malformed_definition_has_a_file_and_a_line(
    tmp_path: Path, package: str, text: str | bytes, line: int
) -> None:
    types = one(tmp_path, package, text)
    with raises(MESSAGE_DEFINITION_INVALID, GraphError) as caught:
        types.find(f"{package}/msg/One")
    assert caught.value.origin is not None
    assert caught.value.origin.file == str(tmp_path / package / "msg/One.msg")
    assert caught.value.origin.line == line


def test_bounds_with_time_of_ros1_are_an_error(tmp_path: Path, package: str) -> None:
    types = one(tmp_path, package, "string<=3 a\n\ntime t\n", NEITHER)
    with raises(MESSAGE_DEFINITION_INVALID, GraphError) as caught:
        types.find(f"{package}/msg/One")
    assert caught.value.origin is not None
    assert caught.value.origin.line == 3


def test_the_lines_of_services_count_from_the_start_of_the_file(
    tmp_path: Path, package: str
) -> None:
    write_package(
        tmp_path / package,
        {"srv/One.srv": "int8 a\n---\nint8 b\nwrong\n", "srv/Two.srv": "int8 a\n"},
    )
    types, _ = library(tmp_path)
    with raises(MESSAGE_DEFINITION_INVALID, GraphError) as caught:
        types.find(f"{package}/srv/One")
    assert caught.value.origin is not None
    assert caught.value.origin.line == 4
    with raises(MESSAGE_DEFINITION_INVALID, GraphError):
        types.find(f"{package}/srv/Two")


def test_cycles_over_several_types_are_an_error(tmp_path: Path, package: str) -> None:
    write_package(
        tmp_path / package,
        {"msg/One.msg": "Two x\n", "msg/Two.msg": "\nThree[] x\n", "msg/Three.msg": "One x\n"},
    )
    types, _ = library(tmp_path)
    with raises(MESSAGE_DEFINITION_INVALID, GraphError) as caught:
        types.find(f"{package}/msg/One")
    assert caught.value.values["field"] == "x"


@pytest.mark.parametrize("kind", ["exponential", "deep", "wide", "long chain"])
def test_large_types_are_refused_quickly(tmp_path: Path, package: str, kind: str) -> None:
    field, count = {
        "exponential": ("T{} a\nT{} b\nT{} c\n", 40),
        "deep": ("T{} a\n", 200),
        "wide": ("T{}[1000] a\n", 3),
        "long chain": ("T{}[] a\n", 400),
    }[kind]
    files = {f"msg/T{number}.msg": field.replace("{}", str(number + 1)) for number in range(count)}
    write_package(tmp_path / package, {**files, f"msg/T{count}.msg": "int8 x\n"})
    types, _ = library(tmp_path)
    start = time.process_time()
    with raises(MESSAGE_DEFINITION_INVALID, GraphError):
        types.find(f"{package}/msg/T0")
    assert time.process_time() - start < 5


def test_large_files_are_refused(tmp_path: Path, package: str) -> None:
    types = one(tmp_path, package, "int8 x\n" + "#" * (10 << 20))
    with raises(MESSAGE_DEFINITION_INVALID, GraphError) as caught:
        types.find(f"{package}/msg/One")
    assert caught.value.values["bytes"] < 2 << 20


@pytest.mark.parametrize(
    "text",
    [
        'string a "' + '\\"' * 200_000,
        "string a " + "'\"" * 200_000,
        "string[] a [" + "'x'," * 100_000,
        "int8 x " + " " * 900_000,
    ],
)
def test_long_lines_are_read_in_linear_time(tmp_path: Path, package: str, text: str) -> None:
    types = one(tmp_path, package, text)
    start = time.process_time()
    with pytest.raises(GraphError) if "string[]" in text else _nothing():
        types.find(f"{package}/msg/One")
    assert time.process_time() - start < 5


def _nothing() -> object:
    import contextlib

    return contextlib.nullcontext()


def test_links_out_of_the_package_are_refused(tmp_path: Path, package: str) -> None:
    (tmp_path / "secret.msg").write_text("int8 x\n")
    write_package(tmp_path / package, {"msg/Two.msg": "int8 x\n"})
    (tmp_path / package / "msg/One.msg").symlink_to(tmp_path / "secret.msg")
    (tmp_path / package / "msg/Three.msg").symlink_to("Two.msg")
    (tmp_path / package / "msg/Four.msg").symlink_to("Four.msg")
    types, _ = library(tmp_path)
    for name in ("One", "Four"):
        with raises(MESSAGE_DEFINITION_INVALID, GraphError):
            types.find(f"{package}/msg/{name}")
    assert types.find(f"{package}/msg/Three")


def test_pipes_and_folders_are_refused(tmp_path: Path, package: str) -> None:
    write_package(tmp_path / package, {"msg/Two.msg": "int8 x\n"})
    os.mkfifo(tmp_path / package / "msg/One.msg")
    (tmp_path / package / "msg/Folder.msg").mkdir()
    types, _ = library(tmp_path)
    for name in ("One", "Folder"):
        with raises(MESSAGE_DEFINITION_INVALID, GraphError):
            types.find(f"{package}/msg/{name}")
