"""``cartwheel topic``: topics with their publishers and subscribers."""

from __future__ import annotations

from typing import Annotated

import typer

from cartwheel.cli import help
from cartwheel.cli.arguments import Sim

app = typer.Typer(
    cls=help.Group,
    help="List and print topics, measure their rate, and publish messages.",
    no_args_is_help=True,
)

Topic = Annotated[str, help.argument("TOPIC", "Name of the topic.")]


@app.command("list", cls=help.Command)
def list_topics(
    verbose: Annotated[
        bool, help.option("-v --verbose", "Also show types, rates, publishers and subscribers.")
    ] = False,
    sim: Sim = None,
) -> None:
    """List topics."""
    from cartwheel.cli.commands import topics

    topics.print_list(sim, verbose=verbose)


@app.command(cls=help.Command)
def info(topic: Topic, sim: Sim = None) -> None:
    """Show the type, publishers and subscribers of a topic."""
    from cartwheel.cli.commands import topics

    topics.print_info(sim, topic)


@app.command(cls=help.Command)
def echo(
    *,
    topic: Topic,
    count: Annotated[
        int | None, help.option("-n --count N", "Stop after N messages.", min=1)
    ] = None,
    no_arr: Annotated[
        bool, help.option("--no-arr --noarr", "Do not print the values of arrays.")
    ] = False,
    full: Annotated[bool, help.option("--full", "Print long arrays in full.")] = False,
    field: Annotated[str | None, help.option("--field A.B.C", "Print only this field.")] = None,
    sim: Sim = None,
) -> None:
    """Print the messages of a topic as they arrive."""
    from cartwheel.cli.commands import topics

    topics.echo(sim, topic, count=count, arrays=not no_arr, full=full, field=field)


@app.command(cls=help.Command)
def hz(
    topic: Topic,
    count: Annotated[
        int | None, help.option("-n --count N", "Stop after N measurements, one per second.", min=1)
    ] = None,
    window: Annotated[
        int, help.option("--window N", "Average over the last N messages.", min=2)
    ] = 10_000,
    sim: Sim = None,
) -> None:
    """Measure the publish rate of a topic in simulated time."""
    from cartwheel.cli.commands import rate

    rate.measure(sim, topic, count=count, window=window)


@app.command(cls=help.Command)
def pub(
    *,
    topic: Topic,
    type_name: Annotated[
        str,
        help.argument(
            "TYPE", "Message type, such as geometry_msgs/Twist or geometry_msgs/msg/Twist."
        ),
    ],
    message: Annotated[
        list[str] | None,
        help.argument("[YAML]...", "Message. Default: the fields' default values."),
    ] = None,
    rate: Annotated[
        float | None, help.option("-r --rate HZ", "Publish repeatedly at this rate in wall time.")
    ] = None,
    once: Annotated[
        bool, help.option("-1 --once", "Publish once. This is the default without --rate.")
    ] = False,
    count: Annotated[
        int | None, help.option("-n --count N", "With --rate, stop after N messages.", min=1)
    ] = None,
    sim: Sim = None,
) -> None:
    """Publish a message to a topic.

    The message is YAML, such as '{linear: {x: 0.5}}'. Alternatively, pass one value for each field,
    in the order of the fields.
    """
    from cartwheel.cli.commands import topics

    topics.publish(sim, topic, type_name, message or [], rate=None if once else rate, count=count)
