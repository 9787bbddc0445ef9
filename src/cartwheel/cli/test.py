"""``cartwheel test``: run scenarios."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cartwheel.cli import arguments, help

CASES = "Cases"


def test(  # noqa: PLR0917 - typer passes them by name
    files: Annotated[
        list[Path] | None,
        help.argument("FILE|FOLDER...", "Scenario files, or folders with scenario files."),
    ] = None,
    select: Annotated[
        list[str] | None,
        help.option(
            "-k --select TEXT",
            "Run only cases whose name contains this text, or matches it as a pattern with *. "
            "Can be repeated.",
            CASES,
        ),
    ] = None,
    seeds: Annotated[
        int | None,
        help.option(
            "--seeds N",
            "Run each case with N successive seeds, instead of those in the scenario.",
            CASES,
            min=1,
            max=1_000_000,
        ),
    ] = None,
    seed: Annotated[
        int | None,
        help.option(
            "--seed N",
            "Run each case with this seed; with --seeds, the first seed.",
            CASES,
            min=0,
            max=4294967295,
        ),
    ] = None,
    listed: Annotated[
        bool, help.option("--list", "List the cases, and do not run them.", CASES)
    ] = False,
    resume: Annotated[
        bool,
        help.option(
            "--resume",
            "Run only cases that have not passed since their files were changed.",
            CASES,
        ),
    ] = False,
    jobs: Annotated[
        int | None,
        help.option("-j --jobs N", "Number of processes. Default: one for each core.", min=1),
    ] = None,
    fail_fast: Annotated[
        bool, help.option("-x --fail-fast", "Stop at the first case that fails.")
    ] = False,
    timeout: Annotated[
        float, help.option("--timeout SECONDS", "Maximum wall time of a case.", min=0.1)
    ] = 600.0,
    view: Annotated[
        bool,
        help.option("--view", "Show one case in the web interface, in real time."),
    ] = False,
    allow_launch: Annotated[
        bool,
        help.option(
            "--allow-launch",
            "Allow scenarios to start programs and execute plugin files. Use it only for files you "
            "trust.",
        ),
    ] = False,
    output: Annotated[
        Path,
        help.option(
            "-o --output FOLDER",
            "Folder for the results, the HTML report, pictures and recordings.",
            help.REPORT,
        ),
    ] = Path("cartwheel-results"),
    record: Annotated[
        str,
        help.option("--record WHICH", "Cases to record: failures, all or none.", help.REPORT),
    ] = "failures",
    pictures: Annotated[
        str,
        help.option(
            "--pictures WHICH", "Cases with a picture: failures, all or none.", help.REPORT
        ),
    ] = "failures",
    junit: Annotated[
        Path | None, help.option("--junit FILE", "Also write JUnit XML to this file.", help.REPORT)
    ] = None,
    json: Annotated[bool, help.option("--json", "Print the results as JSON.", help.REPORT)] = False,
    schema: Annotated[
        bool,
        help.option("--schema", "Print the JSON Schema of scenarios, for editors.", help.REPORT),
    ] = False,
    plugin: arguments.Plugin = None,
    package_path: arguments.PackagePath = None,
) -> None:
    """Run scenarios with robots and check expectations.

    The exit status is 0 if all cases pass, 1 if a case fails, 2 if a scenario or an option is
    invalid, and 130 after Ctrl-C.
    """
    from cartwheel.cli.commands import test as work

    if schema:
        work.print_schema()
        return
    status = work.test(
        work.Request(
            files=tuple(files or ()),
            select=tuple(select or ()),
            seeds=seeds,
            seed=seed,
            listed=listed,
            resume=resume,
            jobs=jobs,
            fail_fast=fail_fast,
            timeout=timeout,
            view=view,
            allow_launch=allow_launch,
            output=output,
            record=record,
            pictures=pictures,
            junit=junit,
            json=json,
            package_path=tuple(package_path or ()),
            plugins=tuple(plugin or ()),
        )
    )
    if status:
        raise typer.Exit(status)
