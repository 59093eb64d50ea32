"""The command `geometry`: the geometry report, the solids, their drawing."""

from pathlib import Path

from rps_exudyn.base.files import PICTURES, check_writable
from rps_exudyn.cli.options import PAPER_GEAR, Flag, GearOptions, Json
from rps_exudyn.cli.output import DONE, present


def geometry(
    *, gear: GearOptions = PAPER_GEAR, out: Path | None = None, force: Flag = False, json: Json = False
) -> int:
    """Print the geometry report; write the solids or a drawing.

    Args:
        out: Solids (.glb, .stl) or drawing (.png, .svg, .pdf).
        force: Build the gear even if it is undercut.
    """
    from rps_exudyn.gears.export import FORMATS, export_solids
    from rps_exudyn.gears.geometry_report import geometry_report
    from rps_exudyn.results.quantities import GEOMETRY
    from rps_exudyn.results.sheet import Grid, Sheet, Text

    chosen = gear.load()
    if out:
        check_writable(out, (*FORMATS, *PICTURES))
    report = geometry_report(chosen, force)
    if out and out.suffix.lower() in FORMATS:
        export_solids(chosen, out)
    elif out:
        from rps_exudyn.pages.animation.geometry_figure import draw_geometry

        draw_geometry(chosen, out, force)
    rows = [(name, item.show(getattr(report, name)), item.long_name) for name, item in GEOMETRY.items()]
    rows += [(f"mass of {part}", f"{each.mass:.4g} kg", "") for part, each in report.mass_properties.items()]
    warnings = [Text(f"warning: {warning}") for warning in report.warnings]
    text = [Grid(("quantity", "value", "definition"), rows), *warnings]
    present(Sheet(text=text, data=report.as_dict), [out] if out else [], json=json)
    return DONE
