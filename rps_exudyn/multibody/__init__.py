"""The gear as an Exudyn system, its guarded solution and its recorder."""
