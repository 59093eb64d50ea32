"""What a simulation leaves: outcome, quantities, provenance, the HDF5 file."""
