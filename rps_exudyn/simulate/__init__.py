"""Simulation of a scene: gear and fidelity in, a result out, whatever its outcome.

run.py is the one entry; by_accuracy.py chooses a model, fallback.py safer settings, isolated_run.py a
process (alone.py) with a time limit (time_limit.py); batch.py many gears, of which together.py follows most
at once: family.py is what they have in common over one maneuver; processes.py, worker.py and case_run.py do
the cases of studies.
"""
