"""What everything else stands on: errors, units, files, compiled kernels."""
