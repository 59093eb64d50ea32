"""Pictures of results, drawn from what the files hold; without Exudyn."""
