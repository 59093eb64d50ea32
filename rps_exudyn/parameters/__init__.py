"""Parameters that a user may choose: the gear and its test, and the fidelity of the model.

declaration.py says how parameters are declared and read; gear.py and fidelity.py declare them; setup.py
joins both.
"""
