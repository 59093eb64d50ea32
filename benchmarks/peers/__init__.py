"""The same gear in other programs: one scene, whole runs side by side, time against error."""
