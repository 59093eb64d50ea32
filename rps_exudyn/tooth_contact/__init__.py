"""Contact of the teeth, by analytic flanks or by points on them.

flank_contact.py integrates the analytic contact along the lines where flanks meet, which the other flank
files find; the files of samples and spheres replace the flanks by points.
"""
