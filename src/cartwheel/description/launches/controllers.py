"""The controllers in the arguments of spawners, in commands of ``ros2 control``, and in calls of a
controller manager's services.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from cartwheel.description.launches.effort import UNKNOWN
from cartwheel.description.launches.spawning import resolved

_MANAGERS = frozenset({"-c", "--controller-manager"})
_MANAGER_SPACES = frozenset({"-n", "--namespace"})
"""Options of spawners that state the controller manager, or its namespace."""
_FILES = frozenset({"-p", "--param-file"})
_TYPES = frozenset({"-t", "--controller-type"})
_ROS_ARGUMENTS = "--controller-ros-args"
"""Option of spawners with arguments of the controllers' nodes, which can be stated repeatedly."""
_INACTIVE = frozenset({"--inactive", "--stopped", "--load-only"})
"""Options of spawners that only load controllers."""
_SWITCHES = _INACTIVE | {
    "--activate-as-group",
    "--unload-on-kill",
    "-u",
    "--switch-asap",
    "--no-switch-asap",
}
"""Options of spawners without a value."""
_OTHER_VERBS = frozenset({"stop", "unload", "kill", "list", "list-types", "reload-libraries"})
"""Commands of ROS 1's ``controller_manager`` that start and load nothing."""
_STATE = frozenset({"--set-state", "--set_state"})
_VALUED = _STATE | _MANAGERS | {"--spin-time", "--switch-timeout"}
"""Options of ``ros2 control`` with a value."""
_RUNNING = frozenset({"active", "start"})
"""States in which a controller commands joints; ``start`` is the older name."""
_STARTING = frozenset({"load_start_controller", "configure_start_controller"})
"""Older commands that also start the controller."""
_LOADING = frozenset({"load_controller", "load_configure_controller"})
_ACTIVATE = frozenset({"--activate", "--start"})
_CONTROLLER = re.compile(r"[\w/]+")
_STARTED = re.compile(r"\b(?:start|activate)_controllers['\"]?\s*:\s*\[([^\[\]]*)\]")
"""The controllers that a request starts. That of ROS 1 has the name of the list first."""
_STARTS = re.compile(r"\b(?:start|activate)_controllers['\"]?\s*:")
"""A request that starts controllers, which may be listed in another form."""
_FIRST = re.compile(r"\s*['\"]?\[([^\]]*)\]")
"""The first argument of a request without names: the controllers to start."""
_REQUESTED = re.compile(r"\bname['\"]?\s*:\s*['\"]?([\w/]+)")
_MANAGER = "controller_manager"
_BETWEEN = re.compile(r"&&|\|\||[;&|\n]")
"""What separates commands."""
_SHELLS = frozenset({"bash", "sh", "dash", "zsh"})
_PREFIXES = frozenset({"exec", "sudo", "then", "do"})
_QUOTES = "'\""


@dataclass(frozen=True, kw_only=True, slots=True)
class ControllerCommand:
    """What a spawner or a command does with controllers."""

    space: str
    """The namespace of the controller manager; empty if it is unknown, as for that of any robot."""
    started: tuple[str, ...] = ()
    loaded: tuple[str, ...] = ()
    """Controllers that it loads, but does not start."""
    decided: bool = True
    """Whether it states that it does not start them, as ``--inactive`` does."""
    files: tuple[str, ...] = ()
    """Names of files with their parameters."""
    arguments: tuple[str, ...] = ()
    """ROS arguments of their nodes, such as ``-r from:=to``."""
    unsure: bool = False
    """Whether it starts or loads further controllers whose names are unknown."""
    typed: bool = False
    """Whether it states the type of its controllers, or a file that is unknown may do so."""


def by_spawner(words: Iterable[str], space: str) -> ControllerCommand:
    """The controllers of a spawner with these arguments, in its namespace.

    ROS 1's program ``controller_manager`` has the same arguments after a command such as ``spawn``.
    """
    words = _apart(words)
    if words and words[0] in _OTHER_VERBS:
        return ControllerCommand(space="")
    names: list[str] = []
    files: list[str] = []
    arguments: list[str] = []
    options = iter(words)
    for word in options:
        if word in _FILES:
            files += itertools.islice(options, 1)
        elif word == _ROS_ARGUMENTS:
            value = next(options, "")
            arguments += value.split() if UNKNOWN not in value else ()
        elif word.startswith("-"):
            # Options with a value, such as --controller-manager /controller_manager.
            if word not in _SWITCHES:
                next(options, None)
        elif word not in ("spawn", "start", "load"):
            names.append(word)
    known = tuple(_names(names))
    starts = not any(word in _INACTIVE or word == "load" for word in words)
    return ControllerCommand(
        space=_manager_space(words, space),
        started=known if starts else (),
        loaded=() if starts else known,
        files=tuple(files),
        arguments=tuple(arguments),
        typed=not _TYPES.isdisjoint(words) or any(UNKNOWN in each for each in files),
        # ROS 1's spawner also takes files, and starts the controllers that they name.
        unsure=any(UNKNOWN in name or name.endswith((".yaml", ".yml")) for name in names),
    )


def by_command(words: Iterable[str]) -> ControllerCommand | None:
    """The controllers of ``ros2 control`` with these arguments; None for those without any.

    ``load_controller`` only loads a controller, unless ``--set-state active`` is stated.
    ``set_controller_state`` and ``switch_controllers`` start controllers that are loaded.
    """
    verb, *rest = _apart(words) or [""]
    stated, state = _values(rest)
    space = _manager_space(rest, "")
    first = tuple(_names(stated[:1]))
    if any(UNKNOWN in word for word in stated[:1]):
        return ControllerCommand(space=space, unsure=True)
    if verb in _STARTING or (verb in _LOADING and state in _RUNNING):
        return ControllerCommand(space=space, started=first, files=tuple(stated[1:2]))
    if verb in _LOADING:
        return ControllerCommand(
            space=space,
            loaded=first,
            decided=bool(state) or verb != "load_controller",
            files=tuple(stated[1:2]),
        )
    if verb == "set_controller_state" and stated[1:2] and stated[1] in _RUNNING:
        return ControllerCommand(space=space, started=first)
    if verb == "switch_controllers":
        return ControllerCommand(space=space, started=tuple(_names(_activated(rest))))
    return None


def by_service(words: Iterable[str]) -> ControllerCommand | None:
    """The controllers in a call of a controller manager's service; None for other calls.

    Args:
        words: The name of the service, in ROS 2 its type, and the request, which may be split.
    """
    service, *rest = [*words] or [""]
    manager, _, verb = service.rpartition("/")
    space, _, node = manager.rpartition("/")
    if node != _MANAGER:
        return None
    space = "" if UNKNOWN in space else space.strip("/")
    request = " ".join(rest)
    unsure = UNKNOWN in request
    if verb == "switch_controller":
        found = _STARTED.search(request) or _FIRST.match(request)
        listed = found[1].split(",") if found is not None else []
        return ControllerCommand(
            space=space,
            started=tuple(_names(each.strip("'\" ") for each in listed)),
            unsure=unsure or (found is None and _STARTS.search(request) is not None),
        )
    named = _REQUESTED.search(request)
    names = tuple(_names([named[1]] if named is not None else rest[-1:])) if not unsure else ()
    if verb.endswith("_and_start_controller"):
        return ControllerCommand(space=space, started=names, unsure=unsure)
    if verb.startswith("load_"):
        return ControllerCommand(space=space, loaded=names, decided=False, unsure=unsure)
    return None


def shell_commands(words: Iterable[str]) -> Iterator[list[str]]:
    """The words of each command, without quotes, such as two in ``bash -c "sleep 5; ros2 run …"``.

    Args:
        words: The command line, of which each word may contain several.
    """
    for text in _BETWEEN.split(" ".join(words)):
        parts = [stripped for part in text.split() if (stripped := part.strip(_QUOTES))]
        parts = [*itertools.dropwhile(_PREFIXES.__contains__, parts)]
        if parts and _is_shell(parts[0]):
            # The options of the shell, such as -lc, precede the command.
            options = itertools.dropwhile(lambda one: one.startswith("-") or _is_shell(one), parts)
            parts = [*options]
        if parts:
            yield parts


def _is_shell(program: str) -> bool:
    return program.rpartition("/")[2] in _SHELLS


def _apart(words: Iterable[str]) -> list[str]:
    """Arguments with the value of an option such as ``--param-file=FILE`` apart."""
    parts = (word.split("=", 1) if word.startswith("--") else [word] for word in words)
    return [*itertools.chain(*parts)]


def _values(words: Iterable[str]) -> tuple[list[str], str]:
    """The arguments that are no options, and the stated state of the controller."""
    found: list[str] = []
    state = ""
    options = iter(words)
    for word in options:
        if word in _VALUED:
            value = next(options, "")
            state = value if word in _STATE else state
        elif not word.startswith("-"):
            found.append(word)
    return found, state


def _activated(words: Iterable[str]) -> Iterator[str]:
    """The arguments after ``--activate``, up to the next option."""
    active = False
    for word in words:
        if word.startswith("-"):
            active = word in _ACTIVATE
        elif active:
            yield word


def _names(words: Iterable[str]) -> Iterator[str]:
    """The names of controllers among words, without those that have unknown parts.

    ROS 1's names may be paths in the namespace of the manager, such as ``front/left/wheel``.
    """
    return (word.strip("/") for word in words if _CONTROLLER.fullmatch(word))


def _manager_space(words: Sequence[str], space: str) -> str:
    """The namespace of a controller manager.

    Args:
        words: Arguments of a spawner, which may state the manager.
        space: The namespace of the spawner.
    """
    for flag, word in itertools.pairwise(words):
        if flag in _MANAGERS:
            space = resolved(space, word).rpartition("/")[0]
        elif flag in _MANAGER_SPACES:
            space = resolved(space, word)
    return "" if UNKNOWN in space else space
