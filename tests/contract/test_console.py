"""A failed solution is reported once, by its outcome: Exudyn itself stays silent, its settings unchanged."""

import exudyn as exu
import pytest
from exudyn.itemInterface import Force, MarkerNodePosition, NodePoint, ObjectMassPoint

from rps_exudyn.multibody.solve import SolverPlan, solve
from rps_exudyn.results.outcome import Status


@pytest.mark.parametrize("printing", [True, False])
def test_failed_solution_prints_nothing(
    printing: bool, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(mbs: object, t: float, load: list[float]) -> list[float]:
        raise ZeroDivisionError("broken force")

    mbs = exu.SystemContainer().AddSystem()
    node = mbs.AddNode(NodePoint())
    mbs.AddObject(ObjectMassPoint(mass=1.0, nodeNumber=node))
    marker = mbs.AddMarker(MarkerNodePosition(nodeNumber=node))
    mbs.AddLoad(Force(markerNumber=marker, loadVector=[1, 0, 0], loadVectorUserFunction=broken))
    mbs.Assemble()
    monkeypatch.setattr(exu.config, "printToConsole", printing)
    capfd.readouterr()
    outcome = solve(mbs, SolverPlan(end_time=0.1, steps=10))
    assert capfd.readouterr() == ("", "")
    assert outcome.status is Status.NO_CONVERGENCE
    assert outcome.message == "ZeroDivisionError at 0 s: broken force"
    assert exu.config.printToConsole is printing
