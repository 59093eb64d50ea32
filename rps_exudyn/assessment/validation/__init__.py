"""Rows that hold the package against data from outside: manuals, standards, other programs, closed forms.

A row is a folder of `rows/` with its data, its procedure and the criterion that was written before the run
(row.py); running it gives S, D, E and their uncertainties (comparison.py) and a verdict (verdict.py).
"""
