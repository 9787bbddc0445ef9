"""Environments for reinforcement learning, for Gymnasium.

Install them with ``pip install "cartwheel[gym]"``.
"""

from cartwheel.gym.env import Env
from cartwheel.gym.task import Task
from cartwheel.gym.variation import Variation, vary
from cartwheel.gym.vector import VectorEnv

__all__ = ["Env", "Task", "Variation", "VectorEnv", "vary"]
