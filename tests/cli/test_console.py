"""What is printed does nothing to the terminal, whatever strangers named their things."""

import os
import sys

import pytest
from tests import launching

from cartwheel.cli import console


@pytest.mark.parametrize(
    ("text", "printed"),
    [
        ("two\nlines\tand ümläuts 車", "two\nlines\tand ümläuts 車"),
        ("\x1b]0;title\x07\x1b[2J", r"\x1b]0;title\x07\x1b[2J"),
        ("\x9b2J", r"\x9b2J"),
        ("one\rtwo", r"one\rtwo"),
        ("abc\u202edef", r"abc\u202edef"),
        ("\udcff", r"\udcff"),
        ("\x1b[31;1mred\x1b[0m", "\x1b[31;1mred\x1b[0m"),
        ("\x1b[8mhidden", r"\x1b[8mhidden"),
    ],
)
def test_what_is_no_text_is_printed_as_its_code(text, printed):
    assert console.printable(text) == printed


def test_a_file_commands_no_terminal(tmp_path):
    file = tmp_path / "robot\x1b[2J.urdf"
    file.write_text('<robot name="a\x9b2Jb"><joint name="\x9b5m" type="bogus\x9b5m"/></robot>')
    result = cartwheel("check", file)
    assert b"bogus\\x9b5m" in result.stdout
    assert b"\x1b" not in result.stdout
    assert "\x9b" not in result.stdout.decode()


def test_a_name_that_is_no_utf8_is_printed(tmp_path):
    file = tmp_path / os.fsdecode(b"\xff.urdf")
    file.write_text('<robot name="a"/>')
    result = cartwheel("check", file)
    assert b"fault" not in result.stderr
    assert b"udcff.urdf" in result.stdout


def cartwheel(*words):
    return launching.run(
        [sys.executable, "-m", "cartwheel", *words],
        check=False,
        capture_output=True,
        timeout=60,
    )
