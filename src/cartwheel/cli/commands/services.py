"""Services of a running simulation."""

from __future__ import annotations

from collections.abc import Sequence

from cartwheel.cli.commands.clients import connect, parse_yaml
from cartwheel.cli.console import say, table


def print_list(sim: str | None, *, verbose: bool) -> None:
    """The names, or a table."""
    with connect(sim) as client:
        found = client.request("services")["services"]
    if not found:
        return
    if verbose:
        say(table([one["name"], one["type"], one["node"]] for one in found))
    else:
        for one in found:
            say(one["name"])


def call(sim: str | None, service: str, words: Sequence[str]) -> None:
    """Calls a service and prints the response as YAML."""
    request = parse_yaml(words)
    with connect(sim) as client:
        answer = client.request("call", service=service, request=request)
    from cartwheel.control.types import register_types
    from cartwheel.messages import from_dict, to_yaml

    register_types(answer["types"])
    text = to_yaml(from_dict(answer["type"], answer["response"]), full=True)
    if text:
        say(text.rstrip("\n"))
