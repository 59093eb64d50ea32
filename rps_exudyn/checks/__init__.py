"""Is the number right? Checks of a plan before the run and of the record after it."""
