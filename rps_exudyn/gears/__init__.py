"""Geometry of the gear: flanks, solids, and the limits within which a gear can be built.

gear_pair.py has frames and radii, from which the others start; basic_rack.py, helicoid.py and trochoid.py
are the pinion's surfaces; pinion_mesh.py, rack_bar.py and solids.py make the parts; limits.py and
report.py check them.
"""
