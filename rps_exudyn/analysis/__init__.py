"""Metrics and comparisons computed from the signals of finished results, without Exudyn.

passes.py divides a record where the pinion turns back, which most others start from; each other file is
one kind of metric in the summary (torque.py, hysteresis.py, ...); comparison.py and measured.py compare
curves.
"""
