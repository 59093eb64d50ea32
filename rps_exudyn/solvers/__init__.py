"""Solutions without Exudyn: equilibria along a drive, formulas; and the record of any motion.

gear_forces.py gathers the forces of a gear in one kernel; equilibrium.py and path_follower.py balance
them; closed_form.py has the formulas; record.py turns a motion into signals and work.
"""
