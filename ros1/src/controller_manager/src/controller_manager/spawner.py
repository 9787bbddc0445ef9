"""The program spawner: loads and starts controllers, and unloads them at its end."""

from __future__ import annotations

import argparse
import threading
from pathlib import Path

from controller_manager.services import Manager, ManagerError, join_ros, own_arguments


def main() -> int:
    """Runs the program; returns its exit status."""
    arguments = parse(own_arguments())
    import rospy

    join_ros("spawner")
    manager = Manager(arguments.namespace or "")
    endless = arguments.no_timeout or arguments.timeout <= 0
    try:
        rospy.loginfo("Waiting for the controller manager")
        manager.wait(None if endless else arguments.timeout)
        if arguments.wait_for and not heard(arguments.wait_for):
            return 0
        loaded = load(manager, names_of(arguments.controllers))
        if loaded and not arguments.stopped:
            start(manager, loaded)
    except ManagerError as error:
        if not rospy.is_shutdown():
            rospy.logerr(str(error))
        return 1
    # Services can be called at shutdown, but not after `spin` has returned.
    rospy.on_shutdown(lambda: leave(manager, loaded))
    rospy.spin()
    return 0


def parse(words: list[str]) -> argparse.Namespace:
    """Parses the arguments. Exits with status 2 if they are invalid."""
    parser = argparse.ArgumentParser(
        prog="spawner", description="Loads and starts controllers. Ctrl-C unloads them."
    )
    parser.add_argument(
        "--stopped", action="store_true", help="load the controllers, but do not start them"
    )
    parser.add_argument(
        "--wait-for", metavar="TOPIC", help="wait for true on this Bool topic before loading"
    )
    parser.add_argument("--namespace", metavar="NS", help="namespace of the controller manager")
    parser.add_argument(
        "--timeout",
        metavar="SECONDS",
        type=float,
        default=30.0,
        help="maximum time to wait for the controller manager (default: 30); 0 means no limit",
    )
    parser.add_argument("--no-timeout", action="store_true", help="wait without a time limit")
    parser.add_argument("--shutdown-timeout", metavar="SECONDS", help="has no effect")
    parser.add_argument(
        "controllers",
        metavar="CONTROLLER",
        nargs="+",
        help="name of a controller, or YAML file with the parameters of controllers",
    )
    return parser.parse_args(words)


def names_of(words: list[str]) -> list[str]:
    """Returns the controller names, and loads YAML files into the parameter server."""
    import rosparam
    import yaml

    names = []
    for word in words:
        if Path(word).is_file():
            content = yaml.safe_load(Path(word).read_text()) or {}
            rosparam.upload_params("", content)
            names += list(content)
        else:
            names.append(word)
    return names


def heard(topic: str) -> bool:
    """Waits for a true message. Returns False if the program is stopped before."""
    import rospy
    from std_msgs.msg import Bool

    came = threading.Event()
    subscriber = rospy.Subscriber(topic, Bool, lambda message: message.data and came.set())
    while not came.wait(0.05):
        if rospy.is_shutdown():
            return False
    subscriber.unregister()
    return True


def load(manager: Manager, names: list[str]) -> list[str]:
    """Loads controllers. Returns the names of those that were loaded."""
    import rospy

    loaded = []
    for name in names:
        rospy.loginfo(f"Loading controller: {name}")
        if manager.load(name):
            loaded.append(name)
        else:
            rospy.logerr(f"Failed to load {name}. The simulation prints the reason.")
    return loaded


def start(manager: Manager, names: list[str]) -> None:
    """Starts all controllers, or none if one cannot be started."""
    import rospy

    if manager.switch(names, []):
        rospy.loginfo(f"Started controllers: {', '.join(names)}")
    else:
        rospy.logerr(
            f"Failed to start controllers: {', '.join(names)}. The simulation prints the reason."
        )


def leave(manager: Manager, names: list[str]) -> None:
    """Stops and unloads the controllers, if the simulation is still running."""
    try:
        running = manager.running()
        manager.switch([], [name for name in names if name in running])
        for name in reversed(names):
            manager.unload(name)
    except ManagerError:
        # Usually, roslaunch stops all nodes, and the simulation has stopped first.
        return
