"""Foundations without any mechanics: errors, units, files, compiled kernels.

errors.py and units.py are used everywhere; atomic.py writes files, hdf5.py opens them; compiled.py keeps
the cache of compiled kernels.
"""
