"""What is not known exactly: distributions of inputs, bands of results, contributions, errors of quantiles.

A band is made of many runs of one scene, each with its own draw of the uncertain parameters (band.py), or of
the closed form corrected by a few runs (quick_band.py).
"""
