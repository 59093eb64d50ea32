"""A gear as a component for other programs: an FMU, of the reduced gear in C."""
