"""Solutions without Exudyn: equilibria along a drive, formulas; and the record of any motion.

gear_forces.py makes a gear's record of constants, gear_model.py sums all forces and their tangent;
follower.py follows equilibria, of one gear (equilibrium.py) or of many (many_gears.py), rescue.py finds those
that Newton's method misses, settled_start.py the start; closed_form.py has the formulas; record.py turns a
motion into signals and work.
"""
