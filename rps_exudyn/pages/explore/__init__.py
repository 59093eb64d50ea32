"""A page with sliders on this machine: curve, sheet, losses, gear and limits while they are dragged.

sliders.py lists what can be dragged and answers one state; typed_limits.py reads limits;
on_request.py answers clicks; answering.py does both in processes; server.py serves the page and its files.
"""
