"""The gear as an Exudyn system; the only production folder that imports exudyn.

model.py builds the system from the other files; solve.py runs it and names every outcome; recorder.py
keeps the motion.
"""
