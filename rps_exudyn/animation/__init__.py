"""A recorded motion of the gear in three dimensions: a page that plays it, a film, a still.

parts.py makes the bodies, motion.py their poses, contact_lines.py the loads on the teeth, forces.py the
arrows; page.py with the files of viewer/ makes the page; camera.py, drawn.py and film.py make pictures.
"""
