"""Results of a simulation: outcome, quantities, provenance, and the HDF5 file.

quantities.py lists every signal and number with its unit; result.py holds, saves and loads a `Result`.
"""
