"""A description in the browser, without physics."""

from __future__ import annotations

import threading
from collections.abc import Mapping, Sequence
from pathlib import Path

from cartwheel.assembly.ports import refuse_taken
from cartwheel.cli import interrupts
from cartwheel.cli.commands.grouping import grouped
from cartwheel.cli.console import paint, say
from cartwheel.cli.showing import print_diagnostic
from cartwheel.gate.access import Access, refused_page


def view(
    file: str,
    values: Mapping[str, str],
    package_path: Sequence[Path],
    *,
    host: str,
    allow_origin: Sequence[str],
    port: int,
) -> None:
    """Shows a robot until Ctrl-C."""
    from cartwheel.description import load_robot
    from cartwheel.viewer import DescriptionViewer

    description = load_robot(file, arguments=values, package_path=package_path)
    access = Access.of(host, allow_origin)
    refuse_taken(host, port)
    for diagnostic in grouped(description.diagnostics):
        if diagnostic.severity != "info":
            print_diagnostic(diagnostic)
    stopped = threading.Event()
    viewer = DescriptionViewer(
        description,
        access=access,
        port=port,
        refused=lambda origin: print_diagnostic(refused_page("the web interface", origin)),
    )
    with interrupts.handled_by(stopped.set, status=0):
        viewer.start()
        say(f"{description.name}  {paint(viewer.url, 'bold', 'cyan')}")
        if access.is_open:
            say("open to other computers with the token in the address")
        say(paint("Press Ctrl-C to stop.", "dim"))
        stopped.wait()
    viewer.close()
