"""Many worlds that run together, with actions and observations as arrays."""

from cartwheel.batch.batch import Batch
from cartwheel.batch.plan import Actions, Apply, Observation, Observations, Vary
from cartwheel.batch.pose import PoseOf

__all__ = ["Actions", "Apply", "Batch", "Observation", "Observations", "PoseOf", "Vary"]
