"""Simulation of a scene: gear and fidelity in, a result out, whatever its outcome.

run.py is the one entry; by_accuracy.py chooses a model, fallback.py safer settings; batch.py many gears, of
which together.py follows most at once: family.py is what they have in common over one maneuver. cases/ does
many cases here, in processes, or on a cluster, each with a time limit.
"""
