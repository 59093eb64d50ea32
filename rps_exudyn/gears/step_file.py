"""Solids as STEP (ISO 10303-21, AP214): faceted breps, a plane face for each triangle.

Curved faces would need the intersections of flanks, roots and shaft as curves, for which a CAD kernel of some
hundred megabytes is the only library.
"""

from collections.abc import Mapping

import numpy as np

HEAD = """ISO-10303-21;
HEADER;
FILE_DESCRIPTION((''),'2;1');
FILE_NAME('','',(''),(''),'','rps-exudyn','');
FILE_SCHEMA(('AUTOMOTIVE_DESIGN {{ 1 0 10303 214 1 1 1 1 }}'));
ENDSEC;
DATA;
#1=APPLICATION_CONTEXT('automotive design');
#2=PRODUCT_CONTEXT('',#1,'mechanical');
#3=PRODUCT_DEFINITION_CONTEXT('part definition',#1,'design');
#4=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));
#5=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));
#6=(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT());
#7=UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-7),#4,'','');
#8=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#7))\
GLOBAL_UNIT_ASSIGNED_CONTEXT((#4,#5,#6))REPRESENTATION_CONTEXT('',''));
#9=PRODUCT('{name}','{name}','',(#2));
#10=PRODUCT_DEFINITION_FORMATION('','',#9);
#11=PRODUCT_DEFINITION('','',#10,#3);
#12=PRODUCT_DEFINITION_SHAPE('','',#11);
#13=SHAPE_DEFINITION_REPRESENTATION(#12,#14);
"""


def step_text(name: str, solids: Mapping[str, tuple[np.ndarray, np.ndarray]]) -> str:
    """Return a file with closed meshes by name: vertices [m] (n, 3), faces (m, 3)."""
    lines: list[str] = []

    def entity(text: str) -> str:
        lines.append(f"#{len(lines) + 15}={text};")
        return f"#{len(lines) + 14}"

    def triple(kind: str, values: np.ndarray) -> str:
        return entity(f"{kind}('',({','.join(f'{value:.15E}' for value in values.tolist())}))")

    breps = []
    for part, (vertices, faces) in solids.items():
        points = [triple("CARTESIAN_POINT", 1e3 * vertex) for vertex in vertices]
        shell = []
        for face in faces.tolist():
            a, b, c = vertices[face]
            normal, along = np.cross(b - a, c - a), b - a
            directions = [triple("DIRECTION", each / np.linalg.norm(each)) for each in (normal, along)]
            place = entity(f"AXIS2_PLACEMENT_3D('',{points[face[0]]},{','.join(directions)})")
            plane = entity(f"PLANE('',{place})")
            loop = entity(f"POLY_LOOP('',({','.join(points[i] for i in face)}))")
            bound = entity(f"FACE_OUTER_BOUND('',{loop},.T.)")
            shell.append(entity(f"FACE_SURFACE('',({bound}),{plane},.T.)"))
        closed = entity(f"CLOSED_SHELL('',({','.join(shell)}))")
        breps.append(entity(f"FACETED_BREP('{part}',{closed})"))
    shape = f"#14=FACETED_BREP_SHAPE_REPRESENTATION('',({','.join(breps)}),#8);"
    return "\n".join([HEAD.format(name=name) + shape, *lines, "ENDSEC;", "END-ISO-10303-21;", ""])
