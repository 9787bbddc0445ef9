"""Boxes and masks in the format of COCO.

Source: https://cocodataset.org/#format-data
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Mask = NDArray[np.bool_]


def box_of(mask: Mask) -> list[int]:
    """The box around the pixels of a mask: x, y, width, height in pixels.

    Args:
        mask: Shape (height, width), with at least one pixel.
    """
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    x, y = int(columns[0]), int(rows[0])
    return [x, y, int(columns[-1]) - x + 1, int(rows[-1]) - y + 1]


def run_lengths(mask: Mask) -> dict[str, Any]:
    """A mask as COCO's uncompressed run lengths, along the columns, from a run of zeros."""
    flat = mask.T.reshape(-1).astype(np.int8)
    ends = np.flatnonzero(np.diff(flat)) + 1
    counts = np.diff(np.concatenate([[0], ends, [len(flat)]])).tolist()
    return {"size": list(mask.shape), "counts": [0, *counts] if flat[0] else counts}


def annotation(visible: Mask, whole: Mask) -> dict[str, Any]:
    """The properties of an object in an image.

    Args:
        visible: Its visible pixels, shape (height, width); at least one.
        whole: Its pixels in the image without all other objects.
    """
    whole = whole | visible
    edges = (whole[0], whole[-1], whole[:, 0], whole[:, -1])
    return {
        "bbox": box_of(visible),
        "area": int(visible.sum()),
        "segmentation": run_lengths(visible),
        "iscrowd": 0,
        "whole_bbox": box_of(whole),
        "visible": round(int(visible.sum()) / int(whole.sum()), 6),
        "truncated": bool(any(edge.any() for edge in edges)),
    }
