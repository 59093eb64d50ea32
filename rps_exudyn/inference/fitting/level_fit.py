"""The fit of levels: Gauss and Newton's steps with the closed form, which simulations correct.

The closed form is the model of all steps, with the difference to a simulation at the last end: as a factor of
friction, as a term of half sums. Two or three simulations are enough, and what other priors would give
(three times as wide, or none) costs none at all.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from rps_exudyn.inference.fitting.prediction import NoPredictionError, Prediction, formula_means, gear_in
from rps_exudyn.inference.fitting.problem import FitState, LevelRows
from rps_exudyn.inference.fitting.unknowns import LEVEL, Unknown, nuisances_of, settings_of
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.error_bars import FACTOR, FLOOR
from rps_exudyn.solvers.closed_form import unloading_force

ENOUGH = 0.02  # of a standard error: a smaller step ends the steps
AGREED = 0.25  # the same, between two simulations
MOST_STEPS, MOST_HALVINGS, MOST_SIMULATIONS = 40, 8, 6
BETWEEN_MODELS = 1.0  # times the difference of both models under weights: its standard deviation
NEAR_LIFTING, AROUND_LIFTING = 0.03, 0.25  # of a level, and of the load: the closed form has a kink there
LONGEST = 1.0  # of a logarithm in a step
FLAT = 1e-3  # of a sum of squares: a step that gains less is no reason to go on


@dataclass(frozen=True, eq=False)
class LevelModel:
    """Measured levels, the priors of the unknowns, and the closed form with its correction."""

    rows: LevelRows
    unknowns: Sequence[Unknown]  # of the level, nuisances last
    gear: SteeringGear  # with what is not fitted
    factors: np.ndarray  # of the closed form's rows, (rows,)
    terms: np.ndarray  # added to them, (rows,)
    near: np.ndarray  # deviations, of the values, where a flank is about to lift, (rows,)
    numerical: np.ndarray | None = None  # error of the simulated rows, a standard uncertainty (rows,)

    @classmethod
    def of(cls, rows: LevelRows, unknowns: Sequence[Unknown], gear: SteeringGear) -> "LevelModel":
        none = np.zeros(rows.values.size)
        return cls(rows, unknowns, gear, np.ones_like(none), none, none)

    def by_formula(self, u: np.ndarray) -> np.ndarray:
        """The closed form's rows at unknowns, shape (rows,)."""
        gear = self.gear.replace(settings_of(list(self.unknowns), u))
        nuisances = nuisances_of(list(self.unknowns), u)
        tests = dict.fromkeys(self.rows.tests)
        means = {test: formula_means(gear_in(test, gear, nuisances), test) for test in tests}
        return self.rows.of_means(means)

    def at(self, u: np.ndarray) -> np.ndarray:
        """The corrected rows, shape (rows,)."""
        return self.of_formula(self.by_formula(u))

    def of_formula(self, formula: np.ndarray) -> np.ndarray:
        """The closed form's rows (rows,) with the correction."""
        return self.factors * formula + self.terms

    def corrected(self, u: np.ndarray, simulated: np.ndarray) -> "LevelModel":
        """The model with the correction that simulated rows (rows,) at `u` show."""
        formula = self.by_formula(u)
        scaled = self.rows.scaled & (np.abs(formula) > 0)
        factors = np.where(scaled, simulated / np.where(scaled, formula, 1.0), 1.0)
        lifting = unloading_force(self.gear.replace(settings_of(list(self.unknowns), u)))
        loads = np.array([abs(test.load) if test.of_kind.weighted else np.inf for test in self.rows.tests])
        near = NEAR_LIFTING * np.exp(-(((loads / lifting - 1) / AROUND_LIFTING) ** 2))
        return replace(self, factors=factors, terms=np.where(scaled, 0.0, simulated - formula), near=near)

    @property
    def covariance(self) -> np.ndarray:
        """Covariance of the rows, of what simulation and closed form differ by under weights, and of the
        numerical error: as one bias of all rows, which tests do not average out, and as each row's own,
        so that no row measures the bias of the others."""
        weighted = np.array([test.of_kind.weighted for test in self.rows.tests])
        apart = BETWEEN_MODELS * np.where(weighted, (self.factors - 1) * self.rows.values, 0.0)
        near = np.diag((self.near * self.rows.values) ** 2)
        known = self.rows.covariance + np.outer(apart, apart) + near
        if self.numerical is None:
            return known
        of_row = np.fmax(np.abs(self.numerical), FLOOR / FACTOR * np.abs(self.rows.values))
        return known + np.outer(self.numerical, self.numerical) + np.diag(of_row**2)

    def with_priors(self, factor: float, nuisances: float | None = None) -> "LevelModel":
        """The same with deviations of all priors times a factor, at least the declared ones: what somebody
        gave for known is no finding. `nuisances` is the factor of theirs."""
        nuisance_factor = factor if nuisances is None else nuisances
        sds = [
            each.sd * nuisance_factor if each.is_nuisance else max(factor * each.sd, LEVEL[each.path].sd)
            for each in self.unknowns
        ]
        wider = [replace(each, sd=sd) for each, sd in zip(self.unknowns, sds, strict=True)]
        return replace(self, unknowns=wider)

    def slopes(self, u: np.ndarray, base: np.ndarray | None = None) -> np.ndarray:
        """Derivatives of the corrected rows, shape (rows, unknowns); `base` are the closed form's at `u`."""
        base, columns = self.by_formula(u) if base is None else base, []
        for j, unknown in enumerate(self.unknowns):
            stepped = u.copy()
            stepped[j] += unknown.step
            columns.append(self.factors * (self.by_formula(stepped) - base) / unknown.step)
        return np.array(columns).T.reshape(base.size, u.size)

    def priors(self) -> tuple[np.ndarray, np.ndarray]:
        """Expected values and deviations, (unknowns,) each."""
        before, sd = np.array([(each.before, each.sd) for each in self.unknowns]).reshape(-1, 2).T
        return before, sd

    def cost(self, u: np.ndarray, formula: np.ndarray | None = None) -> float:
        """Chi squared of rows and priors; `formula` are the closed form's rows at `u`."""
        left = self.rows.values - (self.at(u) if formula is None else self.of_formula(formula))
        before, sd = self.priors()
        return float(left @ np.linalg.solve(self.covariance, left) + np.sum(((u - before) / sd) ** 2))


def stepped(model: LevelModel, begin: np.ndarray) -> FitState:
    """Improve unknowns by halved steps of Gauss and Newton: full ones fail where a flank lifts."""
    u, (before, sd) = begin.copy(), model.priors()
    formula = model.by_formula(u)
    cost = model.cost(u, formula)
    information = np.diag(sd**-2.0)
    for _ in range(MOST_STEPS):
        slopes, left = model.slopes(u, formula), model.rows.values - model.of_formula(formula)
        weighted = np.linalg.solve(model.covariance, np.column_stack([slopes, left]))
        information = np.diag(sd**-2.0) + slopes.T @ weighted[:, :-1]
        step = np.linalg.solve(information, slopes.T @ weighted[:, -1] - (u - before) / sd**2)
        errors = np.sqrt(np.diag(np.linalg.inv(information)))
        if float(np.max(np.abs(step) / errors, initial=0.0)) < ENOUGH:
            return FitState(u + step, information=information, converged=True)
        step /= max(1.0, float(np.abs(step).max()) / LONGEST)
        for _ in range(MOST_HALVINGS):
            ahead = model.by_formula(u + step)
            new = model.cost(u + step, ahead)
            if new < cost:
                break
            step = step / 2
        else:
            return FitState(u, information=information, converged=True)  # at the edge where a flank lifts
        gained, cost, u, formula = cost - new, new, u + step, ahead
        if gained < FLAT:
            return FitState(u, information=information, converged=True)
    return FitState(u, information=information, why=f"{MOST_STEPS} steps were not enough")


def fitted_levels(
    model: LevelModel,
    prediction: Prediction,
    rows_of: Callable[[np.ndarray], np.ndarray],
    with_runout: Callable[[SteeringGear, np.ndarray | None], SteeringGear],
    begin: np.ndarray,
    *,
    corrected: bool = False,
    agreed: float = AGREED,
) -> tuple[LevelModel, FitState]:
    """Fit levels with a model that simulations correct, until two of them agree.

    Return the corrected model, and the state with the values that were simulated last.

    Args:
        model: `corrected` if it has a correction from another gear or fit.
        rows_of: simulated values (m,) -> rows (rows,).
        with_runout: gear and simulated values -> the gear with the runout that the half sum shows.
        agreed: standard errors between two simulations that end the fit.

    Raises:
        NoPredictionError: there is no equilibrium where the fit begins.
    """
    unknowns = list(model.unknowns)
    end = stepped(model, begin)
    values: np.ndarray | None = None
    for number in range(MOST_SIMULATIONS):
        u, last = end.u, end
        for _ in range(MOST_HALVINGS):
            gear = with_runout(model.gear.replace(settings_of(unknowns, u)), values)
            try:
                values = prediction.simulated(gear, nuisances_of(unknowns, u))
                break
            except NoPredictionError as error:
                if number == 0 and not corrected:
                    begin_gear = np.array([each.before for each in unknowns])
                    if np.allclose(u, begin_gear, atol=1e-3):
                        raise
                    u = (u + begin_gear) / 2
                    continue
                if values is None:
                    raise
                return model, replace(last, values=values, converged=False, why=str(error))
        else:
            raise NoPredictionError("no equilibrium between the expected gear and the fitted one")
        model = model.corrected(u, rows_of(values))
        if model.numerical is None:
            try:
                change = prediction.numerical(gear, nuisances_of(unknowns, u), values)
            except NoPredictionError as error:
                why = f"the numerical error is unknown: {error}"
                return model, replace(last, values=values, converged=False, why=why)
            model = replace(model, numerical=rows_of(change))
        end = stepped(model, u)
        moved = float(np.max(np.abs(end.u - u) * np.sqrt(np.diag(end.information)), initial=0.0))
        if moved < agreed:
            return model, replace(end, values=values)
    why = f"{MOST_SIMULATIONS} simulations were not enough"
    assert values is not None
    return model, replace(end, values=values, converged=False, why=end.why or why)
