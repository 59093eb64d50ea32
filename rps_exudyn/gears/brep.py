"""Solids with true faces (boundary representation) by OpenCASCADE, the extra `cad`.

Lengths are metres; inside the kernel and in its files they are millimetres.

A surface is a cubic B-spline through a grid of exact points, refined until exact points between are within
`SURFACE_ERROR` of it; where it is a plane, or a cylinder about Z, the face has that. Faces are sewn along
edges that agree within `SEAM`; openings with a plane edge are closed by planes.
"""

from collections.abc import Callable, Iterable, Mapping
from io import BytesIO
from typing import NamedTuple

import numpy as np
from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeEdge,
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_MakeSolid,
    BRepBuilderAPI_MakeWire,
    BRepBuilderAPI_Sewing,
    BRepBuilderAPI_Transform,
)
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepLib import BRepLib
from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder, BRepPrimAPI_MakePrism
from OCP.collections import Array1_double, Array1_int, Array2_gp_Pnt
from OCP.GC import GC_MakeArcOfCircle
from OCP.Geom import Geom_BSplineSurface, Geom_CylindricalSurface
from OCP.GeomConvert import GeomConvert_SurfToAnaSurf
from OCP.gp import gp_Ax2, gp_Ax3, gp_Dir, gp_Pnt, gp_Trsf, gp_Vec
from OCP.Message import Message
from OCP.ShapeAnalysis import ShapeAnalysis_FreeBounds
from OCP.ShapeFix import ShapeFix_Face
from OCP.Standard import Standard_Failure as Standard_Failure  # what the kernel raises
from OCP.STEPCAFControl import STEPCAFControl_Writer
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDataStd import TDataStd_Name
from OCP.TDocStd import TDocStd_Document
from OCP.TopAbs import TopAbs_SHELL, TopAbs_SOLID, TopAbs_WIRE
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS, TopoDS_Shape
from OCP.XCAFDoc import XCAFDoc_DocumentTool

MM = 1e3
SURFACE_ERROR = 1e-7  # [m]
COARSEST, FINEST = 4, 128  # intervals of a grid each way
SEAM = 2e-7  # [m]

Points = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""Points [m] of a surface, shape (n, m, 3), at parameters s (n, 1) and t (1, m) from 0 to 1."""


class NotSolidError(ValueError):
    """Why no solid was made, to follow its name."""


def closed(surfaces: Iterable[Points]) -> TopoDS_Shape:
    """Return the solid inside surfaces and the planes that close their openings.

    The grids of all have equal places of t: surfaces that share an edge along t have it in common.

    Raises:
        NotSolidError: finer grids would be needed.
    """
    shell = _sewn(_spline_faces(surfaces))
    bounds = TopExp_Explorer(ShapeAnalysis_FreeBounds(shell, False, True).GetClosedWires(), TopAbs_WIRE)
    parts = [shell]
    while bounds.More():
        parts.append(BRepBuilderAPI_MakeFace(TopoDS.Wire(bounds.Current()), True).Face())
        bounds.Next()
    whole = TopExp_Explorer(_sewn(parts), TopAbs_SHELL)
    solid = BRepBuilderAPI_MakeSolid(TopoDS.Shell(whole.Current())).Solid()
    BRepLib.OrientClosedSolid_s(solid)
    return solid


def _sewn(faces: Iterable[TopoDS_Shape]) -> TopoDS_Shape:
    sewing = BRepBuilderAPI_Sewing(MM * SEAM)
    for face in faces:
        sewing.Add(face)
    sewing.Perform()
    return sewing.SewedShape()


def _spline_faces(surfaces: Iterable[Points]) -> list[TopoDS_Shape]:
    surfaces, along = list(surfaces), COARSEST
    across = np.full(len(surfaces), COARSEST)
    while max(along, *across) <= FINEST:
        fits = [_fitted(points, count, along) for points, count in zip(surfaces, across, strict=True)]
        # of one direction after the other: errors add up; not-a-number is rough, too
        rough = ~(np.array([fit.errors for fit in fits]) < SURFACE_ERROR / 2)
        if not rough.any():
            return [_face(fit) for fit in fits]
        across = across * (1 + rough[:, 0])
        along *= 1 + int(rough[:, 1].any())
    raise NotSolidError(
        f"has a surface from which splines of {FINEST} pieces are more than {1e6 * SURFACE_ERROR:g} um away"
    )


class _Fit(NamedTuple):
    """Spline through a grid."""

    points: np.ndarray  # exact [m], shape (n, m, 3)
    poles: np.ndarray  # [m], shape (n, m, 3)
    knots: tuple[np.ndarray, np.ndarray]  # of s and t
    errors: tuple[float, ...]  # distances of exact points between from the splines along s and t [m]


def _fitted(points: Points, across: int, along: int) -> _Fit:
    """Fit a surface with so many intervals of s and t."""
    from scipy.interpolate import make_interp_spline  # loads in a third of a second

    s, t = (np.linspace(0, 1, 2 * count + 1) for count in (across, along))
    exact = points(s[:, None], t[None])
    normal = np.cross(*np.gradient(exact, axis=(0, 1)))
    normal /= np.linalg.norm(normal, axis=2)[..., None]
    one = make_interp_spline(s[::2], exact[::2])
    off_s = one(s) - exact
    off_t = make_interp_spline(t[::2], exact[:, ::2], axis=1)(t) - exact
    both = make_interp_spline(t[::2], one.c[:, ::2], axis=1)
    errors = tuple(float(np.abs((each * normal).sum(axis=2)).max()) for each in (off_s, off_t))
    return _Fit(exact[::2, ::2], np.moveaxis(both.c, 0, 1), (one.t, both.t), errors)


def _face(fit: _Fit) -> TopoDS_Shape:
    """The face of a spline, or of the plane or cylinder that it is."""
    grid = Array2_gp_Pnt(1, fit.poles.shape[0], 1, fit.poles.shape[1])
    for i, j in np.ndindex(fit.poles.shape[:2]):
        grid.SetValue(i + 1, j + 1, _point(fit.poles[i, j]))
    knots, counts = [], []
    for each in fit.knots:
        values, multiplicities = np.unique(each, return_counts=True)
        knots.append(Array1_double(1, len(values)))
        counts.append(Array1_int(1, len(values)))
        for i, (value, count) in enumerate(zip(values.tolist(), multiplicities.tolist(), strict=True), 1):
            knots[-1].SetValue(i, value)
            counts[-1].SetValue(i, count)
    spline = Geom_BSplineSurface(grid, *knots, *counts, 3, 3)
    plain = _round(fit.points) or GeomConvert_SurfToAnaSurf(spline).ConvertToAnalytical(MM * SURFACE_ERROR)
    if plain is None:
        return BRepBuilderAPI_MakeFace(spline, MM * SEAM).Face()
    rim = []
    for curve, row in (
        (spline.VIso(0.0), fit.poles[:, 0]),
        (spline.UIso(1.0), fit.poles[-1]),
        (spline.VIso(1.0), fit.poles[:, -1]),
        (spline.UIso(0.0), fit.poles[0]),
    ):
        chord, offset = row[-1] - row[0], row - row[0]
        height = np.linalg.norm(np.cross(chord, offset), axis=1).max() / np.linalg.norm(chord)
        rim.append((_point(row[0]), _point(row[-1])) if height < SURFACE_ERROR else (curve,))
    outline = _wire(BRepBuilderAPI_MakeEdge(*each).Edge() for each in rim)
    fix = ShapeFix_Face(BRepBuilderAPI_MakeFace(plain, outline, False).Face())
    fix.Perform()
    return fix.Face()


def _round(points: np.ndarray) -> Geom_CylindricalSurface | None:
    """The cylinder about Z through points (n, m, 3) [m], if there is one; its seam is opposite to them."""
    radii = np.hypot(points[..., 0], points[..., 1])
    if np.ptp(radii) > SURFACE_ERROR:
        return None
    x, y, _ = points[len(points) // 2, points.shape[1] // 2].tolist()
    frame = gp_Ax3(gp_Pnt(), gp_Dir(0, 0, 1), gp_Dir(-x, -y, 0))
    return Geom_CylindricalSurface(frame, MM * float(radii.mean()))


def _wire(edges: Iterable[TopoDS_Shape]) -> TopoDS_Shape:
    wire = BRepBuilderAPI_MakeWire()
    for edge in edges:
        wire.Add(edge)
    return wire.Wire()


def _point(place: np.ndarray) -> gp_Pnt:
    return gp_Pnt(*(MM * place).tolist())


# --- Solids


def round_bar(axis: str, radius: float, start: float, stop: float) -> TopoDS_Shape:
    """Return a cylinder about one of the axes, from one place to another [m]."""
    direction = np.eye(3)["XYZ".index(axis)]
    frame = gp_Ax2(_point(start * direction), gp_Dir(*direction.tolist()))
    return BRepPrimAPI_MakeCylinder(frame, MM * radius, MM * (stop - start)).Solid()


def prism(outline: Iterable[np.ndarray], way: np.ndarray) -> TopoDS_Shape:
    """Return the body that a plane outline sweeps along a way [m].

    `outline` has points (1, 3) and arcs through three points (3, 3); straight lines join and close it.
    """
    stops = [each if np.ptp(each, axis=0).max() > SEAM else each[:1] for each in outline]
    edges = []
    for before, after in zip([stops[-1], *stops], stops, strict=False):
        if np.linalg.norm(after[0] - before[-1]) > SEAM:
            edges.append(BRepBuilderAPI_MakeEdge(_point(before[-1]), _point(after[0])).Edge())
        if len(after) > 1:
            arc = GC_MakeArcOfCircle(*(_point(each) for each in after)).Value()
            edges.append(BRepBuilderAPI_MakeEdge(arc).Edge())
    face = BRepBuilderAPI_MakeFace(_wire(edges), True).Face()
    return BRepPrimAPI_MakePrism(face, gp_Vec(*(MM * way).tolist())).Shape()


def cut(body: TopoDS_Shape, tool: TopoDS_Shape) -> TopoDS_Shape:
    """Return a body without what it shares with a tool."""
    return _one(BRepAlgoAPI_Cut(body, tool).Shape())


def joined(body: TopoDS_Shape, other: TopoDS_Shape) -> TopoDS_Shape:
    """Return the union of two bodies."""
    return _one(BRepAlgoAPI_Fuse(body, other).Shape())


def _one(result: TopoDS_Shape) -> TopoDS_Shape:
    """The solid that a boolean results in.

    Raises:
        NotSolidError: there is none, or several, or its faces do not close it.
    """
    found, solids = TopExp_Explorer(result, TopAbs_SOLID), []
    while found.More():
        solids.append(found.Current())
        found.Next()
    if len(solids) != 1 or not BRepCheck_Analyzer(solids[0]).IsValid():
        raise NotSolidError("becomes no closed solid in OpenCASCADE")
    return solids[0]


def placed(solid: TopoDS_Shape, frame: np.ndarray, origin: np.ndarray) -> TopoDS_Shape:
    """Return a solid in a frame, its directions as columns (3, 3), at an origin [m]."""
    place = gp_Trsf()
    place.SetValues(*np.column_stack([frame, MM * origin]).ravel().tolist())
    return BRepBuilderAPI_Transform(solid, place, True).Shape()


def step_bytes(solids: Mapping[str, TopoDS_Shape]) -> bytes:
    """Return a STEP file (AP214) with solids by name."""
    document = TDocStd_Document(TCollection_ExtendedString("rps-exudyn"))
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    for name, solid in solids.items():
        TDataStd_Name.Set_s(shapes.AddShape(solid, False), TCollection_ExtendedString(name))
    Message.DefaultMessenger_s().ChangePrinters().Clear()  # the writer's report
    writer, content = STEPCAFControl_Writer(), BytesIO()
    writer.Transfer(document)
    writer.WriteStream(content)
    return content.getvalue()
