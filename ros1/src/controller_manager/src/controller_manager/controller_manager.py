"""The program controller_manager: sends one command to a controller manager."""

from __future__ import annotations

import sys

from controller_manager.services import Manager, ManagerError, join_ros, own_arguments

USAGE = """\
Commands:
    load <name>          load a controller
    unload <name>        unload a controller
    start <name>         start a loaded controller
    stop <name>          stop a running controller
    spawn <name>         load and start a controller
    kill <name>          stop and unload a controller
    list                 list the loaded controllers
    list-types           list the supported controller types
    reload-libraries     unload all controllers; --restore loads and starts them again"""
_SHORT = {"lt": "list-types", "lc": "list", "sp": "spawn", "kl": "kill"}
_STEPS = {
    "load": ("load",),
    "unload": ("unload",),
    "start": ("start",),
    "stop": ("stop",),
    "spawn": ("load", "start"),
    "kill": ("stop", "unload"),
}
_DONE = {"load": "Loaded", "unload": "Unloaded", "start": "Started", "stop": "Stopped"}


def main() -> int:
    """Runs the program; returns its exit status."""
    words = own_arguments()
    command = _SHORT.get(words[0], words[0]) if words else ""
    known = command in _STEPS or command in ("list", "list-types", "reload-libraries")
    if not known or (command in _STEPS and len(words) < 2):
        print(USAGE, file=sys.stderr if words else sys.stdout)
        return 1 if words else 0
    join_ros("controller_manager")
    manager = Manager()
    try:
        manager.wait(10.0)
        if command == "list":
            show(manager)
        elif command == "list-types":
            for name, _ in manager.types():
                print(name)
        elif command == "reload-libraries":
            return reload(manager, restore="--restore" in words[1:])
        else:
            done = [act(manager, step, words[1:]) for step in _STEPS[command]]
            return 0 if all(done) else 1
    except ManagerError as error:
        print(error, file=sys.stderr)
        return 1
    return 0


def act(manager: Manager, step: str, names: list[str]) -> bool:
    """Applies one step to each controller. Returns whether all steps succeeded."""
    well = True
    for name in names:
        if step == "load":
            ok = manager.load(name)
        elif step == "unload":
            ok = manager.unload(name)
        else:
            ok = manager.switch([name], []) if step == "start" else manager.switch([], [name])
        print(f"{_DONE[step]} '{name}'" if ok else f"Error: could not {step} '{name}'")
        well = well and ok
    return well


def show(manager: Manager) -> None:
    """Prints the loaded controllers."""
    found = manager.controllers()
    if not found:
        print("No controllers are loaded in mechanism control")
    for each in found:
        hardware = sorted({claim.hardware_interface for claim in each.claimed_resources})
        print(f"'{each.name}' - '{', '.join(hardware)}' ( {each.state} )")


def reload(manager: Manager, *, restore: bool) -> int:
    """Unloads all controllers, and optionally loads and starts them again."""
    before = manager.controllers()
    if not manager.reload(force=True):
        print("Error: could not reload the libraries")
        return 1
    print("Unloaded all controllers")
    if restore:
        act(manager, "load", [each.name for each in before])
        act(manager, "start", [each.name for each in before if each.state == "running"])
    return 0
