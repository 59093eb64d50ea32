"""What users, disks and other programs do wrong, and what becomes of it."""
