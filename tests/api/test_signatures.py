"""What `help` shows of the public classes."""

from __future__ import annotations

import inspect
from collections.abc import Iterator

import pytest

import cartwheel as cw
from cartwheel.session import Session

PUBLIC = sorted(name for name in cw.__all__ if isinstance(getattr(cw, name), type))


def signatures(cls: type) -> Iterator[tuple[str, inspect.Signature]]:
    """The constructor and the public methods of a class."""
    for name, member in inspect.getmembers(cls, callable):
        if name != "__init__" and name.startswith("_"):
            continue
        try:
            yield name, inspect.signature(member)
        except ValueError:  # a function that is written in C
            continue


@pytest.mark.parametrize("name", PUBLIC)
def test_parameters_are_public_and_defaults_are_values(name: str) -> None:
    for method, signature in signatures(getattr(cw, name)):
        for parameter in signature.parameters.values():
            assert not parameter.name.startswith("_"), f"{name}.{method}"
            assert not inspect.isfunction(parameter.default), f"{name}.{method}"


def test_a_world_shows_only_what_programs_use() -> None:
    """The parts of its implementation that other modules use are private."""
    shown = {name for name in dir(cw.World) if not name.startswith("_")}
    assert not shown & {"begin", "finish", "used", "check_open", "is_paced", "close_at_exit"}


def test_worlds_of_a_build_share_the_compiled_models(monkeypatch: pytest.MonkeyPatch) -> None:
    """Also those of a class that a program derives, which has no part in this."""
    given: list[object] = []
    made = Session.__init__

    def remembered(session: Session, *arguments: object, **options: object) -> None:
        given.append(options["compiler"])
        made(session, *arguments, **options)  # type: ignore[arg-type]

    monkeypatch.setattr(Session, "__init__", remembered)
    built = cw.build("empty", "box_small.urdf")
    with built.world(), built.world(seed=1), cw.World("empty"):
        assert given[-1] is None
        assert given[-2] is given[-3] is not None
