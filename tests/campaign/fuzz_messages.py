"""Definitions of message types: files of a package, in the dialects of ROS 1 and ROS 2."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from tests.campaign import mutating
from tests.campaign.target import Target

from cartwheel.errors import CartwheelError

_MESSAGES = [
    b'# comment\nuint8 LEFT=0\nstring NAME="a # b" # c\nstd_msgs/Header header\nOther[3] o\n'
    b"geometry_msgs/Pose[] poses\nfloat64 load 1.5\nstring<=8[<=3] names [\"a\", 'b']\nwstring w\n",
    b"Header header\nstring S=  free text # here\nbyte B=-1\ntime t\nduration[2] d\nchar[4] c\n",
    b"int32[<=3] a [1, -2, 0x10]\nbool b true\nfloat32 c nan\nint64 d 9223372036854775807\n",
    b"Fuzz[] again\nfuzz_msgs/msg/Other other\nmissing_msgs/Type x\n",
    b"int8[1000] a\nOther[9999] b\nfloat32 I=inf\nbool from\n",
]
_SERVICES = [b"Other a\nfloat64 b 2.0\n---\nbool ok\nstring message\n", b"---\n", b"a\n---\n---\n"]
_ACTIONS = [b"Other a\n---\nbool ok\n---\nfloat32 distance\n", b"---\n---\n"]


class _Packages:
    """The package with the file."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def folders(self, package: str) -> list[Path]:
        return [self._folder] if package == self._folder.name else []

    def may_read(self, path: Path, folder: Path) -> bool:
        return path.resolve().is_relative_to(folder.resolve())


def _reader(kind: str) -> Callable[[bytes], None]:
    folder = Path("fuzz_msgs")
    full = f"fuzz_msgs/{kind}/Fuzz"

    def run_one(data: bytes) -> None:
        from cartwheel.messages import decode_cdr, encode_cdr, zero
        from cartwheel.messages.learnt import learnt, parts_of
        from cartwheel.messages.library.library import TypeLibrary
        from cartwheel.messages.ros2.definitions import ros2_definition

        for each in ("msg", kind):
            (folder / each).mkdir(parents=True, exist_ok=True)
        (folder / "msg" / "Other.msg").write_text("uint8 a\nstring<=4 b 'x'\n")
        (folder / kind / f"Fuzz.{kind}").write_bytes(data)
        try:
            if TypeLibrary(_Packages(folder.resolve())).find(full):
                for part in parts_of(full):
                    if learnt(part) is not None:
                        ros2_definition(part)
                        decode_cdr(encode_cdr(zero(part)), part)
        finally:
            _forget()

    return run_one


def _forget() -> None:
    """Lets the next input define the same names, which a process otherwise keeps."""
    from cartwheel.messages import fields, learnt
    from cartwheel.messages.cdr import reading, writing
    from cartwheel.messages.ros2 import definitions
    from cartwheel.messages.store import loaded

    made = loaded()
    for name in list(learnt._by_name):
        del learnt._by_name[name]
        for table in (made.types, made.fielddefs, made.cache):
            table.pop(name, None)
    for cached in (
        reading.has_wide_text,
        reading._fields,
        writing._plan,
        fields.fields,
        definitions.ros2_definition,
    ):
        cached.cache_clear()


def _target(kind: str, seeds: list[bytes]) -> Target:
    return Target(
        name=f"{kind}-files",
        seeds=lambda: seeds,
        run_one=_reader(kind),
        allowed=(CartwheelError,),
        mutate=mutating.text,
        share=0.5,
    )


TARGETS = (_target("msg", _MESSAGES), _target("srv", _SERVICES), _target("action", _ACTIONS))
