"""The command `geometry`: the geometry report, surfaces beside the drawing, the solids, their drawing."""

from dataclasses import asdict
from pathlib import Path

from rps_exudyn.base.files import PICTURES, check_writable
from rps_exudyn.cli.options import PAPER_GEAR, Flag, GearOptions, Json
from rps_exudyn.cli.output import DONE, present
from rps_exudyn.results.sheet import Block, Grid, Sheet, Text


def geometry(
    *, gear: GearOptions = PAPER_GEAR, out: Path | None = None, force: Flag = False, json: Json = False
) -> int:
    """Print the geometry report, and what surfaces show beside the drawing; write solids or a drawing.

    Args:
        out: Drawing (.png, .svg, .pdf), or what `export` writes (.stl, .glb, .step).
        force: Build the gear even if it is undercut.
    """
    from rps_exudyn.fmu.export import WRITERS, export
    from rps_exudyn.gears.geometry_report import COURSE_TABLE, geometry_report
    from rps_exudyn.gears.surface_report import compared, contradictions, placed_surfaces
    from rps_exudyn.results.quantities import GEOMETRY

    chosen = gear.load()
    if out:
        check_writable(out, (*WRITERS, *PICTURES))
    remarks: list[str] = []
    report, surfaces = geometry_report(chosen, force), list(compared(chosen))
    if out and out.suffix.lower() in WRITERS:
        done = export(chosen, out)
        remarks += done if isinstance(done, tuple) else ()
    elif out:
        from rps_exudyn.pages.animation.geometry_figure import draw_geometry

        draw_geometry(chosen, out, force)
    rows = [(name, item.show(getattr(report, name)), item.long_name) for name, item in GEOMETRY.items()]
    rows += [(f"mass of {part}", f"{each.mass:.4g} kg", "") for part, each in report.mass_properties.items()]
    text: list[Block] = [Grid(("quantity", "value", "definition"), rows)]
    if along := report.along_travel:
        heads = [COURSE_TABLE[name].axis_label(COURSE_TABLE[name].long_name) for name in along]
        values = [COURSE_TABLE[name].displayed(along[name]).round(9) + 0.0 for name in along]
        columns = [[f"{each:.4g}" for each in column] for column in values]
        text.append(Grid(heads, list(zip(*columns, strict=True))))
    warnings = [*report.warnings, *contradictions(chosen)]
    if surfaces:
        text.append(Grid(("quantity", "drawing", "surface", ""), [each.cells for each in surfaces]))
    read = [
        f"{part}.surface: {len(surface.areas)} triangles, read in {placement.unit}; "
        + ("closed: its mass counts." if surface.is_closed else "open: the drawing's mass counts.")
        for part, (surface, placement) in placed_surfaces(chosen).items()
    ]
    text += [Text(line) for line in (*read, *remarks, *(f"warning: {warning}" for warning in warnings))]
    data = {"surfaces": [asdict(each) | {"differs": each.differs} for each in surfaces]} if surfaces else {}
    present(
        Sheet(text=text, data=lambda: {**report.as_dict(), "warnings": warnings, **data}),
        [out] if out else [],
        json=json,
    )
    return DONE
