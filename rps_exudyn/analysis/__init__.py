"""What can be learned from finished results, without Exudyn."""
