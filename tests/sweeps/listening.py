"""The processes that a process has started, and the addresses at which they accept connections."""

from __future__ import annotations

import contextlib
import ipaddress
from pathlib import Path

_LISTEN = "0A"


def descendants(pid: int) -> list[int]:
    """Process IDs of all children and their children."""
    parents: dict[int, int] = {}
    for folder in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            stat = (folder / "stat").read_text().rpartition(")")[2].split()
            parents[int(folder.name)] = int(stat[1])
    found = [pid]
    for each in found:
        found += [child for child, parent in parents.items() if parent == each]
    return found[1:]


def listening(pid: int) -> set[str]:
    """IP addresses of the TCP ports of a process."""
    sockets = set()
    for file in Path(f"/proc/{pid}/fd").iterdir():
        with contextlib.suppress(OSError):
            sockets.add(str(file.readlink()))
    found = set()
    for table in ("tcp", "tcp6"):
        for line in Path(f"/proc/{pid}/net/{table}").read_text().splitlines()[1:]:
            words = line.split()
            if words[3] == _LISTEN and f"socket:[{words[9]}]" in sockets:
                found.add(_address(words[1].split(":")[0]))
    return found


def _address(digits: str) -> str:
    """The kernel writes each four bytes in the order of the processor."""
    words = [bytes.fromhex(digits[start : start + 8])[::-1] for start in range(0, len(digits), 8)]
    found = ipaddress.ip_address(b"".join(words))
    mapped = getattr(found, "ipv4_mapped", None)
    return f"::ffff:{mapped}" if mapped else str(found)
