"""A recorded motion of the gear in three dimensions: a page that plays it, a film, a still.

parts.py makes the bodies, motion.py their poses, overlays.py the loads on the teeth and the arrows of forces;
page.py with the files of viewer/ makes the page; camera.py, drawn.py and film.py make pictures.
"""
