"""Draws ragdolls as capsules between bodies, with numpy alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["draw"]

Floats = NDArray[np.float32]

_SKY, _GROUND = np.array([236.0, 240.0, 245.0]), np.array([196.0, 202.0, 208.0])
_NEAR, _FAR = np.array([38.0, 92.0, 160.0]), np.array([138.0, 170.0, 206.0])


def draw(
    poses: Floats, parents: NDArray[np.int64], height: float = 1.75, size: tuple[int, int] = (320, 240)
) -> NDArray[np.uint8]:
    """Draws a ragdoll from its left and slightly from the front: an array (height, width, 3).

    `poses` (bodies, 7) are positions (metres) and quaternions, `parents` the parent of each body (-1: none), `height` that of the standing ragdoll, `size` the width and
    height in pixels. The camera follows the first body along the ground.
    """
    width, rows = size
    scale = rows / (1.3 * height)
    turn = np.radians(60.0)
    places = poses[:, :3] - poses[0, :3] * np.array([1, 0, 1], np.float32)
    across = np.cos(turn) * places[:, 0] - np.sin(turn) * places[:, 2]
    depth = np.sin(turn) * places[:, 0] + np.cos(turn) * places[:, 2]
    ground = 0.9 * rows
    points = np.stack([width / 2 + scale * across, ground - scale * places[:, 1]], 1)
    picture = np.empty((rows, width, 3))
    picture[:] = _SKY
    picture[int(ground) :] = _GROUND
    y, x = np.mgrid[0:rows, 0:width].astype(np.float64) + 0.5
    span = max(float(np.ptp(depth)), 1e-6)
    for body in np.argsort(depth):
        parent = parents[body]
        a, b = points[body], points[body if parent < 0 else parent]
        along = b - a
        share = ((x - a[0]) * along[0] + (y - a[1]) * along[1]) / max(float(along @ along), 1e-9)
        share = np.clip(share, 0.0, 1.0)
        distance = np.hypot(x - a[0] - share * along[0], y - a[1] - share * along[1])
        cover = np.clip(0.035 * height * scale - distance + 0.5, 0.0, 1.0)[..., None]
        near = (depth[body] - depth.min()) / span
        picture = picture * (1.0 - cover) + (_FAR + near * (_NEAR - _FAR)) * cover
    return np.clip(np.round(picture), 0, 255).astype(np.uint8)
