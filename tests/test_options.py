"""Messages name an option as their caller writes it."""

import ast
import socket
import sys
from pathlib import Path

import pytest
from tests import launching

import cartwheel as cw
from cartwheel import options
from cartwheel.errors import CartwheelError
from cartwheel.options import Caller, Option

pytestmark = pytest.mark.wording

SOURCE = Path(options.__file__).parent
OPTIONS = [each for each in vars(options).values() if isinstance(each, Option)]


@pytest.fixture
def command_line():
    before = options.caller()
    options.set_caller(Caller.COMMAND_LINE)
    yield
    options.set_caller(before)


@pytest.fixture
def busy():
    with socket.create_server(("127.0.0.1", 0)) as taken:
        yield taken.getsockname()[1]


def test_python_writes_parameters():
    assert str(options.RECORD) == "record"
    assert options.OVERWRITE.given() == "overwrite=True"
    assert options.HOST.given("robot") == 'host="robot"'
    assert options.PORT.given(8081) == "viewer=8081 or show(8081)"
    assert options.xacro_argument("arm", "true") == 'arguments={"arm": "true"}'


def test_the_command_line_has_flags(command_line):
    assert str(options.RECORD) == "--record"
    assert options.OVERWRITE.given() == "--overwrite"
    assert options.HOST.given("robot") == "--host robot"
    assert options.PORT.given(8081) == "--port 8081"
    assert options.xacro_argument("arm", "true") == "arm:=true"


def said(**parameters):
    with pytest.raises(CartwheelError) as caught:
        cw.World(**parameters)
    return f"{caught.value.message}. {caught.value.hint}"


def test_a_world_names_its_parameters(tmp_path, busy):
    once = tmp_path / "drive.mcap"
    assert said(record=[once, once]).startswith("record specifies")
    assert said(foxglove=0, allow_origin="robots").startswith(
        '"robots" is not a valid origin for allow_origin'
    )
    assert said(foxglove=0, host="robot..lab").startswith('host="robot..lab" cannot be used')
    assert f"serve_foxglove({busy + 1})" in said(foxglove=busy)
    once.write_bytes(b"")
    assert "overwrite=True" in said(record=once)


def test_a_spawned_model_names_its_parameter(make, rosbots):
    world = make.world()
    world.spawn(rosbots, name="cart")
    with pytest.raises(CartwheelError) as caught:
        world.spawn(rosbots, name="cart")
    assert 'name="cart_1"' in caught.value.hint


def test_the_program_names_its_flags(tmp_path, busy):
    once = str(tmp_path / "drive.mcap")

    def printed(*words: str) -> str:
        command = [sys.executable, "-m", "cartwheel", "run", "--headless", *words]
        done = launching.run(command, capture_output=True, text=True, timeout=120, check=False)
        assert done.returncode == 2
        return done.stderr

    assert "--record specifies" in printed("--record", once, "--record", once)
    assert "--host robot..lab cannot be used" in printed("--host", "robot..lab")
    # A bridge reports it, in a process of its own.
    port = printed("--foxglove", "--foxglove-port", str(busy))
    assert f"--foxglove-port {busy + 1}" in port


def files():
    return [
        file
        for file in sorted(SOURCE.rglob("*.py"))
        if file.relative_to(SOURCE).parts[0] not in ("cli", "codes", "options.py")
    ]


def test_only_the_command_line_writes_flags():
    flags = {each.flag for each in OPTIONS}
    assert len(flags) == len(OPTIONS) > 8
    wrong = [
        f"{file.relative_to(SOURCE)}:{node.lineno}"
        for file in files()
        for node in ast.walk(ast.parse(file.read_text()))
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
        if flags & set(node.value.replace(".", " ").split())
    ]
    assert not wrong
