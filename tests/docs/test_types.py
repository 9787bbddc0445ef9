"""The Python that the pages and examples show has types that a strict checker accepts."""

import json
import os
import subprocess
import sys
from pathlib import Path

from .pages import ROOT, blocks
from .test_snippets import EXAMPLES, WITH_PYTHON

SETTINGS = {"typeCheckingMode": "strict", "pythonVersion": "3.11"}


def checked(folder: Path) -> list[str]:
    """What pyright's strict mode finds in the files of a folder, by its fork on PyPI."""
    settings = {**SETTINGS, "extraPaths": [str(ROOT / "src")]}
    (folder / "pyrightconfig.json").write_text(json.dumps(settings))
    done = subprocess.run(
        [sys.executable, "-m", "basedpyright", "-p", ".", "--pythonpath", sys.executable,
         "--outputjson"],
        cwd=folder, capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    report = json.loads(done.stdout)
    assert report["summary"]["filesAnalyzed"] == len(list(folder.glob("*.py")))
    return [
        f"{Path(found['file']).name}:{found['range']['start']['line'] + 1}: {found['message']}"
        for found in report["generalDiagnostics"]
        if found["severity"] == "error"
    ]


def test_what_pages_and_examples_show_passes_in_strict_mode(tmp_path: Path) -> None:
    for page in WITH_PYTHON:
        # A block that is not run may be a part of a file, or a file of its own.
        shown = [block for block in blocks(page, "python") if "not run" not in block.notes]
        if not shown:
            continue
        lines: list[str] = []
        for block in shown:
            lines += [f"# {block}", *block.lines]
        name = "_".join(page.relative_to(ROOT).with_suffix("").parts).replace("-", "_")
        (tmp_path / f"{name}.py").write_text("\n".join(lines) + "\n")
    for script in EXAMPLES:
        (tmp_path / f"example_{script.name}").write_text(script.read_text())
    assert checked(tmp_path) == []


def test_an_error_is_found(tmp_path: Path) -> None:
    (tmp_path / "user.py").write_text(
        "import cartwheel as cw\nworld = cw.World('empty')\nworld.run('a second')\nworld.fly()\n"
    )
    assert {line.split(":")[1] for line in checked(tmp_path)} == {"3", "4"}


def test_messages_have_the_types_of_their_classes(tmp_path: Path) -> None:
    lines = {
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
    }
    (tmp_path / "user.py").write_text("\n".join(lines) + "\n")
    found = {int(line.split(":")[1]) for line in checked(tmp_path)}
    assert found == {number for number, wrong in enumerate(lines.values(), start=1) if wrong}


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


def test_functions_of_a_user_have_types(tmp_path: Path) -> None:
    (tmp_path / "user.py").write_text("\n".join(STUDY) + "\n")
    assert {line.split(":")[1] for line in checked(tmp_path)} == {"10", "11"}


def test_mypy_accepts_a_program(tmp_path: Path) -> None:
    (tmp_path / "user.py").write_text("\n".join(STUDY) + "\n")
    done = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--follow-imports=silent",
         "--ignore-missing-imports", "user.py"],
        cwd=tmp_path, env={**os.environ, "MYPYPATH": str(ROOT / "src")},
        capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    lines = [line.split(":")[1] for line in done.stdout.splitlines() if ": error:" in line]
    assert lines == ["10", "11"], done.stdout + done.stderr
