"""A page with sliders on this machine: torque curve, losses, geometry and limits while they are dragged.

sliders.py lists what can be dragged, answer.py computes one state, server.py serves the page and its files.
"""
