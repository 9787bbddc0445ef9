"""Launch files in Python, which are read and never executed, and in XML."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from pathlib import Path

from tests.campaign import mutating
from tests.campaign.target import Target
from tests.description import test_launch_models as models
from tests.description import test_launch_start as started
from tests.description import test_launches as known

from cartwheel.errors import CartwheelError

_ROOT = Path(__file__).parents[2]
_PACKAGE = '<package format="2"><name>arm</name></package>'
_ROBOTS = "- {name: one, sim: true, port: 1}\n- {name: two, sim: false, port: 2}\n"


def _reader(name: str) -> Callable[[bytes], None]:
    def run_one(data: bytes) -> None:
        from cartwheel.description.launches import launches_near, read_launch

        package = Path("arm").resolve()
        for folder in ("launch", "urdf", "config"):
            (package / folder).mkdir(parents=True, exist_ok=True)
        (package / "package.xml").write_text(_PACKAGE)
        (package / "urdf" / "arm.urdf.xacro").write_text(known.ROBOT)
        (package / "config" / "robots.yaml").write_text(_ROBOTS)
        (package / "launch" / name).write_bytes(data)
        launches_near(package)
        with contextlib.suppress(CartwheelError):
            read_launch(package / "launch" / name, {"model": "arm", "size": "2"})

    return run_one


def _shipped() -> list[bytes]:
    folders = (_ROOT / "ros1" / "src", _ROOT / "robots")
    return [path.read_bytes() for each in folders for path in sorted(each.rglob("*.launch"))]


TARGETS = (
    Target(
        name="python-launch",
        seeds=lambda: [
            text.encode()
            for text in (
                known.INCLUDED,
                known.STARTER,
                known.LOOPS,
                known.VARIANTS_ROS2,
                started.ROS2,
                models.LOOP,
            )
        ],
        run_one=_reader("fuzz.launch.py"),
        mutate=mutating.text,
    ),
    Target(
        name="xml-launch",
        seeds=lambda: [
            *_shipped(),
            *(
                text.encode()
                for text in (
                    known.ROS1,
                    known.CONTROL,
                    known.ROS2_XML,
                    known.SIZED,
                    started.ROS1,
                    models.TWO_GROUPS,
                )
            ),
        ],
        run_one=_reader("fuzz.launch"),
        mutate=mutating.text,
    ),
)
