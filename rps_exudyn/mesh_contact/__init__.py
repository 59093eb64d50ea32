"""Contact of the teeth, from analytic flanks down to a fixed ratio.

flank_contact.py integrates the analytic contact along the lines where flanks meet, which the other flank
files find; the files of samples and spheres replace the flanks by points; ratio.py needs no flanks.
"""
