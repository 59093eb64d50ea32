"""The outcome of a finished run: what its physics must satisfy before it may be called ok.

Wrong runs end with success flags and plausible torques. What discretisation misses, and what is left of the
start, is in the error bars of the metrics.
"""

from dataclasses import replace

import numpy as np

from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Outcome, Status
from rps_exudyn.scenes.checks.rules import IN_RECORD, OF_GENERAL_CONTACT, RuleInput, breaches
from rps_exudyn.solvers.equilibrium import Start
from rps_exudyn.solvers.record import Record


def validated(
    outcome: Outcome, gear: SteeringGear, record: Record, signals: dict[str, np.ndarray]
) -> Outcome:
    """Return the outcome of a run after all checks; the first that fails is its cause.

    Of equilibria that end before the motion does, those which show why: a rack that left its place, teeth
    that carry nothing or more than their law holds for.
    """
    given = RuleInput(gear, signals=signals, record=record, valid_to=record.forces.valid_to)
    rules = IN_RECORD + (OF_GENERAL_CONTACT if outcome.status is Status.OK else ())
    for breach in breaches(rules, given):
        rule = breach.rule
        return replace(outcome, status=rule.status, codes=(rule.code,), message=breach.sentence)
    share = unsettled_share(record.start, signals)
    return replace(outcome, findings={**outcome.findings, "unsettled_mean": share}) if share else outcome


def unsettled_share(start: Start, signals: dict[str, np.ndarray]) -> float:
    """Return the share of the mean force over a record that depends on where the motion began."""
    recorded = float(signals["time"][-1])
    return start.unsettled * min(1.0, start.settles_in / recorded) if start.unsettled else 0.0
