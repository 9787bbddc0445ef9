"""Topics of a running simulation."""

from __future__ import annotations

import contextlib
import re
import sys
import time
from collections.abc import Sequence
from typing import Any

from cartwheel.cli import interrupts
from cartwheel.cli.commands.clients import connect, parse_yaml
from cartwheel.cli.console import note, say, say_table
from cartwheel.cli.showing import print_diagnostic
from cartwheel.codes.command import OPTION_INVALID, OUTPUT_SLOW, SIMULATION_ENDED
from cartwheel.codes.graph import FIELD_UNKNOWN
from cartwheel.codes.wires import MESSAGE_UNREAD
from cartwheel.control import ControlClient, Sample
from cartwheel.errors import CartwheelError, GraphError
from cartwheel.similar_names import suggestion


def print_list(sim: str | None, *, verbose: bool) -> None:
    """Prints the names, or a table of types, rates, publishers and subscribers."""
    with connect(sim) as client:
        found = client.request("topics")["topics"]
    if not verbose:
        for one in found:
            say(one["name"])
        return
    rows = [["topic", "type", "rate", "publishers", "subscribers"]]
    for one in found:
        rate = f"{one['rate']:g} Hz" if one["rate"] else ""
        publishers = ", ".join(one["publishers"]) or "-"
        rows.append([one["name"], one["type"], rate, publishers, ", ".join(one["readers"])])
    say_table(rows)


def print_info(sim: str | None, topic: str) -> None:
    """Prints one topic, in the layout of ``rostopic info``."""
    with connect(sim) as client:
        one = client.request("topic", topic=topic)
    say(f"Type: {one['type']}")
    if one["rate"]:
        say(f"Rate: {one['rate']:g} Hz")
    for title, nodes in (("Publishers", one["publishers"]), ("Subscribers", one["readers"])):
        say()
        say(f"{title}:" if nodes else f"{title}: None")
        for node in nodes:
            say(f" * {node}")


def echo(
    sim: str | None,
    topic: str,
    *,
    count: int | None,
    arrays: bool,
    full: bool,
    field: str | None,
) -> None:
    """Prints messages until `count` is reached, the user interrupts, or the simulation ends."""
    from cartwheel.messages import decode_cdr, to_yaml

    shown = dropped = 0
    with ends_quietly(count), connect(sim) as client, client.subscribe(topic) as subscription:
        for sample in subscription:
            message: Any = decode_cdr(sample.data, sample.type)
            if field is not None:
                message = pick(message, field)
            sys.stdout.write(to_yaml(message, full=full, arrays=arrays) + "---\n")
            sys.stdout.flush()
            shown += 1
            dropped = _tell_dropped(sample, dropped)
            if shown == count:
                return
        _ended(shown, count)


def _tell_dropped(sample: Sample, before: int) -> int:
    if sample.dropped > before:
        print_diagnostic(
            OUTPUT_SLOW.diagnostic(
                f"{sample.dropped - before} messages were dropped because they arrived faster than "
                "they could be printed",
                values={"topic": sample.topic, "dropped": sample.dropped - before},
            )
        )
    return sample.dropped


def _ended(shown: int, count: int | None) -> None:
    if count is not None:
        raise CartwheelError(
            f"the simulation ended after {shown} of {count} messages",
            code=SIMULATION_ENDED,
            values={"messages": shown, "wanted": count},
        )
    note("the simulation has ended")


def ends_quietly(count: int | None) -> Any:
    """Lets Ctrl-C end a command without a count with status 0, as it is the normal way."""
    if count is not None:
        return contextlib.nullcontext()
    return contextlib.suppress(interrupts.Interrupted)


def pick(message: Any, path: str) -> Any:
    """A field of a message, by a path such as ``transforms[0].transform.translation.x``.

    Raises:
        GraphError: The message has no such field.
    """
    value = message
    done = ""
    for part in re.findall(r"[^.\[\]]+", path):
        if part.isdecimal() and hasattr(value, "__len__") and not isinstance(value, str):
            if int(part) >= len(value):
                raise GraphError(
                    f'"{path}" does not exist because "{done}" has only '
                    f"{_many(len(value), 'element')}",
                    code=FIELD_UNKNOWN,
                    values={"field": path},
                )
            value = value[int(part)]
        elif hasattr(value, "__msgtype__"):
            names = [name for name in value.__dataclass_fields__ if not name.startswith("__")]
            if part not in names:
                raise GraphError(
                    f'{value.__msgtype__} has no field "{part}"',
                    code=FIELD_UNKNOWN,
                    hint=suggestion(part, names),
                    values={"field": part, "type": value.__msgtype__},
                )
            value = getattr(value, part)
        else:
            raise GraphError(
                f'"{done}" has no field "{part}"', code=FIELD_UNKNOWN, values={"field": part}
            )
        done = f"{done}.{part}".lstrip(".")
    return value


def publish(
    sim: str | None,
    topic: str,
    type_name: str,
    words: Sequence[str],
    *,
    rate: float | None,
    count: int | None,
) -> None:
    """Publishes once, or at a rate of wall time."""
    if rate is not None and not 0 < rate <= 10_000:
        raise CartwheelError(
            f"--rate must be above 0 and at most 10000 Hz (got {rate:g})",
            code=OPTION_INVALID,
            values={"option": "--rate", "value": rate},
        )
    message = parse_yaml(words)
    with connect(sim) as client:
        readers = _publish_once(client, topic, type_name, message)
        if rate is None:
            note(f"published to {topic}: {_many(readers, 'subscriber')}")
            return
        note(f"publishing to {topic} at {rate:g} Hz; press Ctrl-C to stop")
        sent = 1
        due = time.monotonic()
        with ends_quietly(count):
            while count is None or sent < count:
                due += 1 / rate
                time.sleep(max(0.0, due - time.monotonic()))
                client.publish(topic, type_name, message)
                sent += 1


def _publish_once(client: ControlClient, topic: str, type_name: str, message: Any) -> int:
    answer = client.request("publish", topic=topic, type=type_name, message=message)
    if not answer["subscribers"]:
        hint = suggestion(topic, answer["topics"]) if answer["topics"] else ""
        print_diagnostic(
            MESSAGE_UNREAD.diagnostic(
                f"{topic} has no subscribers", hint=hint, values={"topic": topic}
            )
        )
    return int(answer["subscribers"])


def _many(count: int, what: str) -> str:
    return f"{count} {what}{'' if count == 1 else 's'}"
