"""ROS 2 beside the simulation: a program on Fast DDS that a test controls."""

from __future__ import annotations

import contextlib
import fcntl
import functools
import hashlib
import os
import shutil
import subprocess
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

from tests.bridges.ros1_peers import wait_for
from tests.bridges.running import Running
from tests.reserved import dds_domains

from cartwheel.bridges.ros2 import Parameter, Ros2Bridge
from cartwheel.messages import decode_cdr, encode_cdr, from_dict
from cartwheel.messages.ros2.types import dds_name, ros2_name, ros2_service
from cartwheel.session import Session

SOURCE = Path(__file__).with_name("fastdds_peer.cpp")
HEADER = Path("/usr/include/fastdds/dds/domain/DomainParticipant.hpp")
_there = HEADER.exists() and shutil.which("g++") is not None
REASON = "" if _there else "not installed: g++, libfastrtps-dev"
DOMAIN = dds_domains()
"""And the six after it: other tests that run at the same time have others."""


@functools.cache
def fastdds_peer() -> Path:
    """The program, built once for each of its versions."""
    digest = hashlib.sha256(SOURCE.read_bytes()).hexdigest()[:16]
    cache = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "cartwheel-tests"
    program = cache / f"fastdds_peer-{digest}"
    cache.mkdir(parents=True, exist_ok=True)
    with program.with_suffix(".lock").open("w") as lock:
        # Another process may be building it.
        fcntl.flock(lock, fcntl.LOCK_EX)
        if program.exists():
            return program
        made = program.with_suffix(f".{os.getpid()}")
        subprocess.run(
            ["g++", "-O1", "-std=c++17", SOURCE, "-o", made, "-lfastrtps", "-lfastcdr"],
            check=True,
        )
        return made.replace(program)


class Peer:
    """The program while it runs; `lines` is what it said."""

    def __init__(self, domain: int = DOMAIN, **environment: str) -> None:
        self.lines: list[list[str]] = []
        self.process = subprocess.Popen(
            [fastdds_peer(), str(domain)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env={**os.environ, **environment},
        )
        self._thread = threading.Thread(target=self._read, daemon=True)
        self._thread.start()

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self.lines.append(line.rstrip("\n").split(" "))

    def tell(self, *words: object) -> None:
        assert self.process.stdin is not None
        self.process.stdin.write(" ".join(map(str, words)) + "\n")
        self.process.stdin.flush()

    def subscribe(
        self, topic: str, type_name: str, *, reliable: bool = True, transient: bool = False
    ) -> None:
        self.tell(
            "sub", f"rt{topic}", dds_name(ros2_name(type_name)), int(reliable), int(transient)
        )

    def publish(self, topic: str, type_name: str, values: dict[str, Any]) -> None:
        data = encode_cdr(from_dict(type_name, values))
        self.tell("pub", f"rt{topic}", dds_name(ros2_name(type_name)), data.hex())

    def call(
        self, service: str, type_name: str, values: dict[str, Any], *, hashes: bool = False
    ) -> Any:
        """Calls a service and waits for its response; on demand, with hashes of the types."""
        type_ = ros2_service(type_name)
        data = encode_cdr(from_dict(type_.request, values))
        before = len(self.lines)
        parts = (type_.request_hash, type_.response_hash) if hashes else ()
        reported = [f"typehash={each};" for each in parts]
        self.tell("call", service, type_.dds, data.hex(), *reported)
        answer = wait_for(
            lambda: [
                line
                for line in self.lines[before:]
                if line[0] in ("REPLY", "NO_REPLY") and line[1] == service
            ],
            f"an answer of {service}",
        )[0]
        assert answer[0] == "REPLY", answer
        return decode_cdr(bytes.fromhex(answer[2]), type_.response)

    def received(self, topic: str) -> list[tuple[int, bytes]]:
        """Size and first 4096 bytes of each sample of a topic."""
        return [
            (int(line[2]), bytes.fromhex(line[3]))
            for line in self.lines[:]
            if line[0] == "DATA" and line[1] == f"rt{topic}"
        ]

    def messages(self, topic: str, type_name: str) -> list[Any]:
        """The samples of a topic, none of which may be long."""
        return [decode_cdr(data, type_name) for _, data in self.received(topic)]

    def endpoints(self, kind: str) -> dict[str, list[str]]:
        """Others' writers or readers: type, reliable, transient local, user data."""
        return {line[1]: line[2:] for line in self.lines[:] if line[0] == kind}

    def close(self) -> None:
        """Leaves as programs do."""
        assert self.process.stdin is not None
        with contextlib.suppress(BrokenPipeError):
            self.process.stdin.close()
        try:
            self.process.wait(120)
        except subprocess.TimeoutExpired:
            self.kill()
        self._thread.join()

    def kill(self) -> None:
        """Leaves without a word."""
        self.process.kill()
        self.process.wait()
        self._thread.join()


class Ros2Bridged(Running):
    """A simulation that runs, with a bridge to ROS 2."""

    bridge: Ros2Bridge

    def __init__(
        self,
        *,
        robot: bool = True,
        parameters: Callable[[Session], list[Parameter]] = lambda _: [],
        prepare: Callable[[Session], Any] = lambda _: None,
        **options: Any,
    ) -> None:
        super().__init__(robot=robot)
        self.prepared = prepare(self.session)
        self.bridge = Ros2Bridge(
            self.graph,
            parameters=parameters(self.session),
            report=self.reports.append,
            time_ns=lambda: self.simulation.time_ns,
            **options,
        )
        self.start()

    def wanted(self, topic: str) -> bool:
        """Whether the simulation would publish on a topic."""
        return any(p.wanted for p in self.graph._topics[topic].publishers)
