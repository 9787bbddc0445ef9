"""The program controller_group: switches between groups of controllers.

The parameter ``controller_groups`` contains the names of the groups and their controllers.
"""

from __future__ import annotations

import sys

from controller_manager.services import Manager, ManagerError, join_ros, own_arguments

USAGE = """\
Commands:
    list                 list the groups, and mark the running group
    spawn <group>        load the controllers of all groups, and start those of this group
    switch <group>       stop the controllers of the other groups, and start those of this group"""


def main() -> int:
    """Runs the program; returns its exit status."""
    words = own_arguments()
    if not words or words[0] not in ("list", "spawn", "switch") or len(words) > 2:
        print(USAGE, file=sys.stderr)
        return 1
    join_ros("controller_group")
    import rospy

    groups = rospy.get_param("controller_groups", {})
    if words[0] != "list" and (len(words) < 2 or words[1] not in groups):
        print(f"Groups: {', '.join(groups) or 'none'}", file=sys.stderr)
        return 1
    manager = Manager()
    try:
        manager.wait(10.0)
        states = {each.name: each.state for each in manager.controllers()}
        if words[0] == "list":
            for name, members in groups.items():
                runs = all(states.get(member) == "running" for member in members)
                print(f"{name}{' (running)' if runs else ''}: {', '.join(members)}")
            return 0
        if words[0] == "spawn":
            everything = dict.fromkeys(name for members in groups.values() for name in members)
            for name in everything:
                if name not in states and not manager.load(name):
                    print(f"Error: could not load '{name}'")
                    return 1
        return switch(manager, groups, words[1])
    except ManagerError as error:
        print(error, file=sys.stderr)
        return 1


def switch(manager: Manager, groups: dict[str, list[str]], group: str) -> int:
    """Starts the controllers of one group, and stops those of the other groups."""
    running = set(manager.running())
    wanted = groups[group]
    others = {name for members in groups.values() for name in members} - set(wanted)
    start = [name for name in wanted if name not in running]
    if not manager.switch(start, sorted(others & running)):
        print(f"Error: could not switch to '{group}'")
        return 1
    return 0
