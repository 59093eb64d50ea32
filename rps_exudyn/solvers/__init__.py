"""All forces of a gear in one kernel, equilibria along a drive, formulas, and the record of a motion."""
