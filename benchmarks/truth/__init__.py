"""Problems of contact with friction whose answers are known, for any program."""
