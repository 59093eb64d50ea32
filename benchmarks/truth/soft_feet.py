"""Feet as springs, and friction that grows in proportion to the sliding speed below a speed, the zone.

Programs that take explicit steps need both. A body that should stick creeps, on an incline by
zone x tan(angle) / mu.
"""

from dataclasses import dataclass

import numpy as np

from benchmarks.truth.problems import Body, Scene


@dataclass(frozen=True)
class SoftFeet:
    """Settings: zone [m/s], depth of the feet at rest [m], share of the largest stable step."""

    zone: float = 1e-3
    depth: float = 2e-6
    share: float = 0.2

    def stiffness(self, scene: Scene, body: Body) -> float:
        """Stiffness of a foot that the weight of all bodies presses in by the depth [N/m]."""
        load = sum(each.mass for each in scene.bodies) * float(np.linalg.norm(scene.gravity))
        return load / len(body.feet) / self.depth

    def damping(self, scene: Scene, body: Body) -> float:
        """Damping of a foot, with 0.3 of the critical one for the body on all its feet [N s/m]."""
        return float(0.6 * np.sqrt(self.stiffness(scene, body) * body.mass / len(body.feet)))

    def step(self, scene: Scene) -> float:
        """A share of the largest stable step [s]: vibration on the feet, and decay within the zone."""
        fastest = 0.0
        for body in scene.bodies:
            on_feet = len(body.feet) * self.stiffness(scene, body)
            sticking = scene.friction * on_feet * self.depth / self.zone
            fastest = max(fastest, np.sqrt(on_feet / body.mass) + sticking / body.mass)
        return self.share / fastest
