"""The command line `rps-exudyn`: one file a command, called by main.py.

options.py declares what several commands have; output.py prints their sheets.
"""
