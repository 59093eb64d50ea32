"""Force laws of yoke, bush, bearings and external loads, for Exudyn and for equilibria alike.

force_element.py defines what a force law is; each other file is one part of the gear, or a law that parts
share.
"""
