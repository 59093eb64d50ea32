"""`python -m rps_exudyn` is `rps-exudyn`."""

import sys

from rps_exudyn.cli.main import main

sys.exit(main())
