"""Benchmarks: the scripts behind every table, picture and data file in `results/`. Start with `make.py`."""
