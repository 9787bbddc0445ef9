"""MuJoCo Warp and its devices."""

from __future__ import annotations

import contextlib
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from cartwheel.codes.world import WARP_DEVICE_UNUSABLE, WARP_MISSING, WARP_UNSUPPORTED
from cartwheel.errors import CartwheelError


@dataclass(frozen=True)
class Library:
    """MuJoCo Warp on one device.

    Attributes:
        warp: The module `warp`.
        physics: The module `mujoco_warp`.
        device: Warp's device.
    """

    warp: Any
    physics: Any
    device: Any

    @contextlib.contextmanager
    def used(self) -> Iterator[None]:
        """Uses the device within the block, without the libraries' messages for developers."""
        with _quiet(self.warp), warnings.catch_warnings(), self.warp.ScopedDevice(self.device):
            warnings.filterwarnings("ignore", module=r"mujoco_warp\.")
            yield


def library(device: str) -> Library:
    """Imports MuJoCo Warp.

    Args:
        device: Warp's name of a device, such as ``cuda:0`` or ``cpu``.

    Raises:
        CartwheelError: It is not installed, or cannot use the device.
    """
    try:
        import mujoco_warp
        import warp
    except ImportError as error:
        raise CartwheelError(
            f'backend="warp" requires the packages mujoco-warp and warp-lang: {error}',
            code=WARP_MISSING,
            hint='Install them: pip install "cartwheel[warp]".',
        ) from None
    with _quiet(warp):
        warp.init()
        try:
            found = warp.get_device(device)
        except (ValueError, RuntimeError) as error:
            devices = tuple(str(each) for each in warp.get_devices())
            raise CartwheelError(
                f'Warp has no device "{device}": {error}',
                code=WARP_DEVICE_UNUSABLE,
                values={"device": device, "devices": devices},
                hint=f'Its devices are {", ".join(devices)}. On the device "cpu", a Warp batch is '
                "only a test: a batch without Warp is many times faster.",
            ) from None
    return Library(warp, mujoco_warp, found)


def unsupported(feature: str, hint: str = "") -> CartwheelError:
    """The error of a world that MuJoCo Warp would simulate differently, or not at all."""
    return CartwheelError(
        f"a Warp batch cannot simulate {feature}",
        code=WARP_UNSUPPORTED,
        hint=hint or 'Make the batch without backend="warp".',
        values={"feature": feature},
    )


@contextlib.contextmanager
def _quiet(warp: Any) -> Iterator[None]:
    level = warp.config.log_level
    if level == warp.LOG_INFO:
        # By default, it reports each kernel that it compiles, and a missing GPU.
        warp.config.log_level = warp.LOG_ERROR
    try:
        yield
    finally:
        warp.config.log_level = level
