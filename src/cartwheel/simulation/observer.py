"""Immutable copies of an engine's state, by link and joint names."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco

from cartwheel.simulation.engine import Engine
from cartwheel.simulation.snapshot import PlacedModel, RunState, Scene, Snapshot
from cartwheel.world.entry import ModelEntry


class Observer:
    """Maps the links and joints of a compiled model to the engine's arrays.

    Args:
        engine: The engine with the model compiled from the entries.
        entries: The models in the world.
        version: The scene version.
    """

    def __init__(self, engine: Engine, entries: Sequence[ModelEntry], version: int) -> None:
        self._engine = engine
        links = [(entry.name, link.name) for entry in entries for link in entry.description.links]
        joints = [
            (entry.name, joint.name)
            for entry in entries
            if not entry.description.static
            for joint in entry.description.joints
            if joint.drivable
        ]
        self._bodies = [engine.body_id(*names) for names in links]
        self._positions = [
            int(engine.model.jnt_qposadr[engine.joint_id(*names)]) for names in joints
        ]
        self.scene = Scene(
            version=version,
            world=engine.world,
            models=tuple(
                PlacedModel(name=entry.name, description=entry.description, pose=entry.pose)
                for entry in entries
            ),
            links=tuple(links),
            joints=tuple(joints),
        )

    def snapshot(
        self, *, run_state: RunState, speed: float | None, real_time_factor: float
    ) -> Snapshot:
        """The current state."""
        engine = self._engine
        mujoco.mj_kinematics(engine.model, engine.data)
        return Snapshot(
            scene=self.scene,
            time_ns=engine.time_ns,
            run_state=run_state,
            speed=speed,
            real_time_factor=real_time_factor,
            positions=engine.data.xpos[self._bodies],
            quaternions=engine.data.xquat[self._bodies],
            joint_positions=engine.data.qpos[self._positions],
        )
