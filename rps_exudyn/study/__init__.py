"""Parameter studies: a TOML file says what is varied, a folder keeps one result file per case.

study_file.py reads and judges the TOML, cases.py lays out the cases, store.py is the folder, case_run.py does
one case, runner.py does them all in processes, cluster.py on other machines.
"""
