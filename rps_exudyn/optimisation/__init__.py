"""Robust optimisation: the gears of a drawing whose series is best, and the cheapest tolerances of one.

definition.py reads the file, evaluation.py computes one design, search.py those that pymoo asks for, in a
study's folder; confirmation.py computes the best ones again, on fresh gears and by other models;
optimisation_page.py states what was found. tolerances.py, tolerance_search.py and tolerance_page.py do so for
classes of tolerances; file_kinds.py has the JSON schemas.
"""
