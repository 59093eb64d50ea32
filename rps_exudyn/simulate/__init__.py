"""Simulation of a scene: gear and fidelity in, a result out, whatever its outcome.

run.py is the one entry; run_plan.py makes one run, or takes safer settings; by_accuracy.py climbs the
ladder until the error bars are within an accuracy; batch.py runs many gears, of which gear_table.py follows
most at once: shared_maneuver.py holds what they share over one maneuver. cases/ runs many cases here, in
processes, or on a cluster.
"""
