"""A stand-in for MuJoCo Warp's device that computes with MuJoCo itself, with all its bits."""

from __future__ import annotations

import copy
from contextlib import nullcontext
from types import SimpleNamespace

import mujoco
import numpy as np
import pytest

from cartwheel.batch.warp import physics
from cartwheel.batch.warp.device import RESULTS

_INPUTS = (*RESULTS, "ctrl", "qfrc_applied", "xfrc_applied", "mocap_pos", "mocap_quat")


class Parameters:
    """The models of all worlds."""

    def __init__(self) -> None:
        self.models: dict[int, mujoco.MjModel] = {}
        self.checks = 0

    def check(self, row, model):
        self.checks += 1

    def watch(self, row, model):
        self.models[row] = model


class Device:
    """As `cartwheel.batch.warp.device.Device`, in double precision."""

    def __init__(self, library, model, data, count) -> None:
        self.parameters = Parameters()
        self.inputs = {
            name: np.zeros((count, *getattr(data, name).shape))
            for name in _INPUTS
            if getattr(data, name, np.zeros(0)).size
        }
        self.equalities = np.zeros((count, data.eq_active.size), dtype=bool)
        self.steps = 0

    def compile(self):
        pass

    def run(self, stops):
        found = [
            {name: values.copy() for name, values in self.inputs.items() if name in RESULTS}
            for _ in stops
        ]
        self.steps += stops[-1]
        for row, model in self.parameters.models.items():
            own = copy.copy(model)
            data = mujoco.MjData(own)
            for name, values in self.inputs.items():
                getattr(data, name)[...] = values[row]
            if data.eq_active.size:
                data.eq_active[:] = self.equalities[row]
            done = 0
            for stop, states in zip(stops, found, strict=True):
                mujoco.mj_step(own, data, stop - done) if stop > done else None
                done = stop
                for name, values in states.items():
                    values[row] = getattr(data, name)
        return found


@pytest.fixture
def without_warp(monkeypatch):
    """Batches with the backend "warp" use the stand-in."""
    library = SimpleNamespace(used=nullcontext)
    monkeypatch.setattr(physics, "library", lambda device: library)
    monkeypatch.setattr(physics, "Device", Device)
