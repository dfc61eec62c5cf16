"""Lights a room from a file: a value, a picture, the report.

    python room.py scenes/room.obj room.png
"""

import sys

import patchlight

scene, picture = sys.argv[1:]
lit = patchlight.solve(scene, error=0.05, progress=True)
print(f"{len(lit.elements)} elements; an error of {100 * lit.error:.1f}% is claimed, by {lit.backend}")

# The middle of the floor, or of the table that stands there.
values = lit.values([2.05, 0.41, 2.05], [0, 1, 0])
for channel, radiosity, error in zip("rgb", values.radiosity, values.standard_error):
    print(f"{channel}: {radiosity:.3f} W/m^2, give or take {error:.3f}")

lit.render(width=320, height=240).save(picture)
report = lit.report
print(f"{report['counts']['rays']:,} rays; {report['energy']['emitted']:.1f} W are emitted")
