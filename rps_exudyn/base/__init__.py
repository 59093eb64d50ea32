"""Foundations without any mechanics: errors, units, files, compiled kernels.

errors.py and units.py are used everywhere; files.py reads and writes files, hdf5.py opens results;
compiled.py declares kernels, kernel_code.py loads their machine code, kernel_compiler.py makes it;
progress.py and screen.py show how far a run is; interrupts.py raises Ctrl-C.
"""
