"""Foundations without any mechanics: errors, units, files, compiled kernels.

errors.py and units.py are used everywhere; files.py reads and writes files, hdf5.py opens results;
compiled.py compiles kernels, kernel_cache.py keeps them; progress.py and screen.py show how far a run is;
interrupts.py raises Ctrl-C.
"""
