"""The command line `rps-exudyn`.

commands.py has one function for each command, study_command.py the work of `study`; options.py reads gear
and fidelity; printed.py prints tables and JSON; kept.py keeps the files of a run.
"""
