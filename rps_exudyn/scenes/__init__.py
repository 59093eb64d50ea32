"""What the test rig does: one file a scene, each with its `SCENE`.

A scene consists of maneuvers (maneuver.py), which run_maneuver.py makes by dynamics, equilibria or formulas;
metrics.py and checks/rules.py describe what came out. A new scene is a new file and its name in
`SCENE_NAMES`.
"""

from importlib import import_module
from typing import TYPE_CHECKING

from rps_exudyn.base.errors import InputError, check_kind

if TYPE_CHECKING:
    from rps_exudyn.scenes.scene import Scene

SCENE_NAMES = (
    "free-pinion-torque",
    "load-test",
    "rack-push",
    "rack-on-rollers",
    "reversal",
    "steering-feel",
    "steering-torque",
    "stick-slip",
    "yoke-impact",
    "radial-play",
    "rack-lift",
    "input-shaft-play",
    "rattle",
    "yoke-setting",
)
"""All scenes; each stands in the module of its name. Modules are loaded when their scene is asked for."""


_OWN: "dict[str, Scene]" = {}  # scenes of this process


def add_scene(scene: "Scene") -> None:
    """Register an own scene in this process by its name; one added before by that name is replaced.

    Study files and the command line have the scenes of the package only, and so have processes that are
    started for a study or a time limit.

    Raises:
        InputError: a scene of the package has that name.

    Examples:
        >>> from dataclasses import replace
        >>> from rps_exudyn.scenes import scene_named
        >>> rps.add_scene(replace(scene_named("free-pinion-torque"), name="my-test"))
        >>> rps.run("my-test", fidelity="closed-form").scene
        'my-test'
    """
    from rps_exudyn.scenes.scene import Scene

    check_kind("scene", scene, Scene, "a Scene")
    if scene.name in SCENE_NAMES:
        raise InputError(f"{scene.name} is a scene of the package; give yours another name.")
    _OWN[scene.name] = scene


def is_scene(name: str) -> bool:
    """Return whether there is a scene of that name."""
    return name in SCENE_NAMES or name in _OWN


def scene_named(name: str) -> "Scene":
    """Return the scene of that name.

    Raises:
        InputError: there is no such scene.
    """
    if isinstance(name, str) and name in _OWN:
        return _OWN[name]
    if not isinstance(name, str) or name not in SCENE_NAMES:
        raise InputError(f"SCENE is {name!r}; it must be one of {', '.join((*SCENE_NAMES, *_OWN))}.")
    scene: Scene = import_module(f"{__name__}.{name.replace('-', '_')}").SCENE
    return scene
