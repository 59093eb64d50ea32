"""The page about a fit to measured curves."""

from collections.abc import Iterable
from pathlib import Path

from rps_exudyn.base.errors import as_sentence
from rps_exudyn.base.files import replacing
from rps_exudyn.inference.fitting import findings
from rps_exudyn.inference.fitting.fitted import Fit, shape_claims
from rps_exudyn.pages.charts.inference import beliefs_figure, curves_figure
from rps_exudyn.pages.report.html import (
    Article,
    Fold,
    Grid,
    PageBlock,
    Pictures,
    Section,
    Text,
    Warning,
    page,
    parameter_grid,
    provenance_facts,
)
from rps_exudyn.pages.report.pictures import picture
from rps_exudyn.results.provenance import provenance

COLUMNS = ("parameter", "value", "95 % interval", "expected before", "verdict")


def write_fit_page(fit: Fit, out: str | Path) -> None:
    """Write the page.

    Raises:
        InputError: `out` cannot be written.
    """
    article = fit_article(fit)
    with replacing(out) as partial:
        partial.write_text(page(article.title, [article]), encoding="utf-8", errors="replace")


def fit_article(fit: Fit) -> Article:
    """What was found, its pictures, what it rests on."""
    names = ", ".join(dict.fromkeys(each.name for each in fit.passes))
    tests = ", ".join(dict.fromkeys(each.test for each in fit.passes))
    return Article(
        title=f"Fit to {names}",
        lead=f"tests: {tests} · {fit.simulations} simulations · {fit.cpu_s:.2g} s of CPU time",
        sections=[
            Section("What was found", list(_found(fit))),
            Section("Curves and beliefs", list(_pictures(fit))),
            Section("What it rests on", list(_basis(fit))),
        ],
    )


def _found(fit: Fit) -> Iterable[PageBlock]:
    if not fit.converged:
        yield Warning("The fit did not converge: these values are where it ended, and no estimates.")
    if sentence := findings.level_sentence(fit):
        yield Text(as_sentence(sentence))
    for sentence in findings.open_sentences(fit):
        yield Text(as_sentence(sentence))
    yield Grid(COLUMNS, [list(row) for row in findings.rows(fit)])
    if sentence := findings.offset_sentence(fit):
        yield Text(as_sentence(sentence))
    yield Text(
        "A good fit proves nothing about single parameters: crowning, tip relief or a friction that depends "
        "on speed pass unseen under noise, and move friction coefficients by several percent."
    )


def _pictures(fit: Fit) -> Iterable[PageBlock]:
    figures = {
        "Measured and fitted torque with the 95 % band of the fit; what is left, with two standard "
        "deviations of the noise": curves_figure(fit),
        "What was expected before (grey) and after the fit": beliefs_figure(fit),
    }
    for caption, figure in figures.items():
        if figure is not None:
            yield Pictures([picture(figure, caption)])


def _basis(fit: Fit) -> Iterable[PageBlock]:
    for sentence in fit.left_out:
        yield Text(f"{sentence}.")
    for sentence in fit.warnings:
        yield Text(as_sentence(sentence))
    yield Grid(findings.BUDGET, [list(row) for row in findings.budget_rows(fit)])
    yield Fold("What was assumed of the files", [Text(sentence) for sentence in fit.assumed])
    if claims := shape_claims(fit):
        table = [
            [each.path, f"{100 * each.sd:.2g} %", f"{100 * claims[each.path]:.2g} %"]
            for each in fit.estimates
            if each.path in claims
        ]
        caption = "Standard deviations by means, which count, and with the shape, which is not trusted"
        grid = Grid(("parameter", "means", "means and shape, if mesh.law were true"), table, caption)
        yield Fold("What the shape of the curve would claim", [grid])
    rows = [
        [name, *(f"{value:+.2f}" for value in line)]
        for name, line in zip(fit.correlated, fit.correlations, strict=True)
    ]
    yield Fold("Correlations", [Grid(("", *fit.correlated), rows)])
    changed = fit.gear.changes()
    yield Fold("Gear with the estimates", [parameter_grid(changed, "What differs from the default gear")])
    yield provenance_facts(provenance())
