"""New inputs made from others: bytes, text and XML."""

from __future__ import annotations

import re
import struct
from collections.abc import Sequence
from random import Random
from xml.etree import ElementTree as ET

NUMBERS = [
    *("0", "-1", "1", "2", "-0.0", "0x10", "1e", "1.2.3", "٣", "nan", "inf", "-inf", "1e9", "1e12"),
    *("1e-12", "1e308", "-1e308", "1e-308", "1e400", "255", "256", "65535", "65536", "2147483647"),
    *("2147483648", "4294967295", "-2147483648", "9223372036854775807", "18446744073709551616"),
    "99999999999999999999999999",
]
WORDS = (
    *("", " ", "true", "null", "~", "abc", "1 2 3", "0 0 0", "ü", "\U0001f600", "a" * 300),
    *("../../../../etc/passwd", "/dev/zero", "/", ".", "file:///etc/passwd", "package://x/y"),
    *("model://x", "${x}", "$(find x)", "$(arg x)", "%s%n", "{0}", "a b", "a/b", "//", "base_link"),
)
_LENGTHS = (0, 1, 2, 3, 4, 7, 8, 16, 127, 128, 255, 256, 4096, 65535, 65536, 1 << 20, 1 << 24)
_LENGTHS += ((1 << 31) - 1, 1 << 31, (1 << 32) - 1, (1 << 32) - 4, 1 << 62, (1 << 63) - 1)
_LENGTHS += ((1 << 64) - 1, (1 << 64) - 8)
_NUMBER = re.compile(rb"(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?(?![\w.])")
_WORD = re.compile(rb"[^\s<>\"'=:,/\[\]{}]+")


def binary(data: bytes, others: Sequence[bytes], random: Random) -> bytes:
    """Bytes changed, lengths overwritten, pieces cut, doubled, moved and taken from others."""
    found = bytearray(data)
    for _ in range(random.choice((1, 1, 1, 2, 2, 3, 5, 8))):
        _BINARY[random.randrange(len(_BINARY))](found, others, random)
    return bytes(found)


def _flip(data: bytearray, _others: Sequence[bytes], random: Random) -> None:
    if data:
        data[random.randrange(len(data))] ^= 1 << random.randrange(8)


def _byte(data: bytearray, _others: Sequence[bytes], random: Random) -> None:
    if data:
        data[random.randrange(len(data))] = random.choice((0, 1, 0x7F, 0x80, 0xFF, 0x0A, 0x22))


def _length(data: bytearray, _others: Sequence[bytes], random: Random) -> None:
    """A number that may be a length, of 1 to 8 bytes in either order."""
    size = random.choice((1, 2, 4, 4, 4, 8))
    if len(data) < size:
        return
    at = random.randrange(len(data) - size + 1)
    if random.random() < 0.6:
        at -= at % size
    order = random.choice(("little", "little", "big"))
    old = int.from_bytes(data[at : at + size], order)
    nearby = (old + random.choice((-8, -4, -1, 1, 4, 8)), old * 2, len(data), len(data) - at)
    new = random.choice((*_LENGTHS, *nearby)) % (1 << 8 * size)
    data[at : at + size] = new.to_bytes(size, order)


def _float(data: bytearray, _others: Sequence[bytes], random: Random) -> None:
    form = random.choice(("<d", "<f", ">d", ">f"))
    size = struct.calcsize(form)
    if len(data) >= size:
        value = random.choice((float("nan"), float("inf"), -1.0, 0.0, 1e38, -1e38, 1e-40))
        at = random.randrange(len(data) - size + 1)
        data[at : at + size] = struct.pack(form, value)


def _cut(data: bytearray, _others: Sequence[bytes], random: Random) -> None:
    if data:
        at = random.randrange(len(data))
        del data[at : at + random.choice((1, 2, 4, 16, 64, 1024, len(data)))]


def _double(data: bytearray, _others: Sequence[bytes], random: Random) -> None:
    if data:
        at = random.randrange(len(data))
        piece = data[at : at + random.choice((1, 4, 16, 64, 512))]
        data[at:at] = piece * random.choice((1, 1, 1, 2, 16))


def _noise(data: bytearray, _others: Sequence[bytes], random: Random) -> None:
    at = random.randrange(len(data) + 1)
    data[at:at] = random.randbytes(random.choice((1, 2, 4, 8, 32)))


def _swap(data: bytearray, _others: Sequence[bytes], random: Random) -> None:
    size = random.choice((1, 4, 8, 32))
    if len(data) >= 2 * size:
        a, b = (random.randrange(len(data) - size + 1) for _ in range(2))
        data[a : a + size], data[b : b + size] = data[b : b + size], data[a : a + size]


def _splice(data: bytearray, others: Sequence[bytes], random: Random) -> None:
    """A piece of another input at the same or another place."""
    other = random.choice(others) if others else b""
    if other:
        start = random.randrange(len(other))
        piece = other[start : start + random.choice((4, 16, 64, 512, len(other)))]
        at = start if random.random() < 0.5 else random.randrange(len(data) + 1)
        if random.random() < 0.5:
            data[at : at + len(piece)] = piece
        else:
            data[at:at] = piece


_BINARY = (_flip, _byte, _length, _length, _length, _float, _cut, _double, _noise, _swap, _splice)


def text(data: bytes, others: Sequence[bytes], random: Random) -> bytes:
    """Numbers, words and lines replaced, doubled, moved and indented anew."""
    for _ in range(random.choice((1, 1, 1, 2, 2, 4))):
        kind = random.random()
        if kind < 0.3:
            data = _replaced(data, _NUMBER, NUMBERS, random)
        elif kind < 0.55:
            found = _WORD.findall(random.choice(others) if others else data)[:2000]
            data = _replaced(data, _WORD, (*WORDS, *(f.decode("latin1") for f in found)), random)
        elif kind < 0.85:
            data = _lines(data, others, random)
        else:
            data = binary(data, others, random)
    return data


def _replaced(
    data: bytes, pattern: re.Pattern[bytes], words: Sequence[str], random: Random
) -> bytes:
    places = [match.span() for match in pattern.finditer(data)]
    if not places:
        return data
    start, end = random.choice(places)
    word = random.choice(words)
    return data[:start] + word.encode("utf-8", "surrogateescape") + data[end:]


def _lines(data: bytes, others: Sequence[bytes], random: Random) -> bytes:
    lines = data.splitlines(keepends=True)
    if not lines:
        return data
    at = random.randrange(len(lines))
    some = lines[at : at + random.choice((1, 1, 2, 5, 20))]
    kind = random.randrange(6)
    if kind == 0:
        del lines[at : at + len(some)]
    elif kind == 1:
        lines[at:at] = some * random.choice((1, 1, 3, 30))
    elif kind == 2:
        lines[at : at + len(some)] = [b"  " + line for line in some]
    elif kind == 3:
        lines[at : at + len(some)] = [line[min(2, len(line) - 1) :] for line in some]
    elif kind == 4:
        place = random.randrange(len(lines))
        del lines[at : at + len(some)]
        lines[place:place] = some
    else:
        other = random.choice(others or [data]).splitlines(keepends=True)
        if other:
            start = random.randrange(len(other))
            lines[at:at] = other[start : start + random.choice((1, 3, 10))]
    return b"".join(lines)


def xml(data: bytes, others: Sequence[bytes], random: Random) -> bytes:
    """Elements deleted, doubled, moved, nested and taken from others; values replaced."""
    if random.random() < 0.15:
        return text(data, others, random)
    try:
        root = ET.fromstring(data)
    except (ET.ParseError, ValueError, LookupError):
        return text(data, others, random)
    try:
        for _ in range(random.choice((1, 1, 1, 2, 2, 3, 6))):
            _mutate_tree(root, others, random)
        return ET.tostring(root)
    except RecursionError:  # chains within chains
        return text(data, others, random)


def _mutate_tree(root: ET.Element, others: Sequence[bytes], random: Random) -> None:
    nodes = list(root.iter())
    node = random.choice(nodes)
    kind = random.random()
    if kind < 0.35:
        _mutate_value(node, random)
    elif kind < 0.45:
        names = [each for other in nodes for each in other.attrib.items()]
        if names:
            node.set(*random.choice(names))
    elif kind < 0.5 and node.attrib:
        del node.attrib[random.choice(list(node.attrib))]
    elif kind < 0.55:
        node.tag = random.choice(nodes).tag
    elif kind < 0.65:
        if len(node):
            node.remove(random.choice(list(node)))
    elif kind < 0.95:
        source = random.choice(nodes)
        if kind > 0.88:
            try:
                source = random.choice(list(ET.fromstring(random.choice(others)).iter()))
            except (ET.ParseError, ValueError, LookupError, IndexError):
                return
        copied = ET.fromstring(ET.tostring(source))
        for _ in range(random.choice((1, 1, 1, 1, 2, 30))):
            node.insert(random.randrange(len(node) + 1), copied)
    else:  # a chain of itself
        inner = node
        for _ in range(random.choice((3, 40, 400))):
            inner = ET.SubElement(inner, node.tag, dict(node.attrib))


def _mutate_value(node: ET.Element, random: Random) -> None:
    """A number or word in an attribute or the text."""
    keys: list[str | None] = [*node.attrib, *([None] if (node.text or "").strip() else [])]
    if not keys:
        return
    key = random.choice(keys)
    old = (node.text or "") if key is None else node.attrib[key]
    words = old.split()
    kind = random.random()
    if words and kind < 0.6:
        words[random.randrange(len(words))] = random.choice(NUMBERS)
        new = " ".join(words)
    elif kind < 0.8:
        new = random.choice(WORDS)
    elif kind < 0.9:
        new = old * random.choice((2, 50))
    else:
        new = " ".join(words[: random.randrange(len(words) + 1)])
    if key is None:
        node.text = new
    else:
        node.set(key, new)
