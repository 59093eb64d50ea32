"""Parameters that a user may choose: the gear, its test, and the fidelity of the model.

declaration.py declares and reads parameters; gear.py, rig.py, friction_law.py and fidelity.py
declare them; derived.py has the defaults that follow from others; distribution.py reads uncertain values.
"""
