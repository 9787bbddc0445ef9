"""Steps of the physics that another engine than MuJoCo's library computes."""

from __future__ import annotations

import copy
from collections.abc import Iterator
from typing import Any

import mujoco

from cartwheel.simulation.engine import Engine

LEAST_FRICTION = float(mujoco.mjMINMU)
"""The friction coefficient that MuJoCo uses for contacts with a lower one."""
AFFINE: int = mujoco.mjtBias.mjBIAS_AFFINE.value
"""The type of actuators with damping."""
_SLEEP: int = mujoco.mjtEnableBit.mjENBL_SLEEP.value
_RESETS_ITSELF: int = mujoco.mjtDisableBit.mjDSBL_AUTORESET.value
_CALLBACKS = {
    "control": mujoco.get_mjcb_control,
    "passive": mujoco.get_mjcb_passive,
    "contactfilter": mujoco.get_mjcb_contactfilter,
    "act_dyn": mujoco.get_mjcb_act_dyn,
    "act_gain": mujoco.get_mjcb_act_gain,
    "act_bias": mujoco.get_mjcb_act_bias,
}


def physics_of_cartwheel(engine: Engine) -> Iterator[str]:
    """Names of what Python code computes within the steps, which another engine cannot call."""
    if engine.stepping.bounces is not None:
        yield "restitution"
    if engine.stepping.moved is not None:
        yield "models that are fixed to the world and move at a velocity"
    if engine.stepping.followers is not None:
        yield "joints that follow others beyond their own limits"
    if engine.directions is not None and engine.directions.active:
        yield "friction that depends on the direction"
    if engine.model.flg_surfacevel:
        yield "moving surfaces, such as tracks"
    for entry in engine.entries:
        if entry.attachments:
            yield f'links of the model "{entry.name}" that plugins attach to others'
        if entry.slips:
            yield f'wheels of the model "{entry.name}" with slip'
    for name, get in _CALLBACKS.items():
        if get() is not None:
            yield f"the MuJoCo callback mjcb_{name}"


def keep_awake(engine: Engine) -> None:
    """Disables sleep, so that `Engine.forward` computes all bodies."""
    engine.model.opt.enableflags &= ~_SLEEP


def without_sleep(model: Any) -> Any:
    """A copy of a model, with the flags that other engines know: `Engine` checks for divergence."""
    made = copy.copy(model)
    made.opt.enableflags &= ~_SLEEP
    made.opt.disableflags = disabled(model)
    made.tree_sleep_policy[:] = mujoco.mjtSleepPolicy.mjSLEEP_AUTO.value
    return made


def disabled(model: Any) -> int:
    """What is disabled in a model, apart from MuJoCo's own reset of a diverged state."""
    return int(model.opt.disableflags) & ~_RESETS_ITSELF


def count_steps(engine: Engine, count: int) -> None:
    """Advances the time by steps, as `Engine.advance` does. The caller sets the state."""
    engine.step += count
    engine.time_ns += count * engine.step_ns
    engine.refreshed = b""
    step = engine.model.opt.timestep
    # Added as MuJoCo adds it, for the same bits.
    for _ in range(count):
        engine.data.time += step
