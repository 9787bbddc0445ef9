"""XML text as a tree of nodes that know their places.

Expat reads the text: its line is that of an element's first character, it fetches nothing,
and it is at hand without an import that a quick start would feel. Tags and attributes keep
their prefixes as written, as Gazebo's own reader does.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Protocol
from xml.parsers import expat

from cartwheel.codes import files as codes
from cartwheel.codes import tags
from cartwheel.description.elements import numbers
from cartwheel.description.elements.node import Node, copied, needs_xacro, to_element
from cartwheel.description.elements.unread import unread
from cartwheel.description.rewritten import original
from cartwheel.errors import DescriptionError, Diagnostic, Origin, Value

__all__ = [
    "Handler", "Node", "copied", "near_files", "needs_xacro", "parse", "read_bytes", "read_file",
    "run_expat", "shown_path", "to_element", "unread",
]  # fmt: skip

MAX_BYTES = 64 * 1024 * 1024
"""Larger than any description; stops meshes or bags that were passed by mistake."""
# Possessive: otherwise there would be two ways to separate consecutive comments.
_LATE_DECLARATION = re.compile(r"\A(?>\s+|<!--.*?-->)++<\?xml.*?\?>", re.DOTALL)
_LATE_DECLARATION_BYTES = re.compile(_LATE_DECLARATION.pattern.encode(), re.DOTALL)
# An unterminated comment extends to the end of the text. Otherwise the rest would be searched again
# from each start of a comment.
_COMMENT = re.compile(r"(?s)<!--(.*?)(-->|\Z)|<!\[CDATA\[.*?(?:\]\]>|\Z)")
_COMMENT_BYTES = re.compile(_COMMENT.pattern.encode())
# Possessive: otherwise there would be two ways to separate consecutive comments.
_HEAD = re.compile(
    r"\A(?:[^<]|<!--.*?-->|<\?.*?\?>|<!DOCTYPE[^<>\[]*>)*+(?=<(?:sdf|gazebo)[\s>/])", re.DOTALL
)
_HEAD_BYTES = re.compile(_HEAD.pattern.encode(), re.DOTALL)
_HEAD_TEXT = re.compile(r"(<!--.*?-->|<\?.*?\?>|<![^>]*>|\A\ufeff)|[^<\s]++", re.DOTALL)
_HEAD_TEXT_BYTES = re.compile(
    rb"(<!--.*?-->|<\?.*?\?>|<![^>]*>|\A\xef\xbb\xbf)|[^<\s]++", re.DOTALL
)
_SHOWN = 60
"""Maximum number of characters of an ignored text that are shown."""
MAX_DEPTH = 100
"""Deeper nesting indicates a damaged file, and would exceed Python's recursion limit."""


def shown_path(path: Path) -> str:
    """A path for messages: relative to the current folder if it is inside.

    That of the original for a copy that a launch file changes.
    """
    path = original(path)
    try:
        return str(path.absolute().relative_to(Path.cwd()))
    except (ValueError, OSError):
        return str(path.absolute())


def read_bytes(path: Path) -> bytes:
    """A file's contents; raises a `DescriptionError` if it is missing, not a regular file or too
    large.
    """
    origin = Origin(file=shown_path(path))
    try:
        if path.is_dir():
            raise _unreadable("the path is a folder, not a file", origin)
        if path.exists() and not path.is_file():
            raise _unreadable("the path is not a regular file", origin)
        if path.stat().st_size > MAX_BYTES:
            raise _unreadable(f"the file is larger than {MAX_BYTES >> 20} MiB", origin)
        content = path.read_bytes()
    except FileNotFoundError:
        meant, hint = near_files(path)
        raise DescriptionError(
            "the file does not exist",
            code=codes.FILE_MISSING,
            origin=origin,
            hint=hint,
            values={"kind": "file", "name": str(path), "meant": meant},
        ) from None
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise _unreadable(f"the file cannot be read: {reason}", origin) from error
    if not content.strip():
        raise _unreadable("the file is empty", origin)
    if b"\0" in content[:1024] and not content.startswith((b"\xff\xfe", b"\xfe\xff")):
        raise _unreadable(
            "the file is binary, not a description",
            origin,
            "Pass a xacro, URDF, SDF or world file, which is XML text.",
        )
    return content


def _unreadable(message: str, origin: Origin, hint: str | None = None) -> DescriptionError:
    return DescriptionError(message, code=codes.FILE_UNREADABLE, origin=origin, hint=hint)


def near_files(path: Path) -> tuple[str, str]:
    """The likely name of a file that does not exist, or an empty string, and the hint."""
    try:
        names = [entry.name for _, entry in zip(range(2000), path.parent.iterdir(), strict=False)]
    except OSError:
        return "", f'The folder "{path.parent}" does not exist either.'
    near = numbers.likely(path.name, names)
    return near or "", f'Did you mean "{near}"?' if near else ""


def read_file(path: Path) -> Node:
    """The tree of an XML file."""
    return parse(read_bytes(path), shown_path(path))


def readable_file(path: Path) -> Node | None:
    """The tree of an XML file; None if it cannot be read."""
    try:
        return read_file(path)
    except DescriptionError:
        return None


def parse(text: str | bytes, file: str = "<string>") -> Node:
    """The tree of an XML text.

    Args:
        text: The XML; bytes are decoded according to the XML declaration.
        file: File name for errors and origins.

    Raises:
        DescriptionError: The text is not well-formed XML, is nested too deeply, or declares
            entities, which robots do not need and which can expand without limit.
    """
    builder = _Builder(file)
    plain = _without_head_text(text)
    run_expat(plain, file, builder)
    assert builder.root is not None
    if plain != text:
        builder.root.notes = tuple(_head_text_ignored(text, builder.root))
    return builder.root


class _Builder:
    """Creates nodes from expat's events."""

    def __init__(self, file: str) -> None:
        self.file = file
        self.root: Node | None = None
        self._open: list[Node] = []
        self._texts: list[list[str]] = []

    def start(self, tag: str, attributes: dict[str, str], line: int) -> None:
        """An element begins."""
        node = Node(tag, attributes, Origin(file=self.file, line=line))
        if self._open:
            self._open[-1].children.append(node)
        else:
            self.root = node
        self._open.append(node)
        self._texts.append([])

    def end(self) -> None:
        """The innermost element ends."""
        self._open.pop().text = "".join(self._texts.pop()).strip()

    def data(self, text: str) -> None:
        """Text of the innermost element."""
        self._texts[-1].append(text)


class Handler(Protocol):
    """Receives the events of `run_expat`; xacro uses a different tree than the other readers."""

    def start(self, tag: str, attributes: dict[str, str], line: int) -> None:
        """An element begins on this line."""

    def end(self) -> None:
        """The innermost element ends."""

    def data(self, text: str) -> None:
        """A piece of the innermost element's text."""


_INVALID_TOKEN = expat.errors.codes[expat.errors.XML_ERROR_INVALID_TOKEN]
_DECLARATION = '<?xml version="1.0" encoding="ISO-8859-1"?>'


def run_expat(text: str | bytes, file: str, handler: Handler) -> None:
    """Parses XML; malformed text raises a `DescriptionError` with its location."""
    parser = expat.ParserCreate()
    parser.buffer_text = True
    still_open: list[tuple[str, int]] = []

    def start(tag: str, attributes: dict[str, str]) -> None:
        line = parser.CurrentLineNumber
        if len(still_open) >= MAX_DEPTH:
            raise DescriptionError(
                f"elements are nested more than {MAX_DEPTH} levels deep",
                code=codes.XML_MALFORMED,
                origin=Origin(file=file, line=line),
            )
        still_open.append((tag, line))
        handler.start(tag, attributes, line)

    def end(_tag: str) -> None:
        still_open.pop()
        handler.end()

    def entity(name: str, *_: object) -> None:
        raise DescriptionError(
            f'the entity "{name}" is declared, but descriptions may not declare entities',
            code=codes.XML_ENTITY,
            origin=Origin(file=file, line=parser.CurrentLineNumber),
            hint="Use a xacro property instead.",
            values={"name": name},
        )

    parser.StartElementHandler = start
    parser.EndElementHandler = end
    parser.CharacterDataHandler = handler.data
    parser.EntityDeclHandler = entity
    plain = _plain_comments(_declared_first(text))
    try:
        parser.Parse(plain, True)
    except expat.ExpatError as error:
        byte = plain[parser.ErrorByteIndex :][:1] if isinstance(plain, bytes) else b""
        reason, hint = _explain(error, still_open)
        values: dict[str, Value] = {"column": error.offset + 1}
        if error.code == _INVALID_TOKEN and byte > b"\x7f":
            reason = f"the byte 0x{byte.hex()} at column {error.offset + 1} is not UTF-8"
            hint = f"Save the file as UTF-8, or declare its encoding in line 1: {_DECLARATION}"
            values["byte"] = byte[0]
        raise DescriptionError(
            reason,
            code=codes.XML_MALFORMED,
            origin=Origin(file=file, line=error.lineno),
            hint=hint,
            values=values,
        ) from error
    except (ValueError, LookupError) as error:  # encodings that expat or Python do not know
        raise DescriptionError(
            f"the text cannot be decoded: {error}",
            code=codes.XML_MALFORMED,
            origin=Origin(file=file, line=1),
        ) from error
    finally:
        # The handlers refer to the parser: this cycle would keep everything until garbage
        # collection.
        parser.StartElementHandler = parser.EndElementHandler = None
        parser.CharacterDataHandler = parser.EntityDeclHandler = None


def _without_head_text(text: str | bytes) -> str | bytes:
    """The text without what precedes the root element of an SDF file outside of tags.

    Gazebo's reader ignores it, for example a declaration without its first character; expat does
    not. Robots in URDF are also read by programs that reject it.
    """
    if isinstance(text, bytes):
        return _HEAD_BYTES.sub(
            lambda head: _HEAD_TEXT_BYTES.sub(lambda each: each[1] or b" ", head[0]), text
        )
    return _HEAD.sub(lambda head: _HEAD_TEXT.sub(lambda each: each[1] or " ", head[0]), text)


def _head_text_ignored(text: str | bytes, root: Node) -> Iterator[Diagnostic]:
    """A warning about the text that `_without_head_text` removed, at its first line."""
    if isinstance(text, bytes):
        text = text.decode("utf-8", "replace")
    head = _HEAD.match(text)
    first = (each for each in _HEAD_TEXT.finditer(head[0]) if not each[1]) if head else ()
    for each in itertools.islice(first, 1):
        line = text.count("\n", 0, each.start()) + 1
        shown = text[each.start() : head.end() if head else None].partition("\n")[0][:_SHOWN]
        yield tags.TAG_IGNORED.diagnostic(
            f'the text "{shown.strip()}" before <{root.tag}> is ignored',
            origin=Origin(file=root.origin.file, line=line),
            hint="Delete it, because other programs do not read such a file.",
            values={"tag": root.tag, "text": shown.strip()},
        )


def _declared_first(text: str | bytes) -> str | bytes:
    """The text without a declaration that follows blank lines or comments.

    Gazebo's reader accepts it there, and some published worlds contain it; expat does not.
    """
    if isinstance(text, bytes):
        return _LATE_DECLARATION_BYTES.sub(lambda found: b"\n" * found[0].count(b"\n"), text)
    return _LATE_DECLARATION.sub(lambda found: "\n" * found[0].count("\n"), text)


def _plain_comments(text: str | bytes) -> str | bytes:
    """The text without dashes in its comments.

    XML does not allow two consecutive dashes there. Gazebo's reader accepts them, and comments in
    published worlds contain commands such as ``gz topic --pub``; expat does not.
    """
    if isinstance(text, bytes):
        return _COMMENT_BYTES.sub(
            lambda found: b"<!--" + found[1].replace(b"-", b" ") + b"-->" if found[2] else found[0],
            text,
        )
    return _COMMENT.sub(
        lambda found: "<!--" + found[1].replace("-", " ") + "-->" if found[2] else found[0],
        text,
    )


def _explain(error: expat.ExpatError, still_open: list[tuple[str, int]]) -> tuple[str, str | None]:
    codes = expat.errors.codes
    text = expat.ErrorString(error.code) or "unknown error"
    column = error.offset + 1
    inner = f"<{still_open[-1][0]}> in line {still_open[-1][1]}" if still_open else ""
    if error.code == codes[expat.errors.XML_ERROR_TAG_MISMATCH]:
        return f"the closing tag does not match: {inner} is still open", None
    if error.code == codes[expat.errors.XML_ERROR_NO_ELEMENTS]:
        if inner:
            return f"the file ends while {inner} is still open", None
        return "the file is not XML: it contains no element", None
    if error.code == codes[expat.errors.XML_ERROR_SYNTAX] and not still_open:
        return "the file is not XML", "A description begins with <robot> or <sdf>."
    if error.code in (
        codes[expat.errors.XML_ERROR_INVALID_TOKEN],
        codes[expat.errors.XML_ERROR_UNDEFINED_ENTITY],
    ):
        return (
            f"malformed XML at column {column}: {text}",
            "In text and attribute values, write & as &amp; and < as &lt;.",
        )
    if error.code == codes[expat.errors.XML_ERROR_MISPLACED_XML_PI]:
        return "<?xml …?> must come first in the file", (
            "Delete everything before it, including blank lines."
        )
    if error.code == codes[expat.errors.XML_ERROR_JUNK_AFTER_DOC_ELEMENT]:
        return "the file continues after the end of the root element", None
    if error.code == codes[expat.errors.XML_ERROR_DUPLICATE_ATTRIBUTE]:
        return "an attribute occurs twice in one element", None
    return f"malformed XML at column {column}: {text}", None
