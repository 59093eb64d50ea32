"""Checks whether a number can be right: of the plan before a run, of the record after it."""
