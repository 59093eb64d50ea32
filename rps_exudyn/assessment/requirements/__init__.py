"""The requirement sheet of a gear: what the paper, standards and manuals ask for, kept or not, with bands."""
