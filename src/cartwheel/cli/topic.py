"""``cartwheel topic``: what is published, and who reads it."""

from __future__ import annotations

from typing import Annotated

import typer

from cartwheel.cli.arguments import Sim

app = typer.Typer(help="List, print, measure and write topics.", no_args_is_help=True)

Topic = Annotated[str, typer.Argument(metavar="TOPIC", show_default=False)]


@app.command("list")
def list_topics(
    verbose: Annotated[
        bool,
        typer.Option("-v", "--verbose", help="Also types, rates and who is at the ends."),
    ] = False,
    sim: Sim = None,
) -> None:
    """List the topics."""
    from cartwheel.cli.commands import topics

    topics.print_list(sim, verbose=verbose)


@app.command()
def info(topic: Topic, sim: Sim = None) -> None:
    """Print a topic's type, publishers and subscribers."""
    from cartwheel.cli.commands import topics

    topics.print_info(sim, topic)


@app.command()
def echo(
    *,
    topic: Topic,
    count: Annotated[
        int | None, typer.Option("-n", "--count", min=1, help="End after so many messages.")
    ] = None,
    no_arr: Annotated[
        bool, typer.Option("--no-arr", "--noarr", help="Leave out what arrays hold.")
    ] = False,
    full: Annotated[bool, typer.Option("--full", help="Print long arrays to their end.")] = False,
    field: Annotated[
        str | None, typer.Option(metavar="A.B.C", help="Print only this field.")
    ] = None,
    sim: Sim = None,
) -> None:
    """Print the messages of a topic."""
    from cartwheel.cli.commands import topics

    topics.echo(sim, topic, count=count, arrays=not no_arr, full=full, field=field)


@app.command()
def hz(
    topic: Topic,
    count: Annotated[
        int | None, typer.Option("-n", "--count", min=1, help="End after so many reports.")
    ] = None,
    window: Annotated[int, typer.Option(min=2, help="Messages to average over.")] = 10_000,
    sim: Sim = None,
) -> None:
    """Measure a topic's rate, in simulated time."""
    from cartwheel.cli.commands import rate

    rate.measure(sim, topic, count=count, window=window)


@app.command()
def pub(
    *,
    topic: Topic,
    type_name: Annotated[str, typer.Argument(metavar="TYPE", show_default=False)],
    message: Annotated[list[str] | None, typer.Argument(metavar="[YAML]...")] = None,
    rate: Annotated[
        float | None, typer.Option("-r", "--rate", metavar="HZ", help="Publish again and again.")
    ] = None,
    once: Annotated[
        bool, typer.Option("-1", "--once", help="Publish once, as without --rate.")
    ] = False,
    count: Annotated[
        int | None, typer.Option("-n", "--count", min=1, help="With --rate: end after so many.")
    ] = None,
    sim: Sim = None,
) -> None:
    """Publish a message: '{linear: {x: 0.5}}', or the fields in their order.

    The type is written geometry_msgs/Twist or geometry_msgs/msg/Twist.
    """
    from cartwheel.cli.commands import topics

    topics.publish(sim, topic, type_name, message or [], rate=None if once else rate, count=count)
