"""Datasets for training: images with labels, depths, scans and poses in files."""

from cartwheel.dataset.dataset import Dataset
from cartwheel.dataset.viewpoint import Viewpoint

__all__ = ["Dataset", "Viewpoint"]
