"""Parameter studies: a TOML file states what is varied, a folder keeps one result file per case.

study_file.py reads the TOML (with toml_keys.py and axis_tables.py) into a `Study` (definition.py);
designs.py and cases.py lay out its cases; store.py is the folder; runner.py runs what is missing
there, case_progress.py reports it; table.py reads it, for dataset.py, collected.py, effects.py and
sensitivity.py.
"""
