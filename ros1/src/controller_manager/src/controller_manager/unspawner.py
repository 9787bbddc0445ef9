"""The program unspawner: stops running controllers, and starts them again at its end."""

from __future__ import annotations

import argparse

from controller_manager.services import Manager, ManagerError, join_ros, own_arguments


def main() -> int:
    """Runs the program; returns its exit status."""
    arguments = parse(own_arguments())
    import rospy

    join_ros("unspawner")
    manager = Manager(arguments.namespace or "")
    try:
        manager.wait(None if arguments.timeout <= 0 else arguments.timeout)
        running = manager.running()
        stopped = [name for name in arguments.controllers if name in running]
        if not manager.switch([], stopped):
            rospy.logerr(f"Failed to stop controllers: {', '.join(stopped)}")
            return 1
        rospy.loginfo(f"Stopped controllers: {', '.join(stopped)}")
    except ManagerError as error:
        if not rospy.is_shutdown():
            rospy.logerr(str(error))
        return 1
    # Services can be called at shutdown, but not after `spin` has returned.
    rospy.on_shutdown(lambda: go_on(manager, stopped))
    rospy.spin()
    return 0


def go_on(manager: Manager, names: list[str]) -> None:
    """Starts the controllers again, if the simulation is still running."""
    try:
        manager.switch(names, [])
    except ManagerError:
        return


def parse(words: list[str]) -> argparse.Namespace:
    """Parses the arguments. Exits with status 2 if they are invalid."""
    parser = argparse.ArgumentParser(
        prog="unspawner", description="Stops controllers. Ctrl-C starts them again."
    )
    parser.add_argument("--namespace", metavar="NS", help="namespace of the controller manager")
    parser.add_argument(
        "--timeout",
        metavar="SECONDS",
        type=float,
        default=30.0,
        help="maximum time to wait for the controller manager (default: 30); 0 means no limit",
    )
    parser.add_argument("controllers", metavar="CONTROLLER", nargs="+")
    return parser.parse_args(words)
