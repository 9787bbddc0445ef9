"""The simulation under roslaunch: it comes up, does what the arguments say, and leaves nothing."""

import itertools
import re
import signal
import urllib.error
import urllib.request

import pytest

from cartwheel.codes.command import GAZEBO_OPTION_UNSUPPORTED, WORLD_NOT_FOUND


@pytest.fixture
def launch(ros):
    """Starts empty_world.launch, or another one, and waits for the simulation."""

    def start(*words, service="/gazebo/spawn_urdf_model"):
        names = words if words and words[0].endswith(".launch") else ("empty_world.launch", *words)
        log = (ros.folder / "launch.log").open("w")
        process = ros.start(
            "roslaunch", "-p", ros.port, "gazebo_ros", *names, stdout=log, stderr=log,
            environment={"ROS_MASTER_URI": f"http://localhost:{ros.port}", "DISPLAY": ""},
        )  # fmt: skip
        if service:
            ros.until(
                lambda: service in ros.services,
                (ros.folder / "launch.log").read_text(),
            )
        return process

    return start


def said(ros):
    return (ros.folder / "launch.log").read_text()


def test_it_comes_up_shows_itself_and_leaves_nothing(ros, launch):
    process = launch()
    found = ros.until(lambda: re.search(r"web interface: +\S*?(http://[\d.:]+)", said(ros)))
    with urllib.request.urlopen(found[1], timeout=120) as page:
        assert page.status == 200
    assert len(ros.left()) >= 4  # roslaunch, the master, the server and the client
    process.send_signal(signal.SIGINT)
    process.wait(timeout=120)
    ros.until(lambda: not ros.left())
    assert "escalating" not in said(ros), "roslaunch had to kill something"
    with pytest.raises(urllib.error.URLError):
        urllib.request.urlopen(found[1], timeout=5)


def test_what_the_arguments_do(ros, launch):
    launch(
        "gui:=false", "paused:=true", "physics:=dart", "use_clock_frequency:=true",
        "pub_clock_frequency:=20",
    )  # fmt: skip
    assert not any("gzclient" in line for line in ros.left())
    assert "page" not in said(ros)
    ignored = [line for line in said(ros).splitlines() if f"[{GAZEBO_OPTION_UNSUPPORTED}]" in line]
    assert ["-e dart" in line for line in ignored] == [True]
    answer = ros.run("rosservice", "call", "/gazebo/get_physics_properties").stdout
    assert "pause: True" in answer
    ros.run("rosservice", "call", "/gazebo/unpause_physics")
    stamps = ros.run("rostopic", "echo", "-n", "6", "/clock/clock").stdout
    seconds, parts = (
        [int(number) for number in re.findall(rf"\b{name}: +(\d+)", stamps)]
        for name in ("secs", "nsecs")
    )
    times = [s * 10**9 + n for s, n in zip(seconds, parts, strict=True)]
    assert {after - before for before, after in itertools.pairwise(times)} == {50_000_000}


def test_without_the_network_of_gazebo_there_is_the_clock(ros, launch):
    launch("gui:=false", "enable_ros_network:=false", service=None)
    ros.until(lambda: "/clock" in ros.topics)
    assert "/gazebo/spawn_urdf_model" not in ros.run("rosservice", "list").stdout.split()


def test_a_server_that_is_required_ends_everything(ros, launch):
    process = launch("gui:=false", "server_required:=true", "extra_gazebo_args:=--iters 400")
    assert process.wait(timeout=60) is not None
    ros.until(lambda: not ros.left())


def test_a_world_that_does_not_exist_is_reported(ros, launch):
    process = launch(
        "gui:=false", "server_required:=true", "world_name:=worlds/emtpy.world", service=None
    )
    process.wait(timeout=60)
    assert f"[{WORLD_NOT_FOUND}]" in said(ros)
    assert '"worlds/emtpy.world"' in said(ros)
