"""Pictures of results, drawn from what the files hold, without Exudyn.

style.py is the common look, curves.py has common parts; scene.py chooses the picture of a
result; each other file is one picture, which its first line describes.
"""
