"""Converts descriptions to fully expanded URDF text."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from cartwheel.codes.files import WRONG_KIND
from cartwheel.description.loading import open_description
from cartwheel.description.xml_text import write_xml
from cartwheel.errors import DescriptionError


def to_urdf(
    path: Path | str,
    *,
    arguments: Mapping[str, str] | None = None,
    package_path: Sequence[Path] = (),
    absolute: bool = False,
) -> str:
    """Converts a xacro or URDF file to plain URDF. The output is deterministic.

    Args:
        path: The file.
        arguments: Values of ``name:=value`` arguments.
        package_path: Additional folders to search for packages.
        absolute: Whether to replace the URIs of meshes and textures by ``file://`` URIs of the
            files found here.

    Raises:
        DescriptionError: The file cannot be expanded, or is not a URDF.
    """
    read = open_description(path, arguments or {}, package_path)
    if read.root.tag != "robot":
        raise DescriptionError(
            f"the file is not a URDF file: its root element is <{read.root.tag}>",
            code=WRONG_KIND,
            origin=read.root.origin,
            values={"kind": read.root.tag},
        )
    return write_xml(read.root, read.packages if absolute else None)
