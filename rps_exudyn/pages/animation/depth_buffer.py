"""A depth buffer in compiled form: which triangle each pixel sees, and the light on it.

The page's shader (viewer/gl.js) and this kernel light bodies alike; hatched faces are those of a section.
"""

import numpy as np

from rps_exudyn.base.compiled import CUBE, MATRIX, VECTOR, entry

SUN = np.array([-0.35, 0.75, 0.6]) / np.sqrt(0.35**2 + 0.75**2 + 0.6**2)
FILL = np.array([0.8, -0.35, 0.5]) / np.sqrt(0.8**2 + 0.35**2 + 0.5**2)
HATCHES = 45.0  # of a section, down a picture: flat on the picture, however deep the face lies


@entry(CUBE, MATRIX, CUBE, CUBE, CUBE, MATRIX, VECTOR, VECTOR, VECTOR, VECTOR)
def paint(image, depth, seen, world, normals, colours, cuts, eye, sun, fill):  # type: ignore[no-untyped-def]
    """Draw triangles over what is there.

    Args:
        image, depth: red, green, blue (height, width, 3), and depth (height, width), changed in place.
        seen: corners in pixels and depth, shape (n, 3, 3).
        world, normals: corners in the housing frame and unit normals there, shape (n, 3, 3); normals of
            length 0 are lit evenly.
        colours: shape (n, 3).
        cuts: largest Z that is drawn, shape (n,) [m].
        eye, sun, fill: place of the eye, directions towards both lights, shape (3,).
    """
    height, width = depth.shape
    for t in range(seen.shape[0]):
        ax, ay, az = seen[t, 0, 0], seen[t, 0, 1], seen[t, 0, 2]
        bx, by, bz = seen[t, 1, 0], seen[t, 1, 1], seen[t, 1, 2]
        cx, cy, cz = seen[t, 2, 0], seen[t, 2, 1], seen[t, 2, 2]
        area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
        if area == 0.0:
            continue
        front = area < 0  # counter-clockwise from outside; pixels count downwards
        first = max(int(min(ax, bx, cx)), 0)
        last = min(int(max(ax, bx, cx)) + 1, width - 1)
        for row in range(max(int(min(ay, by, cy)), 0), min(int(max(ay, by, cy)) + 1, height - 1) + 1):
            y = row + 0.5
            for column in range(first, last + 1):
                x = column + 0.5
                v = ((x - ax) * (cy - ay) - (cx - ax) * (y - ay)) / area
                w = ((bx - ax) * (y - ay) - (x - ax) * (by - ay)) / area
                u = 1.0 - v - w
                if u < 0.0 or v < 0.0 or w < 0.0:
                    continue
                z = 1.0 / (u / az + v / bz + w / cz)
                if z >= depth[row, column]:
                    continue
                p, q, r = u * z / az, v * z / bz, w * z / cz
                wz = p * world[t, 0, 2] + q * world[t, 1, 2] + r * world[t, 2, 2]
                if wz > cuts[t]:
                    continue
                depth[row, column] = z
                wx = p * world[t, 0, 0] + q * world[t, 1, 0] + r * world[t, 2, 0]
                wy = p * world[t, 0, 1] + q * world[t, 1, 1] + r * world[t, 2, 1]
                nx = p * normals[t, 0, 0] + q * normals[t, 1, 0] + r * normals[t, 2, 0]
                ny = p * normals[t, 0, 1] + q * normals[t, 1, 1] + r * normals[t, 2, 1]
                nz = p * normals[t, 0, 2] + q * normals[t, 1, 2] + r * normals[t, 2, 2]
                size = np.sqrt(nx * nx + ny * ny + nz * nz)
                extra = 0.0
                if size < 0.1:
                    light = 1.0
                elif not front:
                    light = 0.84 + 0.12 * (((column + row) * HATCHES / height) % 1.0 > 0.5)
                else:
                    nx, ny, nz = nx / size, ny / size, nz / size
                    ex, ey, ez = eye[0] - wx, eye[1] - wy, eye[2] - wz
                    far = np.sqrt(ex * ex + ey * ey + ez * ez)
                    to_sun = nx * sun[0] + ny * sun[1] + nz * sun[2]
                    to_fill = nx * fill[0] + ny * fill[1] + nz * fill[2]
                    to_eye = (nx * ex + ny * ey + nz * ez) / far
                    light = 0.34 + 0.14 * ny + 0.55 * max(to_sun, 0.0) + 0.22 * max(to_fill, 0.0)
                    # the sun's mirror image along the eye: 2 (n.s)(n.e) - s.e
                    along = (sun[0] * ex + sun[1] * ey + sun[2] * ez) / far
                    mirrored = max(2 * to_sun * to_eye - along, 0.0)
                    extra = 0.32 * mirrored**28 + 0.12 * (1.0 - max(to_eye, 0.0)) ** 3
                for k in range(3):
                    shade = min(max(colours[t, k] * light + extra, 0.0), 1.0)
                    image[row, column, k] = shade**0.85
