"""The files that a chart can be saved as, known before the drawing library is loaded."""

PICTURES = (".png", ".svg", ".pdf")
