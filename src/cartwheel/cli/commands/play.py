"""Plays a recording."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from cartwheel.assembly.ports import refuse_taken
from cartwheel.cli import interrupts
from cartwheel.cli.commands.desktop import is_desktop
from cartwheel.cli.commands.info import unfinished
from cartwheel.cli.commands.report import Report
from cartwheel.cli.console import say
from cartwheel.codes.command import OPTION_INVALID
from cartwheel.errors import CartwheelError
from cartwheel.gate.access import Access


@dataclass(frozen=True, kw_only=True, slots=True)
class Options:
    """The user's options."""

    file: Path
    headless: bool
    speed: float | None
    start: float
    """Start time, s after the beginning."""
    loop: bool
    paused: bool
    world: str | None
    host: str
    allow_origin: tuple[str, ...]
    port: int
    open_browser: bool | None
    package_path: tuple[Path, ...]


def play(options: Options) -> None:
    """Plays until the end, or in the browser until Ctrl-C.

    Raises:
        CartwheelError: The recording cannot be played.
    """
    if not 0 <= options.start < math.inf:
        raise CartwheelError(
            f"--start must be finite and not negative (got {options.start:g})",
            code=OPTION_INVALID,
            values={"option": "--start", "value": options.start},
        )
    from cartwheel.bridges.recording.opening import open_recording

    recording = open_recording(options.file)
    access = Access.of(options.host, options.allow_origin)
    if not options.headless:
        refuse_taken(options.host, options.port)
    from cartwheel.control.server import ControlServer
    from cartwheel.description import load_world
    from cartwheel.playback import PlaybackSession

    world = None
    if options.world:
        world = load_world(options.world, package_path=options.package_path)
    played = PlaybackSession(
        recording,
        world=world,
        package_path=options.package_path,
        loop=options.loop,
        hold=not options.headless,
    )
    player = played.simulation
    player.set_speed(options.speed)
    if options.start:
        player.seek(player.start_ns + round(options.start * 1e9))
    if options.paused:
        player.pause()
    report = Report(verbose=False)
    with interrupts.handled_by(player.stop, status=0):
        server = ControlServer(played, title=f"playback of {options.file.name}", load=played.spawn)
        with interrupts.finally_do(server.close):
            length = (player.end_ns - player.start_ns) / 1e9
            say(f"playing {options.file}, {length:.3f} s, {len(recording.topics)} topics")
            if not recording.complete:
                report.diagnostic(unfinished("All messages before the interruption are played."))
            for diagnostic in played.diagnostics:
                report.diagnostic(diagnostic)
            page = None
            if not options.headless:
                from cartwheel.assembly.viewer import AnnouncedViewer
                from cartwheel.viewer.play_desk import PlayDesk

                page = AnnouncedViewer(
                    played,
                    server,
                    report,
                    access=access,
                    port=options.port,
                    open_browser=is_desktop()
                    if options.open_browser is None
                    else options.open_browser,
                    desk=partial(PlayDesk, player=player),
                )
                page.start(player)
            else:
                server.offer_page(None)
            player.run()
            if page is not None:
                page.raise_failure()
    recording.close()
