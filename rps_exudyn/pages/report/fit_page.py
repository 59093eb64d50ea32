"""The page about a fit to measured curves."""

from collections.abc import Iterable
from dataclasses import replace
from functools import partial
from math import exp, floor, inf, log10

from rps_exudyn.base.errors import as_sentence
from rps_exudyn.inference.fitting import findings
from rps_exudyn.inference.fitting.diagnosis import encoder_doubts
from rps_exudyn.inference.fitting.fit import beyond_the_teeth
from rps_exudyn.inference.fitting.fitted import Estimate, Fit, shape_claims
from rps_exudyn.inference.fitting.unknowns import LEVEL
from rps_exudyn.pages.report.html import parameter_grid, part_of, provenance_facts
from rps_exudyn.pages.report.judged import judgement
from rps_exudyn.pages.report.result_sheet import listed
from rps_exudyn.parameters.display_names import named
from rps_exudyn.results.judged_row import Verdict
from rps_exudyn.results.page_blocks import CodeText, Fold, Judged, Judgement, Mark, Pictures, Warning
from rps_exudyn.results.provenance import provenance
from rps_exudyn.results.quantities import SUMMARY
from rps_exudyn.results.rounding import interval, rounded
from rps_exudyn.results.sheet import Block, Grid, Line, Row, Section, Sheet, Text

COLUMNS = ("parameter", "value", "95 % interval", "prior", "verdict")
HEADS = ("parameter", "bar: 95 % interval; grey: prior", "estimate", "verdict")
SMALL = 0.1  # [mm], below which a length is shown in micrometres
WIDE = 1.96  # deviations of a 95 % interval
CAUTION = (
    "A good fit proves nothing about single parameters: crowning, tip relief or a friction that depends on "
    "speed are hidden by noise, and change friction coefficients by several per cent."
)
CURVES = (
    "Measured and fitted torque with the 95 % band of the fit; below, measured - fitted with two standard "
    "deviations of the noise"
)


def fit_sheet(fit: Fit) -> Sheet:
    """What was found, in a few rows and as text."""
    names = ", ".join(dict.fromkeys(each.name for each in fit.passes))
    tests = ", ".join(dict.fromkeys(each.test for each in fit.passes))
    return Sheet(
        "Fit to measured curves",
        f"{names} · tests: {tests}",
        list(_rows(fit)),
        text=_text(fit, tests),
        more="intervals, verdicts, budget, notes",
        data=lambda: findings.fit_as_dict(fit),
        gear=fit.gear,
    )


def fit_page(fit: Fit, command: str) -> Sheet:
    """The sheet with pictures and what it rests on; `command` makes it again."""
    from rps_exudyn.pages.charts.inference import curves_figure  # with matplotlib
    from rps_exudyn.pages.report.pictures import at_widths

    pictures = at_widths(lambda width: curves_figure(fit, width), CURVES)
    verdicts = {path: verdict for path, *_, verdict in findings.rows(fit)}
    parameters: list[Block] = [Judged(HEADS, [_judged(each, verdicts[each.path]) for each in fit.estimates])]
    if not fit.converged:
        text = "The fit did not converge: these values are its last iteration, not estimates."
        parameters.insert(0, Warning(text))
    if determined := [Text(as_sentence(each)) for each in findings.level_sentences(fit)]:
        parameters.append(Fold("What the tests determine, and which would determine more", determined))
    sections = [
        Section("Parameters", parameters),
        *([Section("Measured and fitted torque", [Pictures(pictures)])] if pictures else []),
        Section("Details", [*_basis(fit), Fold("Make it again", [CodeText(command)])]),
    ]
    return replace(fit_sheet(fit), sections=sections)


def _text(fit: Fit, tests: str) -> Iterable[Block]:
    yield Line(f"fit · tests: {tests} · {'converged' if fit.converged else 'NOT CONVERGED'}", is_bold=True)
    yield from map(Text, findings.level_sentences(fit))
    yield Grid(COLUMNS, findings.rows(fit))
    yield Grid(findings.BUDGET, findings.budget_rows(fit))
    if sentence := findings.offset_sentence(fit):
        yield Text(sentence)
    yield from (Text(f"{place}: {words}") for place, words in findings.adjustment_rows(fit))
    yield from (Text(f"assumed: {each}") for each in fit.assumed if each not in fit.left_out)
    yield from (Text(f"note: {each}") for each in (*fit.left_out, *fit.warnings))
    yield Text(f"{fit.simulations} simulations, {fit.cpu_s:.2g} s of CPU time")


def _rows(fit: Fit) -> Iterable[Row]:
    if fit.level is not None:
        half = fit.level.interval[1] - fit.level.value
        value = rounded(SUMMARY["torque_mean"], fit.level.value, half)
        yield Row(value, "mean free torque (\u00b1: 95 % of the gear)")
    if fit.converged:
        yield from _verdicts(fit)
    else:
        yield Row("no estimate", "the fit did not converge: these values are its last iteration")
    if fit.advice and fit.advice.tests:
        yield Row("next test", listed([findings.test_words(test) for test in fit.advice.tests]))
    measurement = fit.problem.measurement
    doubts = [*(each.sentence for each in fit.refusals), *beyond_the_teeth(measurement, fit.given)]
    doubts += measurement.late
    for level in (each for each in fit.levels if each.test.of_kind.by_angle):
        doubts += encoder_doubts(level, fit.given.pinion.teeth)
    if doubts:
        yield Row("check", doubts[0] + (f"; and {len(doubts) - 1} more" if len(doubts) > 1 else ""))
    yield from (Row(place, words) for place, words in findings.adjustment_rows(fit))


def _verdicts(fit: Fit) -> Iterable[Row]:
    def by_verdict(*verdicts: Verdict) -> list[Estimate]:
        return [each for each in fit.estimates if each.verdict in verdicts]

    if known := [_interval(each) for each in by_verdict(Verdict.FOUND, Verdict.NOT_ZERO)]:
        yield Row("known", listed(known))
    for each in fit.combinations:
        product = f"weighted product of {', '.join(map(named, each.exponents))}"
        yield Row("known", f"{product} to {100 * WIDE * each.sd:.2g} %, each alone is not")
    if with_help := [_interval(each) for each in by_verdict(Verdict.BY_PRIOR)]:
        yield Row("with priors", listed(with_help))
    if left := [named(each.path) for each in by_verdict(Verdict.OPEN)]:
        yield Row("not separable", listed(left))


def _interval(each: Estimate) -> str:
    """Name and 95 % interval with two digits, in a unit that needs no zeros."""
    return f"{named(each.path)} {interval(*(_two_digits(each.path, end) for end in each.interval))}"


def _two_digits(path: str, value: float) -> str:
    number, _, unit = findings.shown(path, value).partition(" ")
    size = float(number)
    if unit == "mm" and abs(size) < SMALL:
        size, unit = 1e3 * size, "\u00b5m"
    digits = 3 if abs(size) >= 100 else 2
    places = max(0, digits - 1 - floor(log10(abs(size)))) if size else 0
    return f"{float(f'{size:.{digits}g}'):.{places}f} {unit}".strip()


def _judged(each: Estimate, verdict: str) -> Judgement:
    if each.path.partition(" ")[0] in LEVEL:
        ends = tuple(each.prior * exp(sign * WIDE * each.prior_sd) for sign in (-1, 1))
    elif each.path.endswith("_angle"):
        ends = (-inf, inf)
    else:
        ends = tuple(each.prior + sign * WIDE * each.prior_sd for sign in (-1, 1))
    show = partial(_two_digits, each.path)
    placed = judgement(each, named(each.path), each.path, show, (ends[0], ends[1]), verdict, "", True)
    mark = Mark.KEPT if each.verdict in findings.KNOWN else Mark.OPEN
    return replace(placed, mark=mark, limits=(), part=part_of([each.path]))


def _basis(fit: Fit) -> Iterable[Block]:
    notes = [*(f"{sentence}." for sentence in fit.left_out), *map(as_sentence, fit.warnings), CAUTION]
    if sentence := findings.offset_sentence(fit):
        notes.insert(0, as_sentence(sentence))
    yield Fold("Notes", [Text(note) for note in notes])
    yield Fold("Table of parameters", [Grid(COLUMNS, findings.rows(fit))])
    yield Fold("Uncertainty budget", [Grid(findings.BUDGET, findings.budget_rows(fit))])
    yield Fold("Assumptions about the files", [Text(sentence) for sentence in fit.assumed])
    if claims := shape_claims(fit):
        both = [(each, claims[each.path]) for each in fit.estimates if each.path in claims]
        table = [[each.path, f"{100 * each.sd:.2g} %", f"{100 * sd:.2g} %"] for each, sd in both]
        caption = "Standard deviations by means, which count, and with the shape, which is not trusted"
        grid = Grid(("parameter", "means", "means and shape, if mesh.law were true"), table, caption)
        yield Fold("Information in the shape of the curve", [grid])
    lines = zip(fit.correlated, fit.correlations, strict=True)
    rows = [[name, *(f"{value:+.2f}" for value in line)] for name, line in lines]
    yield Fold("Correlations", [Grid(("", *fit.correlated), rows)])
    grid = parameter_grid(fit.gear.changes(), "Differences from the default gear")
    yield Fold("Gear with the estimates", [grid])
    cost = Text(f"{fit.simulations} simulations, {fit.cpu_s:.2g} s of CPU time.")
    yield Fold("Origin", [cost, provenance_facts(provenance())])
