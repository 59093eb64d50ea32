"""The gear as an Exudyn system that is taken over: own load, own sensor, own solver settings.

    python own_exudyn_model.py [view]

With "view" Exudyn's viewer plays the motion at the end, where there is a display.
"""

import sys

import exudyn as exu
import numpy as np
from exudyn.itemInterface import LoadCoordinate, MarkerNodeCoordinate, SensorBody

import rps_exudyn as rps

gear = rps.SteeringGear().replace({"test.speed": "15 rpm"})
model = rps.build_model(gear, rps.Fidelity.preset("flank"))  # bodies, forces, drive; starts in equilibrium
mbs = model.mbs

# An own load: 50 N that pull the rack towards -X, from the start
rack_x = mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=model.nodes["rack"], coordinate=0))
mbs.AddLoad(LoadCoordinate(markerNumber=rack_x, load=-50.0))

# An own sensor: velocity of a point 100 mm along the bar
sensor = mbs.AddSensor(
    SensorBody(
        bodyNumber=model.bodies["rack"],
        localPosition=[0.1, 0, 0],
        storeInternal=True,
        outputVariableType=exu.OutputVariableType.Velocity,
    )
)
mbs.Assemble()

# Own solver settings; forces of friction need small steps and a tolerance on forces
settings = exu.SimulationSettings()
settings.timeIntegration.endTime = 0.2
settings.timeIntegration.numberOfSteps = 200
settings.timeIntegration.verboseMode = 0
settings.timeIntegration.newton.useModifiedNewton = True
settings.timeIntegration.newton.absoluteTolerance = 0.01
settings.timeIntegration.newton.relativeTolerance = 1e-10
settings.timeIntegration.generalizedAlpha.spectralRadius = 0.7
settings.solution.file.write = "view" in sys.argv
settings.solution.sensors.writePeriod = 1e-3
mbs.SolveDynamic(settings, solverType=exu.DynamicSolverType.GeneralizedAlpha)

recorded = mbs.GetSensorStoredData(sensor)  # columns: time, then the three components
speed = recorded[-1, 1]
print(f"rack {1e3 * speed:.3f} mm/s, by gain times speed {1e3 * 5.5749e-3 * gear.test.speed:.3f} mm/s")
print(f"{recorded.shape[0]} instants, speed varies by {1e6 * np.ptp(recorded[20:, 1]):.1f} um/s")

if "view" in sys.argv:
    mbs.SolutionViewer()
