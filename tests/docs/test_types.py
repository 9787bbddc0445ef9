"""The Python that the pages and examples show has types that a strict checker accepts."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from .pages import ROOT, blocks
from .test_snippets import EXAMPLES, WITH_PYTHON

SETTINGS = {"typeCheckingMode": "strict", "pythonVersion": "3.11"}


def strict(folder: Path) -> dict[str, dict[int, str]]:
    """The errors by line that pyright's strict mode finds in each file, by its fork on PyPI.

    Args:
        folder: Contains the files.
    """
    settings = {**SETTINGS, "extraPaths": [str(ROOT / "src")]}
    (folder / "pyrightconfig.json").write_text(json.dumps(settings))
    done = subprocess.run(
        [sys.executable, "-m", "basedpyright", "-p", ".", "--pythonpath", sys.executable,
         "--outputjson"],
        cwd=folder, capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    report = json.loads(done.stdout)
    files = sorted(folder.glob("*.py"))
    assert report["summary"]["filesAnalyzed"] == len(files)
    errors: dict[str, dict[int, str]] = {file.stem: {} for file in files}
    for found in report["generalDiagnostics"]:
        if found["severity"] == "error":
            line = found["range"]["start"]["line"] + 1
            errors[Path(found["file"]).stem][line] = found["message"]
    return errors


def shown() -> dict[str, str]:
    """What pages and examples show, by a name of a module."""
    texts = {f"example_{script.stem}": script.read_text() for script in EXAMPLES}
    for page in WITH_PYTHON:
        # A block that is not run may be a part of a file, or a file of its own.
        parts = [block for block in blocks(page, "python") if "not run" not in block.notes]
        lines = [line for block in parts for line in (f"# {block}", *block.lines)]
        if lines:
            name = "_".join(page.relative_to(ROOT).with_suffix("").parts).replace("-", "_")
            texts[f"page_{name}"] = "\n".join(lines) + "\n"
    return texts


@pytest.fixture(scope="module")
def errors(tmp_path_factory: pytest.TempPathFactory) -> dict[str, dict[int, str]]:
    """The errors in each program: one process reads Cartwheel's sources once for all."""
    folder = tmp_path_factory.mktemp("programs")
    own = {"wrong": WRONG, "messages": list(MESSAGES), "study": STUDY}
    texts = shown() | {name: "\n".join(lines) + "\n" for name, lines in own.items()}
    for name, text in texts.items():
        (folder / f"{name}.py").write_text(text)
    return strict(folder)


def test_what_pages_and_examples_show_passes_in_strict_mode(
    errors: dict[str, dict[int, str]],
) -> None:
    names = list(shown())
    assert len(names) > len(EXAMPLES) > 0
    assert not {name: errors[name] for name in names if errors[name]}


WRONG = ["import cartwheel as cw", "world = cw.World('empty')", "world.run('a')", "world.fly()"]


def test_an_error_is_found(errors: dict[str, dict[int, str]]) -> None:
    assert set(errors["wrong"]) == {3, 4}


MESSAGES = {
    "import cartwheel as cw": False,
    "from cartwheel.msgs.nav_msgs import Odometry": False,
    "from cartwheel.msgs.geometry_msgs import Twist, Vector3": False,
    "world = cw.World('empty')": False,
    "odometry = world.topic('/odom', Odometry)": False,
    "x: float = odometry.latest.pose.pose.position.x": False,
    "steps: str = odometry.latest.pose.pose.position.x": True,
    "print(odometry.wait().pos)": True,
    "assert odometry.latest is None or odometry.history()[0].header.stamp.sec == 0": False,
    "odometry.publish(Twist())": True,
    "print(Twist(linear=Vector3(x=0.5)).linear.x)": False,
    "print(Twist(linear=Vector3(X=0.5)))": True,
    "def plain(topic: cw.Topic) -> None: print(topic.latest.header)": False,
    "def typed(topic: 'cw.Topic[Odometry]') -> None: print(topic.latest.header)": False,
    "plain(odometry)": False,
    "typed(odometry)": False,
    "world.subscribe('/odom', lambda each: print(each.twist), type=Odometry)": False,
    "world.subscribe('/odom', lambda each: print(each.x), type=Odometry)": True,
    "print(world.mailbox('/odom', Odometry).drain()[0].twist)": False,
    "world.advertise('/odom', Odometry).publish(Twist())": True,
    "world.topic('/odom', int)": True,
    "print(world.topic('/own', 'my_msgs/msg/Own').latest.field)": False,
    "from cartwheel.msgs.trajectory_msgs import JointTrajectory, JointTrajectoryPoint": False,
    "from cartwheel.msgs.std_msgs import Float64MultiArray, Header": False,
    "point = JointTrajectoryPoint(positions=[0.5, -0.3], time_from_start=2.0)": False,
    "goal = JointTrajectory(Header(stamp=1.5), joint_names=('a', 'b'), points=[point])": False,
    "print(point.time_from_start.sec, point.positions.shape, goal.points[0].velocities)": False,
    "print(JointTrajectoryPoint(time_from_start='2'))": True,
    "print(JointTrajectory(joint_names='a'))": True,
    "point.time_from_start, goal.header.stamp = 2.0, 1.5": False,
    "point.positions, goal.joint_names = [0.5, -0.3], ('a', 'b')": False,
    "effort: float = point.effort.sum() + point.time_from_start.sec": False,
    "goal.points.append(point)": False,
    "point.time_from_start = '2'": True,
    "goal.points = point": True,
    "box: cw.Mailbox[Odometry] = world.mailbox('/odom', Odometry)": False,
    "sender: cw.Publisher[Odometry] = world.advertise('/odom', Odometry)": False,
    "link: cw.Subscription = world.subscribe('/odom', print, type=Odometry)": False,
    "stamp = odometry.history()[0].header.stamp": False,
    "print(cw.seconds(stamp), world.transform('odom', 'base', time=stamp))": False,
    "print(cw.seconds(2.0))": True,
    "print(Float64MultiArray(data=[0.04, 0.04]), Float64MultiArray(data=world.time))": False,
    "robot, fault = world.model('cart'), world.fault('/odom', drop=0.5)": False,
    "robot.pose, robot.link('a').mass, world.gravity = cw.Pose(), 2.0, (0, 0, -1)": False,
    "robot.joints['a'].effort_limit, world.pace, world.light('sun').on = 3.0, 1.0, True": False,
    "robot.poze = cw.Pose()": True,
    "robot.link('a').masss = 2.0": True,
    "robot.joints['a'].effort_limt = 3.0": True,
    "robot.joints.dampin = 3.0": True,
    "world.gravityy = (0, 0, -1)": True,
    "world.light('sun').intensty = 2.0": True,
    "fault.dropp = 1.0": True,
}
"""Lines of a program, and whether each is an error."""


def test_messages_have_the_types_of_their_classes(errors: dict[str, dict[int, str]]) -> None:
    wrong = {number for number, is_wrong in enumerate(MESSAGES.values(), start=1) if is_wrong}
    assert set(errors["messages"]) == wrong


STUDY = [
    "import cartwheel as cw",
    "def study(world: cw.World, case: dict[str, float]) -> dict[str, float]:",
    "    world.run_until(lambda w: w.time > 1)",
    "    world.run_until(lambda: world.time > 1)",
    "    world.run_until(done)",
    "    return {'x': world.time * case['a']}",
    "def done(world: cw.World) -> bool: return world.time > 2",
    "built = cw.build('empty', ['rosbots.xacro'])",
    "print(cw.sweep(study, [{'a': 1.0}], built, jobs=0), cw.check('rosbots.xacro'))",
    "cw.World().run_until(3)",
    "cw.sweep(study, [{'a': 1.0}], cw.World())",
]
"""A program of a user, with errors in the last two lines."""


def test_functions_of_a_user_have_types(errors: dict[str, dict[int, str]]) -> None:
    assert set(errors["study"]) == {10, 11}


def test_mypy_finds_the_same_errors(tmp_path: Path) -> None:
    """As for a user, for whom the functions of an installed package are not checked."""
    user = tmp_path / "user.py"
    typed = [line for line in MESSAGES if "lambda" not in line]
    user.write_text("\n".join([*STUDY, *typed]) + "\n")
    done = subprocess.run(
        [sys.executable, "-m", "mypy", "--no-error-summary", "--follow-imports=silent",
         "--cache-dir=.mypy_cache/user", str(user)],
        cwd=ROOT, capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    found = [line.partition(f"{user.name}:")[2] for line in done.stdout.splitlines()]
    lines = [each.split(":")[0] for each in found if ": error:" in each]
    first = len(STUDY) + 1
    wrong = [str(number) for number, line in enumerate(typed, first) if MESSAGES[line]]
    assert sorted(set(lines), key=int) == ["10", "11", *wrong], done.stdout + done.stderr
