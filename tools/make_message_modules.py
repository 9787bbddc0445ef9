"""Writes src/cartwheel/msgs: a module and its stub for each package with built-in message types.

Usage: python tools/make_message_modules.py [--check]
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator
from itertools import groupby
from pathlib import Path
from typing import Any

import cartwheel.messages
from cartwheel.messages.convert import TIMES
from cartwheel.messages.field import Field
from cartwheel.messages.fields import fields
from cartwheel.messages.store import store

TARGET = Path(cartwheel.messages.__file__).parents[1] / "msgs"
MODULE = '''"""Message types of {package}. Written by `make catalogue`; do not edit."""

from cartwheel.messages.modules import module_functions

__getattr__, __dir__ = module_functions("{package}")
'''
STUB = '''"""Message types of {package}. Written by `make catalogue`; do not edit."""

'''
SCALARS = {"bool": "bool", "int": "int", "float": "float", "string": "str"}


def module_files() -> dict[str, str]:
    """The contents of all generated files by name."""
    made: dict[str, str] = {}
    for package, names in groupby(sorted(store().types), key=lambda name: name.split("/")[0]):
        made[f"{package}.py"] = MODULE.format(package=package)
        made[f"{package}.pyi"] = _stub(package, list(names))
    return made


def _stub(package: str, names: Iterable[str]) -> str:
    classes = ["\n".join(_class(package, name)) for name in names]
    text = "\n\n".join(classes)
    others = sorted(
        {field.type.split("/")[0] for name in names for field in fields(name) if "/" in field.type}
        - {package}
    )
    imports = ["from dataclasses import dataclass", "from typing import ClassVar"]
    if "ArrayLike" in text:
        imports += ["", "import numpy as np", "from numpy.typing import ArrayLike"]
    if ": _converted." in text:
        others.insert(0, "_converted")
    if others:
        imports += ["", *_import(others)]
    return STUB.format(package=package) + "\n".join(imports) + "\n\n" + text + "\n"


def _import(packages: list[str]) -> list[str]:
    line = f"from cartwheel.msgs import {', '.join(packages)}"
    if len(line) <= 100:
        return [line]
    return ["from cartwheel.msgs import (", *(f"    {each}," for each in packages), ")"]


def _class(package: str, name: str) -> Iterator[str]:
    """The stub of a class. All fields have default values, which stubs write as an ellipsis."""
    known = [(field.name, _type(package, field), _given(package, field)) for field in fields(name)]
    converts = any(kind != given for _, kind, given in known)
    yield "@dataclass(init=False)" if converts else "@dataclass"
    yield f"class {name.split('/')[2]}:"
    yield "    __msgtype__: ClassVar[str]"
    for constant, _, value in store().fielddefs[name][0]:
        yield f"    {constant}: ClassVar[{type(value).__name__}]"
    for each in fields(name):
        yield f"    {each.name}: {_declared(package, each)} = ..."
    if converts:
        yield "    def __init__("
        yield "        self,"
        for field, _, given in known:
            line = f"        {field}: {given} = ...,"
            yield line if len(line) <= 100 else line.replace(" | ", "\n        | ")
        yield "    ) -> None: ..."


def _declared(package: str, field: Field) -> str:
    """The type of a field, and of what can be assigned to it."""
    kind = _type(package, field)
    if kind == _given(package, field):
        return kind
    inner = kind.partition("[")[2].removesuffix("]")
    if not field.array:
        return f"_converted.Time[{kind}]"
    return f"_converted.{'List' if field.kind in ('message', 'string') else 'Array'}[{inner}]"


def _type(package: str, field: Field) -> str:
    """The type of a field."""
    one = _one(package, field)
    if not field.array:
        return one
    if field.kind in ("message", "string"):
        return f"list[{one}]"
    return f"NDArray[np.{'bool_' if field.kind == 'bool' else field.type}]"


def _given(package: str, field: Field) -> str:
    """The type of what is accepted for a field when a message is made; see `checked`."""
    one = _one(package, field)
    if not field.array:
        return f"{one} | float" if field.type in TIMES else one
    if field.kind in ("message", "string"):
        return f"list[{one}] | tuple[{one}, ...]"
    return "ArrayLike"


def _one(package: str, field: Field) -> str:
    if field.kind != "message":
        return SCALARS[field.kind]
    other, _, rest = field.type.partition("/")
    name = rest.partition("/")[2]
    return name if other == package else f"{other}.{name}"


def _differences(made: dict[str, Any]) -> list[str]:
    present = {
        path.name: path.read_text()
        for path in TARGET.glob("*.py*")
        if path.is_file() and not path.name.startswith("_")
    }
    return sorted(
        name for name in made.keys() | present.keys() if made.get(name) != present.get(name)
    )


def main() -> None:
    made = module_files()
    different = _differences(made)
    if "--check" in sys.argv[1:]:
        if different:
            sys.exit(f"{', '.join(different)} in {TARGET} is old: run `make catalogue`")
        return
    for name in different:
        if name in made:
            (TARGET / name).write_text(made[name])
        else:
            (TARGET / name).unlink()


if __name__ == "__main__":
    main()
