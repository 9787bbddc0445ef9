"""``cartwheel explain``: what a diagnostic code means."""

from __future__ import annotations

from typing import Annotated

from cartwheel.cli import help


def explain(
    codes: Annotated[
        list[str] | None,
        help.argument("[CODE]...", "Code (CW204) or name (file-missing). Default: list all codes."),
    ] = None,
    json: Annotated[bool, help.option("--json", "Print the explanation as JSON.")] = False,
) -> None:
    """Explain a diagnostic code, or list all codes."""
    from cartwheel.cli.commands import explain as work

    work.explain(codes or [], json=json)
