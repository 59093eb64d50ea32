"""Simulation of a scene: gear and fidelity in, a result out, whatever its outcome.

run.py is the one entry; by_accuracy.py chooses a model, fallback.py safer settings, isolated_run.py a
process (alone.py) with a time limit (time_limit.py); batch.py many gears, of which looped.py finds most in
one compiled loop: what it knows (loop_knows.py), a scene's maneuvers (loop_legs.py), what all gears have in
common (loop_design.py), signals and figures (loop_signals.py, loop_figures.py); processes.py, worker.py and
case_run.py do the cases of studies.
"""
