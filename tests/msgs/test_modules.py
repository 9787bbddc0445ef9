"""The modules of `cartwheel.msgs`: their classes and stubs."""

import ast
import importlib
import pickle
import subprocess
import sys
from pathlib import Path

import pytest

import cartwheel.msgs
from cartwheel.messages import message_class
from cartwheel.messages.fields import fields
from cartwheel.messages.store import store

FOLDER = Path(cartwheel.msgs.__file__).parent
PACKAGES = sorted({name.split("/")[0] for name in store().types})


def test_the_files_are_up_to_date() -> None:
    script = Path(__file__).parents[2] / "tools" / "make_message_modules.py"
    done = subprocess.run(
        [sys.executable, str(script), "--check"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("package", PACKAGES)
def test_a_module_contains_what_its_stub_describes(package: str) -> None:
    module = importlib.import_module(f"cartwheel.msgs.{package}")
    stub = ast.parse((FOLDER / f"{package}.pyi").read_text())
    classes = [node for node in stub.body if isinstance(node, ast.ClassDef)]
    assert {node.name for node in classes} <= set(dir(module))
    for node in classes:
        made = getattr(module, node.name)
        assert made is message_class(made.__msgtype__)
        described = [each for each in node.body if isinstance(each, ast.AnnAssign)]
        names = [each.target.id for each in described if isinstance(each.target, ast.Name)]
        assert all(hasattr(made, name) for name in names)
        filled = [each.target.id for each in described if each.value]  # type: ignore[union-attr]
        assert filled == [field.name for field in fields(made.__msgtype__)]


def test_instances_can_be_pickled() -> None:
    from cartwheel.msgs.geometry_msgs import Twist, Vector3

    twist = Twist(linear=Vector3(x=0.5))
    assert pickle.loads(pickle.dumps(twist)) == twist


def test_a_name_that_does_not_exist() -> None:
    with pytest.raises(ImportError):
        exec("from cartwheel.msgs.nav_msgs import Odometri")
    with pytest.raises(ImportError):
        exec("from cartwheel.msgs.nav_msg import Odometry")


def test_importing_cartwheel_does_not_import_the_modules() -> None:
    code = "import cartwheel, sys; cartwheel.World; print('cartwheel.msgs' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.stdout.strip() == "False", done.stderr


def test_a_class_of_the_other_ros_version_states_its_module() -> None:
    with pytest.raises(ImportError) as caught:
        _ = importlib.import_module("cartwheel.msgs.control_msgs").FollowJointTrajectory_Result
    assert caught.value.name == "cartwheel.msgs.control_msgs"
    with pytest.raises(ImportError):
        _ = importlib.import_module("cartwheel.msgs.control_msgs_ros2").FollowJointTrajectoryGoal
    for package in ("control_msgs", "control_msgs_ros2", "nav_msgs"):
        with pytest.raises(AttributeError):
            _ = importlib.import_module(f"cartwheel.msgs.{package}").FollowJointTrajectry
