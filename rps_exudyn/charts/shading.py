"""Shaded pictures of triangle meshes: parallel projection, hidden surfaces by a depth buffer.

Matplotlib sorts whole triangles by distance, which fails for parts in mesh; here every pixel is resolved.
"""

import numpy as np

AMBIENT = 0.35  # brightness of a face turned away from the light
OVERSAMPLING = 2  # pixels per shown pixel, each way, averaged for smooth edges


def shaded_image(
    parts: list[tuple[np.ndarray, np.ndarray, tuple[float, float, float]]],
    towards_viewer: np.ndarray,
    up: np.ndarray,
    pixels_wide: int,
) -> np.ndarray:
    """Draw several parts, with the picture's frame around them.

    Args:
        parts: vertices (n, 3), faces (m, 3) and colour (red, green, blue in 0..1) of each.
        towards_viewer: direction from the parts to the eye, shape (3,).
        up: direction that points upwards in the picture, shape (3,).
        pixels_wide: width of the picture.

    Returns:
        Red, green, blue, alpha in 0..1, shape (height, pixels_wide, 4), transparent background.
    """
    axes = _camera(towards_viewer, up)
    triangles = np.concatenate([vertices[faces] for vertices, faces, _ in parts]) @ axes.T
    colours = np.concatenate([np.broadcast_to(colour, (len(faces), 3)) for _, faces, colour in parts])
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    visible = normals[:, 2] > 0
    triangles, colours, normals = triangles[visible], colours[visible], normals[visible]
    light = np.array([-0.4, 0.5, 0.77])
    bright = np.clip(normals @ light / np.linalg.norm(normals, axis=1), 0, 1)
    colours = colours * (AMBIENT + (1 - AMBIENT) * bright[:, None])

    low, high = triangles.reshape(-1, 3).min(axis=0), triangles.reshape(-1, 3).max(axis=0)
    width = pixels_wide * OVERSAMPLING
    scale = width / (high[0] - low[0])
    height = OVERSAMPLING * int(np.ceil((high[1] - low[1]) * scale / OVERSAMPLING))
    triangles = (triangles - [low[0], high[1], 0]) * [scale, -scale, 1]
    image = np.zeros((height, width, 4))
    depth = np.full((height, width), -np.inf)
    for corners, colour in zip(triangles, colours, strict=True):
        _fill(image, depth, corners, colour)
    blocks = image.reshape(height // OVERSAMPLING, OVERSAMPLING, pixels_wide, OVERSAMPLING, 4)
    return blocks.mean(axis=(1, 3))


def _camera(towards_viewer: np.ndarray, up: np.ndarray) -> np.ndarray:
    """Rows: right, up, and towards the viewer."""
    forward = towards_viewer / np.linalg.norm(towards_viewer)
    right = np.cross(up, forward)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(forward, right), forward])


def _fill(image: np.ndarray, depth: np.ndarray, corners: np.ndarray, colour: np.ndarray) -> None:
    """Draw one triangle, corners (x, y, depth) in pixels, shape (3, 3), y downwards."""
    (x0, y0), (x1, y1) = np.floor(corners[:, :2].min(axis=0)), np.ceil(corners[:, :2].max(axis=0))
    rows, columns = slice(max(int(y0), 0), int(y1) + 1), slice(max(int(x0), 0), int(x1) + 1)
    y, x = np.mgrid[rows, columns][:, : image.shape[0], : image.shape[1]] + 0.5
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = corners
    area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
    v = ((x - ax) * (cy - ay) - (cx - ax) * (y - ay)) / area
    w = ((bx - ax) * (y - ay) - (x - ax) * (by - ay)) / area
    distance = az + v * (bz - az) + w * (cz - az)
    tile = depth[rows, columns]
    distance, inside = distance[: tile.shape[0], : tile.shape[1]], (v >= 0) & (w >= 0) & (v + w <= 1)
    nearer = inside[: tile.shape[0], : tile.shape[1]] & (distance > tile)
    tile[nearer] = distance[nearer]
    image[rows, columns][nearer] = [*colour, 1.0]
