"""The connection of this process to a Ray cluster."""

from __future__ import annotations

import contextlib
import importlib
import os
import secrets
import signal
import socket
import tempfile
import threading
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from cartwheel.codes.wires import PACKAGE_MISSING
from cartwheel.codes.world import CLUSTER_UNUSABLE
from cartwheel.errors import CartwheelError

LOCAL = "local"
"""The address of a cluster on this computer that ends with the sweep."""

_STORE_BYTES = 128 << 20
"""Memory that a local cluster reserves for what is sent to its processes."""
_REACH = 10.0
"""Wall time in which a connection must be accepted, s."""
_HINT = "Start a cluster with: ray start --head. It prints its address, such as 192.168.1.10:6379."


@contextlib.contextmanager
def connected(address: str, count: int | None) -> Iterator[Any]:
    """Connects to a cluster within the block; yields the module ``ray``.

    If the program is already connected to a cluster, that connection is used and stays open.

    Args:
        address: "auto", `LOCAL`, or the address of the cluster, as for ``ray.init``.
        count: Number of processors of a local cluster; None for those of this computer.

    Raises:
        CartwheelError: Ray is not installed, or the cluster cannot be reached or started.
    """
    try:
        import ray
    except ImportError as error:
        raise CartwheelError(
            f"a sweep on a cluster requires the package ray: {error}",
            code=PACKAGE_MISSING,
            hint='Install it with: pip install "cartwheel[ray]"',
            values={"package": "ray", "extra": "ray"},
        ) from None
    if ray.is_initialized():
        yield ray
        return
    options: dict[str, Any] = {"address": address, "log_to_driver": False, "logging_level": "ERROR"}
    with contextlib.ExitStack() as stack:
        stack.enter_context(_signals())
        # Ray prints each end of a process on standard output, where a program may print its table.
        stack.enter_context(_internals("ray._private.worker", print_to_stdstream=_ignore))
        if address == LOCAL:
            _provide_token()
            stack.enter_context(_environment({"RAY_USAGE_STATS_ENABLED": "0"}))
            # On Linux, Ray otherwise replaces 127.0.0.1 by the address of another interface. It
            # reads the environment variable of this setting only when it is imported.
            constants = "ray._private.ray_constants"
            stack.enter_context(_internals(constants, ENABLE_RAY_CLUSTER=False))
            folder = tempfile.TemporaryDirectory(
                prefix="cw-ray-", dir=_short_folder(), ignore_cleanup_errors=True
            )
            options |= {
                "num_cpus": count,
                "object_store_memory": _STORE_BYTES,
                "include_dashboard": False,
                "_temp_dir": stack.enter_context(folder),
            }
        else:
            _check_address(address)
        stack.callback(ray.shutdown)
        try:
            ray.init(**options)
        except (ConnectionError, RuntimeError, ValueError, OSError, ImportError) as error:
            raise unusable(
                f'the Ray cluster "{address}" cannot be used: {_sentence(error)}',
                hint=_HINT if isinstance(error, ConnectionError) else "",
            ) from error
        yield ray


def _check_address(address: str) -> None:
    """Raises an error if nothing accepts connections at the address. Ray tries this for minutes."""
    if address == "auto":
        address = os.environ.get("RAY_ADDRESS", "auto")
    scheme, _, place = address.rpartition("://")
    if address == "auto" or scheme not in ("", "ray"):
        return
    host, _, port = place.rpartition(":")
    try:
        socket.create_connection((host.strip("[]"), int(port)), _REACH).close()
    except (OSError, ValueError) as error:
        raise unusable(
            f'no Ray cluster can be reached at the address "{address}": {_sentence(error)}',
            hint=_HINT,
        ) from None


def unusable(message: str, *, hint: str = "") -> CartwheelError:
    """The error of a cluster that cannot run a sweep."""
    return CartwheelError(message, code=CLUSTER_UNUSABLE, hint=hint)


def _sentence(error: Exception) -> str:
    lines = str(error).strip().splitlines() or [type(error).__name__]
    return lines[0].rstrip(".")


@contextlib.contextmanager
def _signals() -> Iterator[None]:
    """Restores the handler of SIGTERM, which Ray replaces."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    handler = signal.getsignal(signal.SIGTERM)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, handler)


@contextlib.contextmanager
def _internals(module: str, **values: Any) -> Iterator[None]:
    """Changes variables of one of Ray's modules within the block, if it has them."""
    changed = importlib.import_module(module)
    before = {name: getattr(changed, name) for name in values if hasattr(changed, name)}
    for name in before:
        setattr(changed, name, values[name])
    try:
        yield
    finally:
        for name, value in before.items():
            setattr(changed, name, value)


def _provide_token() -> None:
    """Sets a token for clusters that this program starts; programs without it are rejected.

    Otherwise, Ray writes one to the home folder. Ray keeps the first token of a process, so it must
    not change.
    """
    if "RAY_AUTH_TOKEN" in os.environ or "RAY_AUTH_TOKEN_PATH" in os.environ:
        return
    if not (Path.home() / ".ray" / "auth_token").exists():
        os.environ["RAY_AUTH_TOKEN"] = secrets.token_hex(32)


@contextlib.contextmanager
def _environment(changes: Mapping[str, str]) -> Iterator[None]:
    """Sets environment variables within the block. Ray reads some settings only from them."""
    before = {name: os.environ.get(name) for name in changes}
    os.environ.update(changes)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


def _ignore(*_: object, **__: object) -> None:
    pass


def _short_folder() -> str | None:
    """A folder for temporary files whose path leaves space for Ray's sockets (107 bytes)."""
    return "/tmp" if Path("/tmp").is_dir() else None  # noqa: S108 - the folder inside is private
