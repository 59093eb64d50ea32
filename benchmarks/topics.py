"""All benchmark topics: name -> topic. A new benchmark is one module and one entry here."""

from pkgutil import resolve_name

from benchmarks.topic import Topic

MODULES = {
    "geometry": "geometry",                            "tooth_compliance": "tooth_compliance",
    "law_on_gears": "law_on_gears",                    "free_pinion_torque": "free_pinion_torque",
    "model_ladder": "model_ladder",                    "scenes": "scenes",
    "paper": "paper",                                  "efficiency_map": "efficiency_map",
    "rack_beams": "rack_beam_elements",                "rattle_map": "rattle_map",
    "rack_deflection": "rack_deflection",              "rack_bow": "rack_bow",
    "scene_needs": "scene_needs",                      "stick_slip": "stick_slip",
    "accuracy_speed": "accuracy_speed.measured_points", "law_and_scaling": "accuracy_speed.law_and_scaling",
    "overview": "accuracy_speed.overview",             "climb": "accuracy_speed.climb",
    "levels": "accuracy_speed.level_points",           "stability_maps": "stability.maps",
    "explicit_limits": "stability.explicit_limits",    "implicit_limits": "stability.implicit_limits",
    "coverage": "stability.coverage",                  "ordinary_gears": "stability.ordinary_gears",
    "wide_gears": "stability.wide_gears",              "corpus": "stability.corpus",
    "check_cost": "stability.check_cost",              "damaged_files": "bad_inputs.damaged_files",
    "bad_inputs": "bad_inputs.bad_inputs",             "measured_intervals": "measured_intervals",
    "measured_bow": "measured_bow",                    "study_runner": "study_runner",
    "ten_minutes": "ten_minutes",                      "explorer": "explorer",
    "validation": "validation",                        "study_scaling": "study_scaling",
    "many_gears": "many_gears",                        "start_up": "start_up",
    "peer_scene": "peers.scene_files",                 "peers": "peers.side_by_side",
    "reduced_gear": "reduced_gear",                    "triangles": "triangles",
    "truth": "truth.entries",                          "yoke_adjustment": "yoke_adjustment",
    "releases": "releases",                            "sensitivities": "sensitivities",
    "preload_window": "preload_window",                "optimised_series": "optimised_series",
    "ratio_cost": "ratio_cost",                        "thresholds": "thresholds",
    "mutations": "mutations",
}  # fmt: skip
PARTS = {
    "spheres_on_gears": "law_on_gears:SPHERES_ALONE",
    "peer_rounds": "peers.side_by_side:AGAIN",
}
"""Topics beside that of their module."""

PLACES = {name: f"{module}:TOPIC" for name, module in MODULES.items()} | PARTS
TOPICS: dict[str, Topic] = {name: resolve_name(f"benchmarks.{place}") for name, place in PLACES.items()}
