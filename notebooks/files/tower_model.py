"""A wall with a frame beside it, six storeys, in OpenSees: modes and pushover curve as files.

Run it with OpenSeesPy (``pip install openseespy``) in the folder in which the files are wanted.
Units are m, kg and N.
"""

import csv
import math

import openseespy.opensees as ops

STOREYS, HEIGHT, MASS, MODES = 6, 3.5, 2.4e5, 3
WALL, COLUMNS = (8.0e10, 1.6e7), (5.0e8, 6.0e5)  # bending stiffness [N m2] and yield moment [N m]
HARDENING = 0.02
ROOF, BASE = 100 + STOREYS, (100, 200)


def build():
    """The wall has the nodes 100 to 106, the frame 200 to 206, whose beams are stiff."""
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 3)
    for line, (stiffness, moment) in ((1, WALL), (2, COLUMNS)):
        ops.uniaxialMaterial("Steel01", line, moment, stiffness, HARDENING)
        ops.uniaxialMaterial("Elastic", 10 + line, 1e11)
        ops.section("Aggregator", line, line, "Mz", 10 + line, "P")
        ops.geomTransf("Linear", line)
        ops.beamIntegration("Lobatto", line, line, 5)
        for n in range(STOREYS + 1):
            ops.node(100 * line + n, 6.0 * line, HEIGHT * n)
        ops.fix(100 * line, 1, 1, 1)
        for n in range(1, STOREYS + 1):
            ends = 100 * line + n - 1, 100 * line + n
            ops.element("forceBeamColumn", 100 * line + n, *ends, line, line)
            ops.fix(100 * line + n, 0, 1, line - 1)
            if line == 1:
                ops.mass(ends[1], MASS, 1e-6, 1e-6)
            else:
                ops.equalDOF(100 + n, 200 + n, 1)


def write_modes(path):
    """The plain form of modes: periods, and the shapes at the floors."""
    eigenvalues = ops.eigen("-fullGenLapack", MODES)
    modes = range(1, MODES + 1)
    with open(path, "w", encoding="utf-8") as file:
        print("mode", "", *modes, sep=",", file=file)
        periods = (f"{2 * math.pi / math.sqrt(value):.6g}" for value in eigenvalues)
        print("period [s]", "", *periods, sep=",", file=file)
        print("level [m]", "mass [kg]", *["shape"] * MODES, sep=",", file=file)
        for n in range(1, STOREYS + 1):
            shapes = (f"{ops.nodeEigenvector(100 + n, mode, 1):.6g}" for mode in modes)
            print(f"{HEIGHT * n:g}", f"{MASS:g}", *shapes, sep=",", file=file)


def write_pushover(path, end=0.30, steps=300):
    """Displacement of the roof and base shear, under forces in proportion to the first mode."""
    ops.timeSeries("Linear", 1)
    ops.pattern("Plain", 1, 1)
    for n in range(1, STOREYS + 1):
        ops.load(100 + n, MASS * abs(ops.nodeEigenvector(100 + n, 1, 1)), 0.0, 0.0)
    ops.constraints("Transformation")
    ops.numberer("RCM")
    ops.system("BandGeneral")
    ops.test("NormDispIncr", 1e-9, 50)
    ops.algorithm("Newton")
    ops.integrator("DisplacementControl", ROOF, 1, end / steps)
    ops.analysis("Static")
    with open(path, "w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file)
        rows.writerow(["roof displacement [mm]", "base shear [kN]"])
        rows.writerow([0, 0])
        for step in range(1, steps + 1):
            if ops.analyze(1) != 0:
                raise RuntimeError(f"step {step} of the pushover did not converge")
            if step % 6 == 0:
                ops.reactions()
                shear = -sum(ops.nodeReaction(node, 1) for node in BASE)
                rows.writerow([f"{1e3 * ops.nodeDisp(ROOF, 1):.4g}", f"{shear / 1e3:.5g}"])


build()
write_modes("tower_modes.csv")
write_pushover("tower_push.csv")
