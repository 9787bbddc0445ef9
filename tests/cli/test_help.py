"""``--help``: every option has a group and a phrase of its own."""

import re

import pytest
import typer

from cartwheel.cli import help as grouping
from cartwheel.cli.app import app

ROOT = typer.main.get_command(app)
COMMANDS = {
    " ".join(path): command
    for name, child in ROOT.commands.items()
    for path, command in (
        [((name,), child)]
        if not hasattr(child, "commands")
        else [((name, inner), leaf) for inner, leaf in child.commands.items()]
    )
}


def sections(text):
    """The titles of a help text and the lines below each."""
    found, title = {}, ""
    for line in text.splitlines():
        if re.fullmatch(r"\S.*:", line):
            title = line[:-1]
        elif title and line.strip():
            found.setdefault(title, []).append(line)
    return found


def test_options_of_run_are_in_groups(program):
    found = sections(program("run", "--help").stdout)
    expected = {
        grouping.WORLD: "--world",
        grouping.ROBOT: "-x",
        grouping.TIME: "--speed",
        grouping.PAGE: "--port",
        grouping.WIRES: "--ros1",
        grouping.RECORDING: "--record",
        grouping.LOOKUP: "--package-path",
        "Options": "--verbose",
    }
    assert list(found) == ["Arguments", *expected]
    for title, option in expected.items():
        assert any(line.startswith(f"  {option} ") for line in found[title]), title


def test_commands_are_in_groups(program):
    found = sections(program("--help").stdout)
    assert list(found) == [
        grouping.SIMULATE,
        grouping.FILES,
        grouping.CONTROL,
        grouping.OTHER,
        "Options",
    ]
    assert any(line.startswith("  topic ") for line in found[grouping.CONTROL])


def test_usage_states_what_is_optional(program):
    usage = program("topic", "pub", "--help").stdout.splitlines()[0]
    assert usage == "Usage: cartwheel topic pub [OPTIONS] TOPIC TYPE [YAML]..."


@pytest.mark.parametrize("name", COMMANDS)
def test_every_parameter_has_a_phrase_of_its_own(name):
    command = COMMANDS[name]
    assert isinstance(command, grouping.Command)
    with command.make_context(name, [], resilient_parsing=True) as context:
        parameters = command.get_params(context)
    for parameter in parameters:
        text = parameter.help or ""
        assert re.match(r"[A-Z].*\.$", text, re.DOTALL), f"{name} {parameter.name}: {text!r}"
        shown, _ = parameter.get_help_record(context)
        assert parameter.metavar or not re.search(r"<(?!\w+\|)", shown), f"{name} {shown}"


@pytest.mark.parametrize("name", COMMANDS)
def test_what_a_command_does_fits_one_line(name):
    """In the list of commands a longer sentence would be cut."""
    text = COMMANDS[name].get_short_help_str(66)
    assert text.endswith("."), name
    assert not text.endswith("..."), name
