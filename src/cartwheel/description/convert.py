"""Descriptions as URDF text, with everything in them expanded."""

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
    """A xacro or URDF file as plain URDF; the same files and arguments give the same text.

    Args:
        path: The file.
        arguments: The values of ``name:=value``.
        package_path: Further folders in which packages are looked for.
        absolute: Whether meshes and textures are named by ``file://`` and where they lie
            here, instead of as written.

    Raises:
        DescriptionError: the file cannot be expanded, or is no URDF.
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
