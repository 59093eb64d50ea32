"""What the user may choose: the gear and its test, and what is modelled how."""
