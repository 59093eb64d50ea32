"""All benchmark topics: name -> topic. A new benchmark is one module and one line here."""

from benchmarks import (
    bar_section_cell,
    efficiency_map,
    explorer,
    flank_contact,
    free_pinion_torque,
    geometry,
    measured_fit,
    rack_beam_elements,
    rack_bow,
    rack_deflection,
    rattle_map,
    scene_needs,
    scenes,
    stick_slip,
    study_runner,
    study_scaling,
    ten_minutes,
    tooth_compliance,
    validation,
)
from benchmarks.accuracy_speed import law_and_scaling, measured_points, promise_table
from benchmarks.bad_inputs import bad_inputs, damaged_files
from benchmarks.peers import scene_files
from benchmarks.stability import (
    check_cost,
    corpus,
    explicit_limits,
    implicit_limits,
    maps,
    random_plans,
)
from benchmarks.topic import Topic

TOPICS: dict[str, Topic] = {
    "geometry": geometry.TOPIC,
    "flank_contact": flank_contact.TOPIC,
    "tooth_compliance": tooth_compliance.TOPIC,
    "free_pinion_torque": free_pinion_torque.TOPIC,
    "scenes": scenes.TOPIC,
    "efficiency_map": efficiency_map.TOPIC,
    "bar_cells": bar_section_cell.TOPIC,
    "rack_beams": rack_beam_elements.TOPIC,
    "rattle_map": rattle_map.TOPIC,
    "rack_deflection": rack_deflection.TOPIC,
    "rack_bow": rack_bow.TOPIC,
    "scene_needs": scene_needs.TOPIC,
    "stick_slip": stick_slip.TOPIC,
    "accuracy_speed": measured_points.TOPIC,
    "law_and_scaling": law_and_scaling.TOPIC,
    "promise_table": promise_table.TOPIC,
    "stability_maps": maps.TOPIC,
    "explicit_limits": explicit_limits.TOPIC,
    "implicit_limits": implicit_limits.TOPIC,
    "random_plans": random_plans.TOPIC,
    "corpus": corpus.TOPIC,
    "check_cost": check_cost.TOPIC,
    "damaged_files": damaged_files.TOPIC,
    "bad_inputs": bad_inputs.TOPIC,
    "measured_fit": measured_fit.TOPIC,
    "study_runner": study_runner.TOPIC,
    "ten_minutes": ten_minutes.TOPIC,
    "explorer": explorer.TOPIC,
    "validation": validation.TOPIC,
    "study_scaling": study_scaling.TOPIC,
    "peer_scene": scene_files.TOPIC,
}
