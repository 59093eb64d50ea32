"""Force laws of yoke, bush, bearings and loads."""
